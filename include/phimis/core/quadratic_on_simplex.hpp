// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_QUADRATIC_ON_SIMPLEX_HPP
#define PHIMIS_CORE_QUADRATIC_ON_SIMPLEX_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/fractions.hpp>
#include <phimis/core/limits.hpp>
#include <phimis/core/rule.hpp>
#include <phimis/core/simplex_newton.hpp>
#include <phimis/core/simplex_problem.hpp>

#include <cmath>

namespace phimis {

namespace detail {

template <int M>
class quadratic_problem {
 public:
  static constexpr bool convex = true;
  static constexpr bool may_vanish = false;

  PHIMIS_HOST_DEVICE quadratic_problem(const double (&a)[M][M], const double (&b)[M], double factor,
                                       floored_simplex& on) noexcept
      : a_(a), b_(b), factor_(factor), on_(on) {}

  PHIMIS_HOST_DEVICE static double power() noexcept { return 0; }

  PHIMIS_HOST_DEVICE double gradient(const double* theta, double* gradient, double* sizes) noexcept {
    on_.at(theta);
    double raw[M];
    double lambda = 0;
    for (int k = 0; k < M; ++k) {
      raw[k] = factor_ * b_[k];
      for (int l = 0; l < M; ++l) raw[k] -= a_[k][l] * on_.beta()[l];
      lambda += on_.beta()[k] * std::fabs(b_[k]);
    }
    on_.pull_back(raw, gradient);
    for (int i = 0; i < on_.size(); ++i) sizes[i] = std::fabs(gradient[i]);
    return lambda;
  }

  PHIMIS_HOST_DEVICE void hessian(const int* support, int size, double* hessian) noexcept {
    double raw[(M + 1) * (M + 1)] = {};
    const double* const fixed = on_.fixed();  // the last column
    const int order = size + (fixed != nullptr ? 1 : 0);
    double of_fixed = 0;
    for (int k = 0; k < M && fixed != nullptr; ++k) of_fixed += fixed[k] * times_fixed(k);
    for (int i = 0; i < size; ++i) {
      const int k = on_.technique(support[i]);
      for (int j = 0; j < size; ++j) raw[i * order + j] = a_[k][on_.technique(support[j])];
      if (fixed != nullptr) raw[i * order + size] = raw[size * order + i] = times_fixed(k);
    }
    if (fixed != nullptr) raw[order * order - 1] = of_fixed;
    on_.pull_back(raw, support, size, hessian);
  }

 private:
  PHIMIS_HOST_DEVICE double times_fixed(int k) const noexcept {
    double sum = 0;
    for (int l = 0; l < M; ++l) sum += a_[k][l] * on_.fixed()[l];
    return sum;
  }

  const double (&a_)[M][M];
  const double (&b_)[M];
  double factor_;
  floored_simplex& on_;
};

}  // namespace detail

/// The fractions that minimise a quadratic in the shares β of `floored_simplex`, from alpha to alpha.
///
///     min_β −factor b·β + ½ βᵀA β
///
/// Requires A symmetric and positive semi-definite, b of the size of Aβ.
template <class Real, int M>
PHIMIS_HOST_DEVICE rule_status minimise_quadratic(const double (&a)[M][M], const double (&b)[M], double factor,
                                                  floored_simplex& on, fractions<Real, M>& alpha) noexcept {
  detail::quadratic_problem<M> problem(a, b, factor, on);
  double theta[M];
  on.to_theta(alpha, theta);
  double memory[simplex_doubles(M)];
  int indices[simplex_indices(M)];
  simplex_newton<detail::quadratic_problem<M>> solver(problem, on.size(), memory, indices);
  constexpr double rounding = static_cast<double>(epsilon<Real>);
  const simplex_solution solution = solver.minimise(theta, 4 * rounding);
  if (!on.to_fractions(theta, alpha)) return rule_status::not_converged;
  return solution.residual <= 1e4 * rounding ? rule_status::updated : rule_status::not_converged;
}

}  // namespace phimis

#endif  // PHIMIS_CORE_QUADRATIC_ON_SIMPLEX_HPP
