// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_MINIMISE_PAIR_HPP
#define PHIMIS_CORE_MINIMISE_PAIR_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/divergence.hpp>
#include <phimis/core/divergence_at.hpp>
#include <phimis/core/finite.hpp>
#include <phimis/core/kink.hpp>
#include <phimis/core/limits.hpp>
#include <phimis/core/minimisation.hpp>
#include <phimis/core/mixture_sums.hpp>
#include <phimis/core/pair_sums.hpp>
#include <phimis/core/row_parts.hpp>
#include <phimis/core/rule.hpp>
#include <phimis/core/solve_pair.hpp>

#include <cmath>

namespace phimis {

/// `row_minimisation` of two techniques: one number to find, by a bracket that no divergence escapes, kinks and V[F]
/// included.
///
/// Errors as there. residual() is 0 where a score steps across zero within the last digit of α.
/// Cost   reads all rows once for each evaluation of `solve_pair` and three times more, with one division a row.
template <class Divergence, class Real>
class pair_minimisation {
 public:
  PHIMIS_HOST_DEVICE pair_minimisation(const Divergence& divergence, const column_pointers<Real>& rows, Real largest,
                                       const minimisation<Real>& wanted) noexcept
      : divergence_(divergence), rows_(rows), wanted_(wanted) {
    constexpr Real smallest = 4 * smallest_normal<Real>;
    const Real inverse = 1 / (largest > smallest ? largest : smallest);
    const double n = static_cast<double>(rows.n);
    double mass[2] = {1, 1};
    // Positive powers by themselves ask for no mean, and give a silent technique its floor.
    const bool normalised = wanted.variate == control_variate::on;
    if (normalised || detail::needs_mean(divergence) || wanted.prior > 0 || wanted.silent == silent_technique::kept ||
        falls(divergence)) {
      mean_ = detail::masses(rows, inverse, mass) / n;
    }
    unit_ = static_cast<double>(inverse);
    for (int k = 0; k < 2; ++k) {
      freedom_[k] = freedom_of(wanted, k, !(mass[k] > 0), infinite_at_zero(divergence));
      kappa_[k] = normalised && mass[k] > 0 ? n / mass[k] : 1;
      kappa_[k] /= static_cast<double>(wanted.costs[k]) / cost_unit(wanted, 2);
    }
    // Sums take κ over the smaller of the two, so that no power of p overflows, in whatever order it is multiplied; V[F], of
    // which p is a part only, takes f in that unit.
    const double smaller = kappa_[0] < kappa_[1] ? kappa_[0] : kappa_[1];
    if (!local) scale_ = smaller;
    if (local) unit_ *= smaller;
    if (detail::needs_mean(divergence)) {
      unit_ /= mean_ * scale_;
      mean_ = 1;
    } else {
      mean_ *= smaller;
      if (wanted.prior > 0) limit_mean<Real>(unit_, mean_, falls(divergence));
    }
  }

  PHIMIS_HOST_DEVICE row_minimum minimise(Real* alpha) noexcept {
    if (wanted_.frozen[0] || wanted_.frozen[1]) return {};
    if (freedom_[0] == freedom::kept || freedom_[1] == freedom::kept) return {};
    for (const double kappa : kappa_) {
      if (!is_positive_as<double>(kappa) || !is_positive_as<Real>(kappa / scale_)) {
        return {rule_status::not_converged, {}};
      }
    }
    if (!is_positive_as<Real>(unit_)) return {rule_status::not_converged, {}};  // f is subnormal
    // The solver's fractions are those of the scaled pdfs: a_k ∝ α_k/κ_k.
    const double floor1 = static_cast<double>(wanted_.floors[0]);
    const double floor2 = static_cast<double>(wanted_.floors[1]);
    const pair_fractions low = to_solver(floor1, 1 - floor1);
    const pair_fractions high = to_solver(1 - floor2, floor2);
    const pair_fractions start =
        to_solver(static_cast<double>(wanted_.from[0]), static_cast<double>(wanted_.from[1]));
    prior_ = to_solver(static_cast<double>(wanted_.start[0]), static_cast<double>(wanted_.start[1]));
    const bool is_low = freedom_[0] == freedom::floored;
    const bool is_settled = is_low || freedom_[1] == freedom::floored;
    const pair_solution found = is_settled ? end_at(is_low ? low : high) : solve(low, high, start);

    row_minimum result;
    result.solution.lambda = found.lambda;
    result.solution.evaluations = result.solution.iterations = found.evaluations;
    result.solution.residual = found.residual;
    // A step of s that crosses zero within the last digit of α is a root of a φ with a kink.
    const bool converged = found.residual <= 1e4 * rounding || found.residual <= wanted_.tolerance;
    if (!converged && detail::is_kinked<Divergence>::value && found.bracketed) result.solution.residual = 0;
    if (!local) result.solution.gap = result.solution.residual;

    if (found.alpha.first == low.first && found.alpha.second == low.second) {
      set(alpha, floor1, 1 - floor1);
    } else if (found.alpha.first == high.first && found.alpha.second == high.second) {
      set(alpha, 1 - floor2, floor2);
    } else {
      const double first = found.alpha.first * kappa_[0];
      const double second = found.alpha.second * kappa_[1];
      if (!(first + second > 0) || !is_finite(first + second)) {
        result.status = rule_status::not_converged;
        return result;
      }
      const double share1 = first / (first + second);
      const double share2 = second / (first + second);
      // A floor near the smallest number may vanish on the way to the solver's fractions.
      if (share1 < floor1) {
        set(alpha, floor1, 1 - floor1);
      } else if (share2 < floor2) {
        set(alpha, 1 - floor2, floor2);
      } else {
        set(alpha, share1, share2);
      }
    }
    const bool solved = converged || !(result.solution.residual > 0);
    result.status = !solved ? rule_status::not_converged : local ? rule_status::local : rule_status::updated;
    return result;
  }

 private:
  static constexpr bool local = std::is_same<Divergence, multi_sample_variance>::value;
  static constexpr double rounding = static_cast<double>(epsilon<Real>);

  /// Whether s falls: a score that may be below 0 gives a fraction to where nothing is.
  PHIMIS_HOST_DEVICE static bool falls(const Divergence& divergence) noexcept {
    if constexpr (has_exponent<Divergence>::value) {
      return divergence.exponent() < 0;
    } else {
      return false;
    }
  }

  PHIMIS_HOST_DEVICE pair_solution end_at(const pair_fractions& alpha) const noexcept {
    return {alpha, 0, false, 1, sums_at(alpha, 1).lambda};
  }

  /// One block in sixteen of many rows tells where to start: all rows are then read three or four times, not ten.
  PHIMIS_HOST_DEVICE pair_solution solve(const pair_fractions& low, const pair_fractions& high,
                                         pair_fractions start) const noexcept {
    constexpr int some = 16;
    int every = 1;
    const auto evaluate = [&](const pair_fractions& at) { return sums_at(at, every); };
    if (!local && rows_.n >= some * 4 * block_rows) {
      every = some;
      start = solve_pair(evaluate, low, high, start, 4 * rounding, objective::convex, 1e-4).alpha;
      every = 1;
    }
    return solve_pair(evaluate, low, high, start, 4 * rounding, local ? objective::any : objective::convex,
                      wanted_.tolerance);
  }

  /// Sums over rows at a point, and the prior's two rows: one for each technique, in which only it has density.
  PHIMIS_HOST_DEVICE pair_sums sums_at(const pair_fractions& at, int every) const noexcept {
    const pair_point<Real> point{{static_cast<Real>(at.first), static_cast<Real>(at.second)},
                                 {static_cast<Real>(kappa_[0] / scale_), static_cast<Real>(kappa_[1] / scale_)},
                                 static_cast<Real>(unit_),
                                 wanted_.mass > 0 ? wanted_.mass : static_cast<double>(rows_.n),
                                 wanted_.variate == control_variate::on};
    pair_sums sums = sum_pair(divergence_, rows_, point, every);
    const double beside = scale_beside(static_cast<double>(wanted_.prior));
    sums.zeta *= beside * scale_;
    sums.slope *= beside * scale_;
    sums.lambda *= beside * scale_;
    if (rows_.n < 128) sums.exponent = 0;  // another evaluation costs less than logarithms
    const double weight = beside * static_cast<double>(wanted_.prior) / every;
    if (weight > 0) {
      const auto score_of = [&](double pi, double share) {
        if constexpr (local) {
          return prior_score(chi_squared{}, mean_, pi, share);
        } else {
          return prior_score(divergence_, mean_, pi, share);
        }
      };
      const auto s1 = score_of(prior_.first, at.first);
      const auto s2 = score_of(prior_.second, at.second);
      sums.zeta += weight * (s1.value - s2.value);
      if (s1.slope > 0) sums.slope += weight * s1.slope / at.first;
      if (s2.slope > 0) sums.slope += weight * s2.slope / at.second;
      sums.lambda += weight * (at.first * std::fabs(s1.value) + at.second * std::fabs(s2.value));
    }
    return sums;
  }

  PHIMIS_HOST_DEVICE pair_fractions to_solver(double first, double second) const noexcept {
    const double a1 = first / kappa_[0];
    const double a2 = second / kappa_[1];
    return {a1 / (a1 + a2), a2 / (a1 + a2)};
  }

  PHIMIS_HOST_DEVICE static void set(Real* alpha, double first, double second) noexcept {
    alpha[0] = static_cast<Real>(first);
    alpha[1] = static_cast<Real>(second);
  }

  const Divergence& divergence_;
  const column_pointers<Real>& rows_;
  const minimisation<Real>& wanted_;
  double kappa_[2];
  double scale_ = 1;
  double unit_;
  double mean_ = 1;
  pair_fractions prior_{};
  freedom freedom_[2];
};

}  // namespace phimis

#endif  // PHIMIS_CORE_MINIMISE_PAIR_HPP
