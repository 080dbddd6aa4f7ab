// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_MINIMISE_ROWS_HPP
#define PHIMIS_CORE_MINIMISE_ROWS_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/divergence.hpp>
#include <phimis/core/finite.hpp>
#include <phimis/core/kink.hpp>
#include <phimis/core/limits.hpp>
#include <phimis/core/minimisation.hpp>
#include <phimis/core/minimise_pair.hpp>
#include <phimis/core/mixture_sums.hpp>
#include <phimis/core/row_parts.hpp>
#include <phimis/core/rule.hpp>
#include <phimis/core/simplex_newton.hpp>
#include <phimis/core/simplex_problem.hpp>
#include <phimis/core/variance_on_simplex.hpp>

#include <cmath>
#include <cstddef>
#include <type_traits>

namespace phimis {

/// Memory of `minimise_rows` for m techniques: what a caller without a heap puts on its stack.
template <class Divergence>
PHIMIS_HOST_DEVICE constexpr int minimise_doubles(int m) noexcept {
  return 4 * m + floored_simplex::doubles(m) + divergence_on_simplex<chi_squared, double>::doubles(m) +
         (detail::is_variance<Divergence>::value ? variance_on_simplex<double>::doubles(m) : 0) + simplex_doubles(m);
}
PHIMIS_HOST_DEVICE constexpr int minimise_indices(int m) noexcept { return 3 * m + simplex_indices(m); }

/// The fractions that minimise a divergence on rows, written to alpha[m].
///
///     min_α Σ_j (p_j/q_j) φ(g_j/p_j) + prior · D(π, α),   α_k ≥ floor_k,   Σ α_k = 1
///
/// With costs, p is replaced by p/C, the density per unit of cost C = Σ c_k α_k: for χ² that is C ∫ f²/p. Only positive
/// powers allow it. The variances mean cost times variance instead: C V[ℱ], or C V[F] of which a local minimum is found.
/// Rows of these two have the sign of f in u.
///
/// Requires largest = max |u| > 0; memory[minimise_doubles<Divergence>(m)], indices[minimise_indices(m)].
/// Errors   the status: no_information where fewer than two techniques can move, and not_converged where numbers are so far
///          apart that a technique's scale is none; alpha is then not written.
template <class Divergence, class Real>
class row_minimisation {
 public:
  PHIMIS_HOST_DEVICE row_minimisation(const Divergence& divergence, const column_pointers<Real>& rows, Real largest,
                                      const minimisation<Real>& wanted, double* memory, int* indices) noexcept
      : divergence_(divergence),
        rows_(rows),
        wanted_(wanted),
        kappa_(memory),
        theta_(kappa_ + rows.m),
        best_(theta_ + rows.m),
        prior_shares_(best_ + rows.m),
        convex_memory_(prior_shares_ + rows.m + floored_simplex::doubles(rows.m)),
        solver_memory_(convex_memory_ + divergence_on_simplex<chi_squared, double>::doubles(rows.m)),
        variance_memory_(solver_memory_ + simplex_doubles(rows.m)),
        freedom_(indices),
        problem_indices_(indices + 2 * rows.m),
        solver_indices_(indices + 3 * rows.m),
        simplex_(rows.m, kappa_, prior_shares_ + rows.m, indices + rows.m) {
    constexpr Real smallest = 4 * smallest_normal<Real>;
    const Real inverse = 1 / (largest > smallest ? largest : smallest);
    unit_ = static_cast<double>(inverse);
    mean_ = detail::masses(rows, inverse, kappa_) / mass();
    if (detail::is_variance<Divergence>::value && wanted.prior > 0) {
      limit_mean<Real>(unit_, mean_, false);
      const double scale = std::sqrt(scale_beside(static_cast<double>(wanted.prior)));  // of f, whose square is meant
      unit_ *= scale;
      mean_ *= scale;
    }
    constrain();
  }

  PHIMIS_HOST_DEVICE row_minimum minimise(Real* alpha) noexcept {
    if (!simplex_.has_freedom() && !alone()) return {};
    for (int k = 0; k < rows_.m; ++k) {
      if (!(kappa_[k] > 0) || !is_finite(kappa_[k])) return {rule_status::not_converged, {}};
    }
    if (detail::needs_mean(divergence_) && !is_positive_as<Real>(unit_ / mean_)) {
      return {rule_status::not_converged, {}};
    }
    simplex_.to_theta(wanted_.from, theta_);
    simplex_solution found;
    bool local = false;
    if constexpr (std::is_same<Divergence, multi_sample_variance>::value) {
      found = solve_variance(sampling_model::multi_sample);
      local = true;
    } else if constexpr (detail::is_variance<Divergence>::value) {
      found = priced() ? solve_variance(sampling_model::one_sample) : solve_convex();
    } else {
      found = solve_convex();
    }
    if (!simplex_.to_fractions(theta_, alpha)) return {rule_status::not_converged, found};
    for (int k = 0; k < rows_.m; ++k) {
      if (held(k)) alpha[k] = fixed(k);
    }
    if (!(found.residual <= acceptable) && !(found.residual <= wanted_.tolerance)) {
      return {rule_status::not_converged, found};
    }
    return {local ? rule_status::local : rule_status::updated, found};
  }

 private:
  static constexpr double rounding = static_cast<double>(epsilon<Real>);
  static constexpr double acceptable = sizeof(Real) == 8 ? 1e-10 : 1e-3;

  PHIMIS_HOST_DEVICE double tolerance() const noexcept {
    return wanted_.tolerance > 4 * rounding ? wanted_.tolerance : 4 * rounding;
  }

  PHIMIS_HOST_DEVICE bool priced() const noexcept { return has_prices(wanted_, rows_.m); }

  /// What sums are divided by to be means.
  PHIMIS_HOST_DEVICE double mass() const noexcept {
    return wanted_.mass > 0 ? wanted_.mass : static_cast<double>(rows_.n);
  }

  /// Whether one technique takes what the floors of silent ones leave.
  PHIMIS_HOST_DEVICE bool alone() const noexcept {
    return wanted_.silent == silent_technique::judged && simplex_.size() == 1 && simplex_.free() > 0;
  }

  PHIMIS_HOST_DEVICE bool held(int k) const noexcept { return wanted_.frozen[k] || freedom_[k] != is(freedom::free); }
  PHIMIS_HOST_DEVICE static constexpr int is(freedom kind) noexcept { return static_cast<int>(kind); }

  /// The fraction of a technique that cannot move, the floor of another.
  PHIMIS_HOST_DEVICE Real fixed(int k) const noexcept {
    if (wanted_.frozen[k]) return wanted_.start[k];
    return freedom_[k] == is(freedom::kept) ? wanted_.from[k] : wanted_.floors[k];
  }

  /// From masses to κ, the floors, and the centre of the prior.
  PHIMIS_HOST_DEVICE void constrain() noexcept {
    const double n = static_cast<double>(rows_.n);
    const double unit = cost_unit(wanted_, rows_.m);
    for (int k = 0; k < rows_.m; ++k) {
      freedom_[k] = is(freedom_of(wanted_, k, !(kappa_[k] > 0), infinite_at_zero(divergence_)));
      kappa_[k] = wanted_.variate == control_variate::on && kappa_[k] > 0 ? n / kappa_[k] : 1;
      if (!detail::is_variance<Divergence>::value) kappa_[k] /= static_cast<double>(wanted_.costs[k]) / unit;
    }
    simplex_.constrain([&](int k) { return held(k); }, [&](int k) { return fixed(k); });
    double sum = 0;
    for (int k = 0; k < rows_.m; ++k) {
      // What is held at 0 is infinitely far from any share: a constant.
      const bool in_prior = !held(k) || fixed(k) > 0;
      sum += prior_shares_[k] = in_prior ? static_cast<double>(wanted_.start[k]) / kappa_[k] : 0;
    }
    for (int k = 0; k < rows_.m; ++k) prior_shares_[k] = sum > 0 ? prior_shares_[k] / sum : 0;
  }

  template <class Objective>
  PHIMIS_HOST_DEVICE divergence_on_simplex<Objective, Real> convex_problem(const Objective& objective) noexcept {
    // Only powers of t are free of the unit of f; the others want t = g/p, g = f/μ̂.
    const bool in_means = detail::needs_mean(objective);
    return divergence_on_simplex<Objective, Real>(
        objective, rows_, simplex_, kappa_, wanted_.variate == control_variate::on, unit_ / (in_means ? mean_ : 1),
        in_means ? 1 : mean_, static_cast<double>(wanted_.prior), prior_shares_, convex_memory_, problem_indices_);
  }

  template <class Problem>
  PHIMIS_HOST_DEVICE simplex_solution solve(Problem& problem, double tolerance, int opening = 2) noexcept {
    simplex_newton<Problem> solver(problem, simplex_.size(), solver_memory_, solver_indices_);
    // Sums over rows are those of Real, but for the variances, which take rows to double.
    return solver.minimise(theta_, tolerance, opening, Problem::convex ? rounding : epsilon<double>);
  }

  PHIMIS_HOST_DEVICE simplex_solution solve_convex() noexcept {
    if constexpr (detail::can_round_off<Divergence>::value) {
      if (has_sharp_kink(divergence_)) return solve_kinked();
    }
    auto problem = convex_problem(divergence_);
    // A sixteenth of many rows tells where to start: all rows are then read three or four times, not ten.
    constexpr int every = 16;
    const bool many = rows_.n >= every * 32 * static_cast<std::ptrdiff_t>(rows_.m < 8 ? 8 : rows_.m);
    simplex_solution found;
    if (many) {
      problem.read_every(every);
      settle(problem);
      add(found, solve(problem, tolerance() > 1e-4 ? tolerance() : 1e-4));
      problem.read_every(1);
    }
    settle(problem);
    add(found, solve(problem, tolerance(), many ? 0 : 2));
    // Scores may change by many orders of magnitude on the way: the unit of the end is not that of the start.
    for (int again = 0; again < 4 && !(found.residual <= acceptable || found.residual <= wanted_.tolerance);
         ++again) {
      problem.choose_unit(theta_);
      add(found, solve(problem, tolerance(), 0));
    }
    return found;
  }

  /// The later solution, with the work of both.
  PHIMIS_HOST_DEVICE static void add(simplex_solution& sum, const simplex_solution& later) noexcept {
    const int iterations = sum.iterations + later.iterations;
    const int evaluations = sum.evaluations + later.evaluations;
    sum = later;
    sum.iterations = iterations;
    sum.evaluations = evaluations;
  }

  /// A start on a face, from which rows with f ≠ 0 are out of reach or nearly, moves inwards; then the unit is chosen.
  template <class Problem>
  PHIMIS_HOST_DEVICE void settle(Problem& problem) noexcept {
    const int size = simplex_.size();
    bool on_a_face = false;
    for (int i = 0; i < size; ++i) {
      on_a_face = on_a_face || theta_[i] < 1e-6;
      best_[i] = 1.0 / size;
    }
    if (on_a_face && !(problem.ratio(theta_, true) <= 1e6 * problem.ratio(best_, true))) {
      for (int i = 0; i < size; ++i) theta_[i] = 0.99 * theta_[i] + 0.01 / size;
    }
    problem.choose_unit(theta_);
  }

  /// A kink is rounded off less and less; the residual is that of the last, the gap counts what it hides. A narrower
  /// kink would magnify the rounding of p into the conditions.
  PHIMIS_HOST_DEVICE simplex_solution solve_kinked() noexcept {
    simplex_solution found;
    constexpr double least = sizeof(Real) == 8 ? 1e-6 : 1e-4;
    for (double width = 0.1; width > 0.9 * least; width /= 10) {
      const auto smooth = round_off(divergence_, width);
      auto problem = convex_problem(smooth);
      if (found.evaluations == 0) settle(problem);
      add(found, solve(problem, tolerance()));
      found.gap += width;
    }
    return found;
  }

  PHIMIS_HOST_DEVICE variance_on_simplex<Real> variance_problem(sampling_model model) noexcept {
    const double prior = static_cast<double>(wanted_.prior) * mean_ * mean_ / mass();
    return variance_on_simplex<Real>(model, rows_, simplex_, kappa_, priced() ? wanted_.costs : nullptr, unit_,
                                     mass(), prior, prior_shares_, variance_memory_);
  }

  PHIMIS_HOST_DEVICE simplex_solution solve_variance(sampling_model model) noexcept {
    simplex_solution found;
    if (priced()) found = scan_prices(model);
    auto problem = variance_problem(model);
    add(found, solve(problem, tolerance()));
    found.gap = infinity<double>;  // a bound of what is convex
    return found;
  }

  /// θ near the global minimum of C V: C V = min_τ (τ C + V/τ)²/4, and τ² C + V is convex in the one-sample model. τ² is
  /// V/C at the minimum: it is looked for over the decades that V and C span, then followed downhill.
  PHIMIS_HOST_DEVICE simplex_solution scan_prices(sampling_model model) noexcept {
    simplex_solution work;
    auto objective = variance_problem(model);
    auto convex = convex_problem(chi_squared{});
    double least = infinity<double>;
    for (int i = 0; i < simplex_.size(); ++i) best_[i] = theta_[i];
    // What it writes goes to the convex problem's scratch.
    const auto evaluate = [&](auto& problem) {
      (void)problem.gradient(theta_, convex_memory_, convex_memory_ + rows_.m);
      ++work.evaluations;
    };
    const auto look = [&](double price) {
      convex.charge(price * mass(), wanted_.costs);
      add(work, solve(convex, tolerance()));
      evaluate(objective);
      if (!(objective.value() < least)) return false;
      least = objective.value();
      for (int i = 0; i < simplex_.size(); ++i) best_[i] = theta_[i];
      return true;
    };
    look(0);
    const double scale = objective.second_moment() / objective.cost();
    for (double share = 64; share > 1e-6; share /= 4)
      look(share * scale);  // the scale may be near the end of the range
    for (int step = 0; step < 20; ++step) {
      for (int i = 0; i < simplex_.size(); ++i) theta_[i] = best_[i];
      evaluate(objective);
      if (!look(objective.variance() / objective.cost())) break;
    }
    for (int i = 0; i < simplex_.size(); ++i) theta_[i] = best_[i];
    return work;
  }

  const Divergence& divergence_;
  const column_pointers<Real>& rows_;
  const minimisation<Real>& wanted_;
  double* kappa_;
  double* theta_;
  double* best_;
  double* prior_shares_;
  double* convex_memory_;
  double* solver_memory_;
  double* variance_memory_;
  int* freedom_;
  int* problem_indices_;
  int* solver_indices_;
  floored_simplex simplex_;
  double unit_;
  double mean_;
};

/// The fractions that minimise a divergence on rows, written to alpha[m], by the better of two ways: of two techniques by
/// `pair_minimisation`, unless cost times variance is meant.
///
/// M is the number of techniques, or 0 where it is known when it runs: code of the other way is then not compiled.
///
/// Requires as `row_minimisation`.
template <int M, class Divergence, class Real>
PHIMIS_HOST_DEVICE row_minimum minimise_rows(const Divergence& divergence, const column_pointers<Real>& rows,
                                             Real largest, const minimisation<Real>& wanted, double* memory,
                                             int* indices, Real* alpha) noexcept {
  constexpr bool priced_variance = detail::is_variance<Divergence>::value;
  if constexpr (M == 0 || M == 2) {
    if (rows.m == 2 && !(priced_variance && has_prices(wanted, 2))) {
      return pair_minimisation<Divergence, Real>(divergence, rows, largest, wanted).minimise(alpha);
    }
  }
  if constexpr (M != 2 || priced_variance) {
    return row_minimisation<Divergence, Real>(divergence, rows, largest, wanted, memory, indices).minimise(alpha);
  } else {
    return {};
  }
}

}  // namespace phimis

#endif  // PHIMIS_CORE_MINIMISE_ROWS_HPP
