// SPDX-License-Identifier: MIT
#ifndef PHIMIS_TESTS_INVARIANTS_HPP
#define PHIMIS_TESTS_INVARIANTS_HPP

#include "true_score.hpp"

#include <phimis/core/counts.hpp>
#include <phimis/core/divergence_at.hpp>
#include <phimis/core/minimise_rows.hpp>
#include <phimis/core/rule.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <sstream>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

// What holds of every rule, minimiser and split whatever its input: each is written once, for the fuzzers and the property
// tests. A function returns what is wrong, in words with the numbers, or nothing.

namespace invariants {

template <class... Parts>
std::string words(const Parts&... parts) {
  std::ostringstream out;
  out.precision(17);
  (out << ... << parts);
  return out.str();
}

template <class Real>
std::string list(std::span<const Real> values) {
  std::string text;
  for (const Real value : values) text += words(text.empty() ? "" : ", ", value);
  return text;
}

/// Finite, none below its floor, frozen ones where they are, the sum one within 4 units in the last place for each
/// technique.
///
/// A floor may be missed by the rounding of the number that it is, 2 units of its own last place: a solver may add the
/// floor and what is above it, or divide by what frozen techniques leave. Where floors and frozen techniques sum past one
/// by rounding, which `validate` lets pass, it may be missed by that, too: not all can be had.
template <class Real>
std::string off_simplex(std::span<const Real> alpha, std::span<const Real> floors, std::span<const Real> start,
                        std::span<const bool> frozen) {
  constexpr real epsilon = std::numeric_limits<Real>::epsilon();
  real sum = 0;
  for (std::size_t k = 0; k < alpha.size(); ++k) {
    real left = 1;
    for (std::size_t l = 0; l < alpha.size(); ++l) left -= l == k ? 0 : frozen[l] ? start[l] : floors[l];
    const real floor = std::fmin(floors[k], std::fmax(left, real(0)));
    if (!phimis::is_density(alpha[k])) return words("fraction ", k, " is ", alpha[k], " of ", list(alpha));
    if (frozen[k] && alpha[k] != start[k]) return words("frozen fraction ", k, " left ", start[k], " for ", alpha[k]);
    if (!frozen[k] && alpha[k] < floor * (1 - 2 * epsilon))
      return words("fraction ", k, " is ", alpha[k], ", below its floor ", floors[k]);
    sum += alpha[k];
  }
  if (std::fabs(sum - 1) <= 4 * epsilon * static_cast<real>(alpha.size())) return {};
  return words("fractions ", list(alpha), " sum to one and ", sum - 1);
}
template <class Real, int M>
std::string off_simplex(const phimis::fractions<Real, M>& alpha, const phimis::rule_options<Real, M>& options) {
  return off_simplex<Real>(alpha.value, options.floors.value, options.start.value, options.frozen.value);
}

/// Not negative, none for a technique without a fraction, and N together.
template <class Real, int M>
std::string wrong_counts(const phimis::counts<M>& n, const phimis::fractions<Real, M>& alpha, std::int64_t budget) {
  std::int64_t sum = 0;
  for (int k = 0; k < M; ++k) {
    if (n[k] < 0 || n[k] > budget) return words("count ", k, " is ", n[k], " of ", budget);
    if (n[k] > 0 && !(alpha[k] > 0)) return words("technique ", k, " has no fraction but the count ", n[k]);
    sum += n[k];
  }
  if (sum == budget) return {};
  return words("counts of fractions ", list<Real>(alpha.value), " sum to ", sum, ", not to ", budget);
}

/// What an update may do to any rule, from fractions to fractions.
template <class Rule>
std::string wrong_update(const Rule& rule, const phimis::fractions<typename Rule::real, Rule::techniques>& before) {
  using phimis::rule_status;
  const auto& counters = rule.counters();
  if (counters.zero + counters.nonfinite > counters.observations) return "more observations were refused than made";
  if (std::string off = off_simplex(rule.fractions(), rule.options()); !off.empty()) return off;
  if (rule.status() != rule_status::no_information && rule.status() != rule_status::infinite_divergence) return {};
  for (int k = 0; k < Rule::techniques; ++k) {
    if (rule.fractions()[k] != before[k])
      return words("fraction ", k, " went from ", before[k], " to ", rule.fractions()[k], " without information");
  }
  return {};
}

/// Rows of observations by column, u with the sign of f.  Shapes u[n], w[n], y[m][n].
struct rows {
  std::vector<real> u, w;
  std::vector<std::vector<real>> y;

  template <class Real>
  explicit rows(const phimis::column_pointers<Real>& from)
      : u(from.u, from.u + from.n), w(from.w, from.w + from.n) {
    for (int k = 0; k < from.m; ++k) y.emplace_back(from.y[k], from.y[k] + from.n);
  }
};

/// What an exact minimiser minimises, in long double, at any fractions.
///
///     F(α) = Σ_j w_j P(|u_j|, x_j) + prior · Σ_k a_k φ(mean π_k/a_k),   a_k ∝ α_k/κ_k,   x_j = Σ κ_k a_k y_kj
///
/// with P the integral of −s over x, κ_k = n/Σ_j w_j y_kj or 1 over the cost in units of that at the start, and π in the
/// coordinates a. `size` is λ: Σ_j w_j x_j |s|, of the terms of s where they cancel. Not of what is not convex: C · V.
///
/// Shapes start[m], costs[m].
template <class Divergence, class Real>
class objective {
 public:
  struct value {
    real f;
    real size;
  };

  objective(const Divergence& divergence, rows on, std::span<const Real> start, std::span<const Real> costs,
            Real prior, phimis::control_variate variate)
      : divergence_(divergence), on_(std::move(on)), kappa_(start.size()), pi_(start.size()), prior_(prior) {
    const real n = static_cast<real>(on_.u.size());
    real cost = 0;  // of a sample at the start
    for (std::size_t k = 0; k < kappa_.size(); ++k) cost += static_cast<real>(start[k]) * costs[k];
    for (std::size_t k = 0; k < kappa_.size(); ++k) {
      real mass = 0;
      for (std::size_t j = 0; j < on_.u.size(); ++j) mass += on_.w[j] * on_.y[k][j];
      kappa_[k] = variate == phimis::control_variate::on && mass > 0 ? n / mass : 1;
      kappa_[k] /= phimis::detail::is_variance<Divergence>::value ? real(1) : costs[k] / cost;
    }
    real largest = 0;
    for (real& u : on_.u) largest = std::fmax(largest, u = std::fabs(u));
    for (std::size_t j = 0; j < on_.u.size(); ++j) mean_ += on_.w[j] * (on_.u[j] /= largest) / n;
    if (phimis::detail::needs_mean(divergence)) {
      for (real& u : on_.u) u /= mean_;
      mean_ = 1;
    }
    pi_ = shares(start);
    const real least = std::pow(real(10), -2 * decades_of(divergence) / (sizeof(Real) == 4 ? 8 : 1));
    wide_ = wide({costs.begin(), costs.end()}, least) || wide(on_.u, least) || wide(on_.w, least) || wide(pi_, least);
    for (const auto& column : on_.y) wide_ = wide_ || wide(column, least);
    // A fraction that a prior alone holds is no smaller than the prior, unless it is below what t = f/p may be.
    wide_ = wide_ || (prior_ > 0 && prior_ < 1 / real(phimis::detail::largest_ratio<Real>));
  }

  /// Whether numbers are so far apart that their powers are no Reals, see `decades_of`: there only the simplex is promised.
  bool wide() const { return wide_; }

  value at(std::span<const Real> alpha) const {
    const std::vector<real> a = shares(alpha);
    const real zero = score_of_zero(divergence_);
    value sum{0, 0};
    for (std::size_t j = 0; j < on_.u.size(); ++j) {
      real x = 0;
      for (std::size_t k = 0; k < a.size(); ++k) x += kappa_[k] * a[k] * on_.y[k][j];
      if (on_.u[j] == 0 && phimis::infinite_at_zero(divergence_)) continue;  // a lost sample
      add(on_.w[j], on_.u[j], x, zero, sum);
    }
    for (std::size_t k = 0; k < a.size() && prior_ > 0; ++k) add(prior_, mean_ * pi_[k], a[k], zero, sum);
    return sum;
  }

 private:
  static bool wide(const std::vector<real>& values, real least) {
    real largest = 0;
    for (const real value : values) largest = std::fmax(largest, value);
    return std::any_of(values.begin(), values.end(),
                       [&](real value) { return value > 0 && value < least * largest; });
  }

  void add(real weight, real u, real x, real zero, value& to) const {
    to.f += weight * primitive(divergence_, u, x);
    if (!(x > 0)) return;
    const true_score s = score_of(divergence_, u / x);
    to.size += weight * x * (s.size + std::fabs(zero));
  }

  std::vector<real> shares(std::span<const Real> alpha) const {
    std::vector<real> a(alpha.size());
    real sum = 0;
    for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] = alpha[k] / kappa_[k];
    for (real& share : a) share /= sum;
    return a;
  }

  Divergence divergence_;
  rows on_;
  std::vector<real> kappa_, pi_;
  real prior_;
  real mean_ = 0;
  bool wide_ = false;
};

/// The objective at α above that at where the search began.
///
/// A certificate says by how much it may be: `gap` of λ. Beside it, fractions are rounded to Real, each to its last place,
/// which moves p and with it every term.
template <class Real, class Divergence>
std::string above_start(const objective<Divergence, Real>& on, std::span<const Real> alpha, std::span<const Real> start,
                        real gap) {
  if (on.wide()) return {};
  const auto here = on.at(alpha);
  const auto there = on.at(start);
  if (!std::isfinite(there.f) || !std::isfinite(here.size)) return {};
  const real allowed = (gap + 64 * real(std::numeric_limits<Real>::epsilon())) * here.size;
  if (here.f - there.f <= allowed) return {};
  return words("the objective at ", list(alpha), " is above that at ", list(start), " by ",
               (here.f - there.f) / here.size, " of lambda ", here.size, ", with a gap of ", gap);
}

}  // namespace invariants

#endif  // PHIMIS_TESTS_INVARIANTS_HPP
