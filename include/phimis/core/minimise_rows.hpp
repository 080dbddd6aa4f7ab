// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_MINIMISE_ROWS_HPP
#define PHIMIS_CORE_MINIMISE_ROWS_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/divergence.hpp>
#include <phimis/core/limits.hpp>
#include <phimis/core/mixture_sums.hpp>
#include <phimis/core/rule.hpp>
#include <phimis/core/simplex_newton.hpp>
#include <phimis/core/simplex_problem.hpp>

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
  judged  ///< what minimises: its floor
};

/// A minimisation over m techniques.
///
/// Shapes start[m], from[m], floors[m], costs[m], frozen[m].
template <class Real>
struct minimisation {
  const Real* start;   ///< of the prior, and of frozen techniques
  const Real* from;    ///< where the search starts
  const Real* floors;
  const Real* costs;
  const bool* frozen;
  Real prior = 0;
  control_variate variate = control_variate::on;
  silent_technique silent = silent_technique::judged;
};

PHIMIS_HOST_DEVICE constexpr int minimise_doubles(int m) noexcept {
  return 2 * m + floored_simplex::doubles(m) + 3 * m + (m + 1) * (m + 1) + simplex_doubles(m);
}
PHIMIS_HOST_DEVICE constexpr int minimise_indices(int m) noexcept { return 3 * m + simplex_indices(m); }

/// A minimum, and how good it is; ν of `simplex_solution` is in the unit of the objective that was chosen.
struct row_minimum {
  rule_status status;
  simplex_solution solution;
};

namespace detail {

/// Whether a divergence depends on the unit of f.
template <class Divergence>
PHIMIS_HOST_DEVICE bool needs_mean(const Divergence& divergence) noexcept {
  if constexpr (std::is_same<Divergence, multi_sample_variance>::value) {
    return false;
  } else if constexpr (has_exponent<Divergence>::value) {
    return divergence.exponent() == 0;
  } else {
    return true;
  }
}

}  // namespace detail

/// The fractions that minimise a divergence on rows, written to alpha[m].
///
/// Requires largest = max |u| > 0.   Errors the status: no_information where fewer than two techniques can move.
template <class Divergence, class Real>
PHIMIS_HOST_DEVICE row_minimum minimise_rows(const Divergence& divergence, const column_pointers<Real>& rows, Real largest,
                                             const minimisation<Real>& wanted, Real* alpha, double* memory,
                                             int* indices) noexcept {
  const int m = rows.m;
  double* const kappa = memory;
  double* const theta = kappa + m;
  double* const simplex_memory = theta + m;
  double* const problem_memory = simplex_memory + floored_simplex::doubles(m);
  double* const solver_memory = problem_memory + divergence_on_simplex<Divergence, Real>::doubles(m);

  constexpr Real smallest = 4 * smallest_normal<Real>;
  const Real inverse = 1 / (largest > smallest ? largest : smallest);
  const double n = static_cast<double>(rows.n);
  const double mean = detail::masses(rows, inverse, kappa) / n;

  int* const silent = indices;
  for (int k = 0; k < m; ++k) {
    silent[k] = wanted.silent == silent_technique::kept && !(kappa[k] > 0) ? 1 : 0;
    const bool normalise = wanted.variate == control_variate::on && kappa[k] > 0;
    kappa[k] = (normalise ? n / kappa[k] : 1) / static_cast<double>(wanted.costs[k]);
  }
  floored_simplex simplex(m, kappa, simplex_memory, indices + m);
  simplex.constrain([&](int k) { return wanted.frozen[k] || silent[k] != 0; },
                    [&](int k) {
                      return wanted.frozen[k] ? wanted.start[k] : silent[k] != 0 ? wanted.from[k] : wanted.floors[k];
                    });
  if (!simplex.has_freedom()) return {rule_status::no_information, {}};

  // Only powers of t are free of the unit of f; the others want t = g/p, g = f/μ̂.
  const bool in_means = detail::needs_mean(divergence);
  divergence_on_simplex<Divergence, Real> problem(
      divergence, rows, simplex, kappa, wanted.variate == control_variate::on,
      static_cast<double>(inverse) / (in_means ? mean : 1), in_means ? 1 : mean, static_cast<double>(wanted.prior),
      problem_memory, indices + 2 * m);
  double sum = 0;
  for (int k = 0; k < m; ++k) sum += static_cast<double>(wanted.start[k]) / kappa[k];
  for (int k = 0; k < m; ++k) problem.prior_shares()[k] = static_cast<double>(wanted.start[k]) / kappa[k] / sum;

  simplex.to_theta(wanted.from, theta);
  problem.choose_unit(theta);
  simplex_newton<divergence_on_simplex<Divergence, Real>> solver(problem, simplex.size(), solver_memory,
                                                                 indices + 3 * m);
  constexpr double rounding = static_cast<double>(epsilon<Real>);
  const simplex_solution solution = solver.minimise(theta, 4 * rounding);
  for (int k = 0; k < m; ++k) alpha[k] = wanted.frozen[k] ? wanted.start[k] : wanted.from[k];
  simplex.to_fractions(theta, alpha);
  return {solution.residual <= 1e5 * rounding ? rule_status::updated : rule_status::not_converged, solution};
}

}  // namespace phimis

#endif  // PHIMIS_CORE_MINIMISE_ROWS_HPP
