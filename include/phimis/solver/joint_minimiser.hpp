// SPDX-License-Identifier: MIT
#ifndef PHIMIS_SOLVER_JOINT_MINIMISER_HPP
#define PHIMIS_SOLVER_JOINT_MINIMISER_HPP

#include <phimis/concepts.hpp>
#include <phimis/core/minimise_rows.hpp>
#include <phimis/core/observation.hpp>
#include <phimis/core/rule.hpp>
#include <phimis/core/simplex_newton.hpp>
#include <phimis/core/simplex_problem.hpp>
#include <phimis/core/table.hpp>
#include <phimis/solver/joint_problem.hpp>
#include <phimis/solver/table.hpp>
#include <phimis/validate.hpp>

#include <algorithm>
#include <cmath>

namespace phimis {

/// Options of `joint_rule`: 20 samples of trust in the start.
///
/// The residual f − β·p of a good fit is made by few samples, and without a prior fractions run after each of them.
template <int M>
constexpr rule_options<double, M> joint_options() noexcept {
  rule_options<double, M> options;
  options.prior = 20;
  return options;
}

/// The fractions that are best together with the pdfs as control variates.
///
///     min_{α, β} Σ_j (f_j − Σ_k β_k p_kj)² / (q_j p(α, x_j)) + prior · V̂ Σ_k π_k²/α_k,   α_k ≥ floor_k,   Σ α_k = 1
///
/// the sample's picture of the variance of one sample, which is jointly convex; V̂ is its value per sample at the start
/// fractions π. β is eliminated: at given α it solves the weighted normal equations, and what is left in α is convex too.
/// Fractions that are best with control variates are not those that are best without: techniques are also there to
/// be subtracted. They go with `progressive_control_variates`, `cross_fitted_control_variates` or `pooled_control_variates`,
/// which fit their own β to the mixtures that were sampled.
///
/// - He & Owen solve a log barrier by damped Newton; here floors are constraints of an active-set Newton, to a certificate.
/// - Each pdf is normalised on the sample, as in `exact_minimiser`.
/// - Where control variates fit f exactly, every mixture is as good: fractions stay, `no_information`.
///
/// Source   He & Owen 2014, "Optimal mixture weights in multiple importance sampling".
/// Requires each observation with the density q_j that it was drawn from; pdfs that integrate to one.
/// Errors   `status()`; `residual()` is the KKT residual on all coordinates relative to the objective.
/// Cost     three passes over all rows for each of about ten evaluations, M² operations a row.
template <int M>
class joint_minimiser : public rule_base<double, M> {
 public:
  explicit joint_minimiser(const rule_options<double, M>& options = joint_options<M>(),
                           phimis::control_variate variate = control_variate::on)
      : rule_base<double, M>(options), variate_(variate) {}

  const table<double, M>& rows() const noexcept { return table_; }
  double residual() const noexcept { return solution_.residual; }
  double gap() const noexcept { return solution_.gap; }
  int evaluations() const noexcept { return solution_.evaluations; }
  /// β at these fractions, in the unit of f.
  const per_technique<double, M>& coefficients() const noexcept { return coefficients_; }
  /// The variance of one sample at these fractions and coefficients, as the observations see it.
  double variance() const noexcept { return variance_ * largest_ * largest_; }

  void observe(const observation<double, M>& sample) {
    row<double, M> row;
    if (!this->admit(sample, row)) return;
    if (sample.f < 0) row.u = -row.u;
    keep(row);
  }

  rule_status update() {
    if (!(largest_ > 0)) return this->end(rule_status::no_information);
    const auto solved = minimise_jointly<M>(table_.view(), largest_, this->options_, this->state_.fractions, variate_);
    if (solved.status == rule_status::no_information) return this->end(solved.status);
    this->state_.fractions = solved.alpha;
    coefficients_ = solved.beta;
    variance_ = solved.objective / static_cast<double>(table_.size());
    solution_ = solved.solution;
    return this->end(solved.status);
  }

  /// Adds the observations of another state; fractions stay until the next update.
  void merge(const joint_minimiser& other) {
    this->state_.counters.merge(other.state_.counters);
    const std::ptrdiff_t theirs = other.table_.size();  // `other` may be this
    for (std::ptrdiff_t j = 0; j < theirs; ++j) keep(other.table_[j]);
  }

 private:
  void keep(const row<double, M>& row) {
    table_.push(row);
    largest_ = std::max(largest_, std::fabs(row.u));
  }

  phimis::control_variate variate_;
  table<double, M> table_{};
  per_technique<double, M> coefficients_{};
  simplex_solution solution_{};
  double variance_ = infinity<double>;  // in units of largest_²
  double largest_ = 0;                  // |u|
};

/// Fractions and control variates that are best together.
///
///     phimis::integrate(f, techniques, options, phimis::joint_rule<2>(), phimis::cross_fitted_control_variates{});
///
/// Errors std::invalid_argument where options are out of range.
template <int M>
joint_minimiser<M> joint_rule(const rule_options<double, M>& options = joint_options<M>(),
                              control_variate variate = control_variate::on) {
  validate(options);
  return joint_minimiser<M>(options, variate);
}

}  // namespace phimis

#endif  // PHIMIS_SOLVER_JOINT_MINIMISER_HPP
