// SPDX-License-Identifier: MIT
#ifndef PHIMIS_ANALYSIS_JOINT_OPTIMUM_HPP
#define PHIMIS_ANALYSIS_JOINT_OPTIMUM_HPP

#include <phimis/analysis/problem.hpp>
#include <phimis/core/limits.hpp>
#include <phimis/error.hpp>
#include <phimis/estimator/control_fit.hpp>
#include <phimis/solver/joint_problem.hpp>
#include <phimis/validate.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

namespace phimis::analysis {

/// Fractions with the control variates that are best there.
template <int M>
struct controlled {
  fractions<double, M> alpha;
  per_technique<double, M> beta;  ///< 0 for a technique without a fraction in `best_control_variates`
  measured variance;  ///< of one sample; of the multi-sample estimate, too, whose techniques have equal means
  double residual;    ///< KKT residual relative to the variance; 0 where fractions were given
};

namespace detail {

template <int M>
void require_normalised(const problem<M>& on) {
  for (int k = 0; k < M; ++k) {
    require(on.missing_mass()[k] == 0, "pdf " + std::to_string(k + 1),
            "must promise to integrate to 1 to be a control variate; it misses", on.missing_mass()[k]);
  }
}

/// ∫ (f − β·p)²/p(α) dx
template <int M>
measured residual_variance(const problem<M>& on, const fractions<double, M>& alpha,
                           const per_technique<double, M>& beta) {
  return on.integral([&](double f, const per_technique<double, M>& p, double) {
    double rest = f;
    for (int k = 0; k < M; ++k) rest -= beta[k] * p[k];
    const double q = mixture(alpha, p);
    if (q > 0) return rest * (rest / q);
    return f == 0 ? 0.0 : infinity<double>;
  });
}

}  // namespace detail

/// The variance of one sample at given fractions, with the pdfs as control variates at their best.
///
///     min_β ∫ (f − Σ_k β_k p_k)²/p(α) dx
///
/// Source   Owen & Zhou 2000; the variance of Optimal MIS, Kondapaneni et al. 2019.
/// Errors   std::invalid_argument where a pdf is defective; infinite where p(α) = 0 < |f|.
template <int M>
controlled<M> best_control_variates(const problem<M>& on, const fractions<double, M>& alpha) {
  detail::require_normalised(on);
  const table<double, M> rows = on.signed_rows();
  control_fit<double, M> fit(alpha);
  for (std::ptrdiff_t j = 0; j < rows.size(); ++j) {
    const row<double, M> row = rows[j];
    per_technique<double, M> y{};
    for (int k = 0; k < M; ++k) y[k] = row.y[k];
    if (row.w > 0) fit.add(row.u, y, 1 / row.w);
  }
  const auto found = fit.solve(shrinkage::off);
  return {alpha, found.beta, detail::residual_variance(on, alpha, found.beta), 0};
}

/// The fractions and control variates that are best together, on the exact integrals.
///
///     min_{α, β} ∫ (f − Σ_k β_k p_k)²/p(α) dx
///
/// Without floors unless they are asked for. Where control variates fit f, every α is as good: the start is returned.
///
/// Source   He & Owen 2014; the solver is that of `joint_minimiser`, on quadrature nodes in place of samples.
/// Errors   std::invalid_argument where a pdf is defective or options are out of range.
template <int M>
controlled<M> joint_optimum(const problem<M>& on,
                            const rule_options<double, M>& options = without_floors<double, M>()) {
  detail::require_normalised(on);
  validate(options);
  const table<double, M> rows = on.signed_rows();
  double largest = 0;
  for (std::ptrdiff_t j = 0; j < rows.size(); ++j) largest = std::max(largest, std::fabs(rows[j].u));
  const joint_minimum<M> found = minimise_jointly<M>(
      rows.view(), largest, options, share_budget(options.start, options), control_variate::off);
  if (found.status == rule_status::no_information) return best_control_variates(on, found.alpha);
  return {found.alpha, found.beta, detail::residual_variance(on, found.alpha, found.beta), found.solution.residual};
}

}  // namespace phimis::analysis

#endif  // PHIMIS_ANALYSIS_JOINT_OPTIMUM_HPP
