// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_SECOND_ORDER_HPP
#define PHIMIS_CORE_SECOND_ORDER_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/finite.hpp>
#include <phimis/core/limits.hpp>
#include <phimis/core/rule.hpp>
#include <phimis/core/simplex_newton.hpp>
#include <phimis/core/simplex_problem.hpp>

#include <cmath>
#include <cstdint>

namespace phimis {

namespace detail {

/// The quadratic that `second_order` minimises, in the coordinates of `floored_simplex`.
///
///     K(β) = −b·d/(2C) + ½ dᵀA d,   d = β − π/C,   b = Aπ
template <int M>
class second_order_problem {
 public:
  static constexpr bool convex = true;

  PHIMIS_HOST_DEVICE second_order_problem(const double (&a)[M][M], const double (&b)[M], double mean_cost,
                                          floored_simplex& on) noexcept
      : a_(a), b_(b), mean_cost_(mean_cost), on_(on) {}

  PHIMIS_HOST_DEVICE static double power() noexcept { return 0; }

  PHIMIS_HOST_DEVICE double gradient(const double* theta, double* gradient, double* sizes) noexcept {
    on_.at(theta);
    double raw[M];
    double lambda = 0;
    for (int k = 0; k < M; ++k) {
      raw[k] = 1.5 * b_[k] / mean_cost_;
      for (int l = 0; l < M; ++l) raw[k] -= a_[k][l] * on_.beta()[l];
      lambda += on_.beta()[k] * b_[k] / mean_cost_;
    }
    on_.pull_back(raw, gradient);
    for (int i = 0; i < on_.size(); ++i) sizes[i] = std::fabs(gradient[i]);
    return lambda;
  }

  PHIMIS_HOST_DEVICE void hessian(const int* support, int size, double* hessian) noexcept {
    double raw[(M + 1) * (M + 1)];
    const double* const fixed = on_.fixed();
    const int order = size + (fixed != nullptr ? 1 : 0);
    for (int i = 0; i < order; ++i) {
      for (int j = 0; j < order; ++j) {
        double sum = 0;
        for (int k = 0; k < M; ++k) {
          for (int l = 0; l < M; ++l) sum += column(support, size, i, k) * a_[k][l] * column(support, size, j, l);
        }
        raw[i * order + j] = sum;
      }
    }
    on_.pull_back(raw, support, size, hessian);
  }

 private:
  /// Technique i of the support, or, as the last column, the fixed fractions.
  PHIMIS_HOST_DEVICE double column(const int* support, int size, int i, int k) const noexcept {
    return i == size ? on_.fixed()[k] : on_.technique(support[i]) == k ? 1.0 : 0.0;
  }

  const double (&a_)[M][M];
  const double (&b_)[M];
  double mean_cost_;
  floored_simplex& on_;
};

}  // namespace detail

/// One Newton step for V[ℱ] from the start fractions π, equal by default, for any number of techniques.
///
///     V[ℱ](π + d) ≈ V[ℱ](π) − b·d + dᵀA d
///     A_kl = ∫ f² p_k p_l / p(π)³ dx,   b_k = ∫ f² p_k / p(π)² dx = Σ_l A_kl π_l
///
/// The minimum of that quadratic over the fractions that respect the floors; A is summed over all observations ever made.
/// Away from the start it is an approximation: it does not become exact with more samples.
///
/// Source   Lu, Pacanowski & Granier 2013, as told by V Sec. 1: "Taylor's second order approximation of the variance around
///          the equal weights ½".
/// Requires each observation with the density q that it was drawn from.
/// Errors   no_information, and fractions as before, where every f is 0 or a technique has no density where f ≠ 0; samples
///          where p(π) = 0 ≠ f count as not finite.
/// Cost     M² memory; an observation M², an update M³ for each change of the set of techniques at their floors.
/// - V tells the idea and no formula; here it is carried out, for the variance of the balance heuristic V[ℱ], M techniques
///   in place of two, and any start.
/// - Floors and frozen techniques are constraints of the quadratic, not a clamp after its step.
/// - With costs it is the same step for (Σ c_k α_k) ∫ f²/p(α) dx, in the shares a_k ∝ c_k α_k, in which that is convex: the
///   cost times the second moment, not the variance.
/// - The prior enters as the second order of prior · D(π, α): a matrix prior · μ²/π_k on the diagonal.
template <class Real, int M>
class second_order : public rule_base<Real, M> {
 public:
  PHIMIS_HOST_DEVICE second_order() noexcept : second_order(rule_options<Real, M>{}) {}
  PHIMIS_HOST_DEVICE explicit second_order(const rule_options<Real, M>& options) noexcept
      : rule_base<Real, M>(options) {}

  PHIMIS_HOST_DEVICE void observe(const observation<Real, M>& sample) noexcept {
    row<Real, M> row;
    if (!this->admit(sample, row)) return;
    Real x = 0;
    for (int k = 0; k < M; ++k) x += this->options_.start[k] * row.y[k];
    const Real t = row.u > 0 ? row.u / x : Real(0);
    if (!is_finite(t)) {
      ++this->counters_.nonfinite;
      return;
    }
    ++sums_.n;
    if (!(t > 0)) return;
    if (t > sums_.reference) refer_to(t, sums_);
    const Real ratio = t / sums_.reference;
    sums_.f += row.w * x * ratio;
    const Real square = row.w * x * ratio * ratio;
    for (int k = 0, at = 0; k < M; ++k) {
      for (int l = 0; l <= k; ++l, ++at) sums_.a[at] += square * (row.y[k] / x) * (row.y[l] / x);
    }
  }

  PHIMIS_HOST_DEVICE rule_status update() noexcept {
    const auto& options = this->options_;
    if (!(sums_.f > 0)) return this->status_ = rule_status::no_information;
    double a[M][M];
    const double n = static_cast<double>(sums_.n);
    const double mean = static_cast<double>(sums_.f) / n;
    double mean_cost = 0;
    double kappa[M];
    for (int k = 0, at = 0; k < M; ++k) {
      for (int l = 0; l <= k; ++l, ++at) a[k][l] = a[l][k] = static_cast<double>(sums_.a[at]) / n;
      if (!(a[k][k] > 0)) return this->status_ = rule_status::no_information;
      const double start = static_cast<double>(options.start[k]);
      if (options.prior > 0 && start > 0) a[k][k] += static_cast<double>(options.prior) / n * mean * mean / start;
      mean_cost += start * static_cast<double>(options.costs[k]);
      kappa[k] = 1 / static_cast<double>(options.costs[k]);
    }
    double b[M] = {};
    for (int k = 0; k < M; ++k) {
      for (int l = 0; l < M; ++l) b[k] += a[k][l] * static_cast<double>(options.start[l]);
    }

    double map_memory[floored_simplex::doubles(M)];
    int coordinates[M];
    floored_simplex on(M, kappa, map_memory, coordinates);
    const auto from = share_budget(options.start, options);
    on.constrain([&](int k) { return options.frozen[k]; },
                 [&](int k) { return options.frozen[k] ? from[k] : options.floors[k]; });
    this->fractions_ = from;
    if (!on.has_freedom()) return this->status_ = rule_status::updated;
    detail::second_order_problem<M> problem(a, b, mean_cost, on);
    double theta[M];
    on.to_theta(from, theta);
    double memory[simplex_doubles(M)];
    int indices[simplex_indices(M)];
    simplex_newton<detail::second_order_problem<M>> solver(problem, on.size(), memory, indices);
    constexpr double rounding = static_cast<double>(epsilon<Real>);
    const simplex_solution solution = solver.minimise(theta, 4 * rounding);
    on.to_fractions(theta, this->fractions_);
    const bool converged = solution.residual <= 1e4 * rounding;
    return this->status_ = converged ? rule_status::updated : rule_status::not_converged;
  }

  /// Adds what another state, with the same start, has observed.
  PHIMIS_HOST_DEVICE void merge(const second_order& other) noexcept {
    for (int k = 0; k < M; ++k) PHIMIS_EXPECTS(this->options_.start[k] == other.options_.start[k]);
    this->counters_.merge(other.counters_);
    sums theirs = other.sums_;
    if (theirs.reference > sums_.reference) refer_to(theirs.reference, sums_);
    if (theirs.reference > 0) refer_to(sums_.reference, theirs);
    sums_.n += theirs.n;
    sums_.f += theirs.f;
    for (int at = 0; at < entries; ++at) sums_.a[at] += theirs.a[at];
  }

 private:
  static constexpr int entries = M * (M + 1) / 2;

  /// With t = f/p(π) in units of `reference`, the largest so far.
  struct sums {
    std::int64_t n = 0;
    Real reference = 0;
    Real f = 0;            // Σ f/q
    Real a[entries] = {};  // Σ f² p_k p_l/(p³ q), k >= l
  };

  PHIMIS_HOST_DEVICE static void refer_to(Real t, sums& of) noexcept {
    const Real ratio = of.reference / t;
    of.f *= ratio;
    for (Real& entry : of.a) entry *= ratio * ratio;
    of.reference = t;
  }

  sums sums_{};
};

}  // namespace phimis

#endif  // PHIMIS_CORE_SECOND_ORDER_HPP
