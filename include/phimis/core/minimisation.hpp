// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_MINIMISATION_HPP
#define PHIMIS_CORE_MINIMISATION_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/divergence.hpp>
#include <phimis/core/rule.hpp>
#include <phimis/core/simplex_newton.hpp>

#include <type_traits>

namespace phimis {

/// Whether each pdf is made to integrate to one on the sample.
///
/// E_q[p_k/q] = 1 is known. Dividing p_k by its mean Σ_j(p_kj/q_j)/n on the sample before the divergence is minimised
/// removes most of the noise of the fractions, and makes a zero-variance mixture be found exactly from any sample. At
/// the solution it is the control variate λ̂ Σ_j (p_kj/q_j − 1) with the self-normalised λ̂ = Σ(p/q)s / Σ(p/q), but the
/// problem stays convex. It must be off where a pdf is defective (∫ p_k < 1).
///
/// Source the control variate is that of He & Owen 2014, for every score; as a normalisation, ours.
enum class control_variate { on, off };

/// What a technique without density at any observation gets.
enum class silent_technique {
  kept,   ///< the fraction that it has: nothing is known of it
  judged  ///< what minimises: its floor, where the prior has no share for it
};

/// What to minimise over m techniques, but for the rows.
///
/// Shapes start[m], from[m], floors[m], costs[m], frozen[m].
template <class Real>
struct minimisation {
  const Real* start;  ///< of the prior, and of frozen techniques
  const Real* from;   ///< where the search starts
  const Real* floors;
  const Real* costs;
  const bool* frozen;
  Real prior = 0;
  double tolerance = 0;  ///< of the residual; below it, as far as rounding lets it
  double mass = 0;       ///< what sums are divided by to be means; 0: the number of rows
  control_variate variate = control_variate::on;
  silent_technique silent = silent_technique::judged;
};

/// Whether a technique's fraction is looked for.
enum class freedom {
  free,
  kept,    ///< it stays
  floored  ///< it is the floor
};

/// That of technique k, `silent` where it has no density at any observation. `infinite`: what `infinite_at_zero` says; a prior
/// without a share for a technique is then infinite wherever that has a fraction.
template <class Real>
PHIMIS_HOST_DEVICE freedom freedom_of(const minimisation<Real>& wanted, int k, bool silent, bool infinite) noexcept {
  if (silent && wanted.silent == silent_technique::kept) return freedom::kept;
  const bool has_prior = wanted.prior > 0;
  const bool in_prior = has_prior && wanted.start[k] > 0;
  return (silent && !in_prior) || (infinite && has_prior && !in_prior) ? freedom::floored : freedom::free;
}

/// The unit of costs of m techniques in which nothing depends on theirs: what a sample costs at the start, where the prior
/// is then in units of samples. Of equal costs exactly that cost.
template <class Real>
PHIMIS_HOST_DEVICE double cost_unit(const minimisation<Real>& wanted, int m) noexcept {
  const double first = static_cast<double>(wanted.costs[0]);
  double mean = 0;  // over the first
  bool equal = true;
  for (int k = 0; k < m; ++k) {
    mean += static_cast<double>(wanted.start[k]) * (static_cast<double>(wanted.costs[k]) / first);
    equal = equal && wanted.costs[k] == wanted.costs[0];
  }
  return equal ? first : first * mean;
}

/// Whether costs differ.
template <class Real>
PHIMIS_HOST_DEVICE bool has_prices(const minimisation<Real>& wanted, int m) noexcept {
  for (int k = 1; k < m; ++k) {
    if (wanted.costs[k] != wanted.costs[0]) return true;
  }
  return false;
}

/// A minimum, and how good it is.
struct row_minimum {
  rule_status status = rule_status::no_information;
  simplex_solution solution{};
};

namespace detail {

/// Whether a divergence depends on the unit of f.
template <class Divergence>
PHIMIS_HOST_DEVICE bool needs_mean(const Divergence& divergence) noexcept {
  if constexpr (has_exponent<Divergence>::value) {
    return divergence.exponent() == 0;
  } else {
    return !std::is_same<Divergence, multi_sample_variance>::value;
  }
}

/// The variances, which f and |f| do not share and which cost times variance is about.
template <class Divergence>
struct is_variance : std::is_base_of<one_sample_variance, Divergence> {};
template <>
struct is_variance<multi_sample_variance> : std::true_type {};

}  // namespace detail

}  // namespace phimis

#endif  // PHIMIS_CORE_MINIMISATION_HPP
