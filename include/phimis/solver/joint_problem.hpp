// SPDX-License-Identifier: MIT
#ifndef PHIMIS_SOLVER_JOINT_PROBLEM_HPP
#define PHIMIS_SOLVER_JOINT_PROBLEM_HPP

#include <phimis/core/finite.hpp>
#include <phimis/core/limits.hpp>
#include <phimis/core/minimise_rows.hpp>
#include <phimis/core/rule.hpp>
#include <phimis/core/simplex_newton.hpp>
#include <phimis/core/simplex_problem.hpp>
#include <phimis/core/table.hpp>
#include <phimis/solver/least_squares.hpp>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace phimis {

/// What is minimised jointly over fractions and control variates, on rows; the problem that `simplex_newton` solves.
///
///     J(b) = min_β Σ_j w_j r_j²/x_j,   r_j = u_j − Σ β_k y_kj,   x_j = Σ b_k y_kj;   u has the sign of f
///     B β = c,   B = Σ w y yᵀ/x,   c = Σ w u y/x
///     G_k = Σ w y_k (r/x)²                                           (minus the gradient: β is at its minimum)
///     H   = 2 Σ w (r/x)² y yᵀ/x − 2 C B⁺ C,   C = Σ w (r/x) y yᵀ/x    (what is left of the joint Hessian without β)
///
/// with a prior, prior · Σ_k π_k²/a_k, a_k = b_k/κ_k. A technique that alone has density somewhere where x = 0 takes no part
/// in β.
///
/// Source   He & Owen 2014; β by partial minimisation, which leaves a convex function.
/// Shapes   kappa[M]; prior shares π[M].
template <int M>
class joint_problem {
  using matrix = detail::square_matrix<M>;
  using vector = detail::column_vector<M>;

 public:
  static constexpr bool convex = true;
  static constexpr bool may_vanish = false;

  joint_problem(const columns<double, M>& rows, double unit, floored_simplex& on, const double* kappa)
      : rows_(rows), unit_(unit), on_(on), kappa_(kappa) {}

  void set_prior(double weight, const std::array<double, M>& shares) {
    prior_ = weight;
    shares_ = shares;
  }

  /// The exponent of the multiplicative step: at fixed β it is that of chi-squared, and a new β only descends.
  double power() const noexcept { return 2; }

  /// All terms of G are positive: their sizes are G.
  double gradient(const double* theta, double* gradient, double* sizes) {
    on_.at(theta);
    if (!fit()) return infinity<double>;
    vector raw = vector::Zero(M);
    vector slope = vector::Zero(M);  // of J in β, of the techniques that take no part
    objective_ = 0;
    scale_ = 0;
    for_each_row([&](const vector& y, double u, double w, double x) {
      const double r = u - beta_.dot(y);
      const double t = r / x;
      objective_ += w * r * t;
      scale_ += w * u * (u / x);
      raw += (w * t * t) * y;
      slope += (w * t) * y;
    });
    double lambda = objective_;
    for (int k = 0; k < M; ++k) {
      if (alone_[k] > 0) raw[k] += slope[k] * slope[k] / alone_[k];
      const double a = on_.beta()[k] / kappa_[k];
      if (!(prior_ > 0) || !(shares_[static_cast<std::size_t>(k)] > 0)) continue;
      const double ratio = shares_[static_cast<std::size_t>(k)] / a;
      raw[k] += prior_ * ratio * ratio / kappa_[k];
      lambda += prior_ * a * ratio * ratio;
    }
    on_.pull_back(raw.data(), gradient);
    std::copy(gradient, gradient + on_.size(), sizes);
    return lambda;
  }

  void hessian(const int* support, int size, double* hessian) {
    matrix own = matrix::Zero(M, M);
    matrix cross = matrix::Zero(M, M);
    for_each_row([&](const vector& y, double u, double w, double x) {
      const double t = (u - beta_.dot(y)) / x;
      own.noalias() += (2 * w * t * t / x) * y * y.transpose();
      cross.noalias() += (w * t / x) * y * y.transpose();
    });
    own.noalias() -= 2 * cross * inverse_ * cross.transpose();
    for (int k = 0; k < M && prior_ > 0; ++k) {
      const double a = on_.beta()[k] / kappa_[k];
      const double ratio = shares_[static_cast<std::size_t>(k)] / a;
      if (ratio > 0) own(k, k) += 2 * prior_ * ratio * ratio / a / (kappa_[k] * kappa_[k]);
    }
    // Over the techniques of the support, and the direction of the floors.
    const double* const fixed = on_.fixed();
    const int order = size + (fixed != nullptr ? 1 : 0);
    Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(M, order);
    for (int a = 0; a < size; ++a) basis(on_.technique(support[a]), a) = 1;
    for (int k = 0; k < M && fixed != nullptr; ++k) basis(k, size) = fixed[k];
    const Eigen::MatrixXd over = basis.transpose() * own * basis;
    on_.pull_back(over.data(), support, size, hessian);
  }

  /// J, and Σ w u²/x to compare it with, at the last θ.
  double objective() const noexcept { return objective_; }
  double scale() const noexcept { return scale_; }
  const vector& beta() const noexcept { return beta_; }

 private:
  template <class Visit>
  void for_each_row(const Visit& visit) const {
    vector y(M);
    for (std::ptrdiff_t j = 0; j < rows_.n; ++j) {
      double x = 0;
      for (int k = 0; k < M; ++k) {
        y[k] = rows_.y[k][j];
        x += on_.beta()[k] * y[k];
      }
      if (x > 0) visit(y, rows_.u[j] * unit_, rows_.w[j], x);
    }
  }

  /// β of the last θ; false where no mixture density reaches f.
  bool fit() {
    alone_ = vector::Zero(M);
    for (std::ptrdiff_t j = 0; j < rows_.n; ++j) {
      double x = 0;
      for (int k = 0; k < M; ++k) x += on_.beta()[k] * rows_.y[k][j];
      if (x > 0) continue;
      if (rows_.u[j] != 0) return false;
      for (int k = 0; k < M; ++k) alone_[k] += rows_.w[j] * rows_.y[k][j];
    }
    matrix normal = matrix::Zero(M, M);
    for_each_row(
        [&](const vector& y, double, double w, double x) { normal.noalias() += (w / x) * y * y.transpose(); });
    vector length(M);
    for (int k = 0; k < M; ++k) {
      const bool part = normal(k, k) > 0 && !(alone_[k] > 0);
      length[k] = part ? 1 / std::sqrt(normal(k, k)) : 0;
    }
    const matrix scaled = length.asDiagonal() * normal * length.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<matrix> eigen(scaled);
    if (eigen.info() != Eigen::Success) return false;
    constexpr double least = 1e-12;  // a technique within 1e-6 of what others span adds nothing
    vector values = eigen.eigenvalues();
    for (int k = 0; k < M; ++k) values[k] = values[k] > least ? 1 / values[k] : 0;
    inverse_ = length.asDiagonal() * eigen.eigenvectors() * values.asDiagonal() * eigen.eigenvectors().transpose() *
               length.asDiagonal();
    beta_ = vector::Zero(M);
    for (int pass = 0; pass < 2; ++pass) {  // the second on the residual, for its digits
      vector rest = vector::Zero(M);
      for_each_row([&](const vector& y, double u, double w, double x) { rest += (w * (u - beta_.dot(y)) / x) * y; });
      beta_ += inverse_ * rest;
    }
    return beta_.allFinite();
  }

  const columns<double, M>& rows_;
  double unit_;
  floored_simplex& on_;
  const double* kappa_;
  double prior_ = 0;
  std::array<double, M> shares_{};
  vector beta_ = vector::Zero(M);
  vector alone_ = vector::Zero(M);  // Σ w y_k where x = 0
  matrix inverse_ = matrix::Zero(M, M);
  double objective_ = 0;
  double scale_ = 0;
};

/// Fractions and coefficients that are best together.
template <int M>
struct joint_minimum {
  fractions<double, M> alpha{};
  per_technique<double, M> beta{};  ///< in the unit of u
  double objective = 0;             ///< Σ w r²/p(α), in units of largest²
  rule_status status = rule_status::no_information;
  simplex_solution solution{};
};

/// Solves the joint problem on rows, u with the sign of f, from given fractions.
///
/// Requires largest = max |u| > 0.   Errors the status: no_information where fewer than two techniques can move, or where
///          the control variates fit f to rounding.
template <int M>
joint_minimum<M> minimise_jointly(const columns<double, M>& rows, double largest,
                                  const rule_options<double, M>& options, const fractions<double, M>& from,
                                  control_variate variate) {
  const double n = static_cast<double>(rows.n);
  std::array<double, M> mass{};
  for (int k = 0; k < M; ++k) {
    for (std::ptrdiff_t j = 0; j < rows.n; ++j) mass[static_cast<std::size_t>(k)] += rows.w[j] * rows.y[k][j];
  }
  const per_technique<double, M> costs = relative_costs(options.costs);
  std::array<double, M> kappa{};
  const auto silent = [&](int k) { return !(mass[static_cast<std::size_t>(k)] > 0); };
  for (int k = 0; k < M; ++k) {
    const auto i = static_cast<std::size_t>(k);
    kappa[i] = (variate == control_variate::on && !silent(k) ? n / mass[i] : 1) / costs[k];
  }
  std::array<double, floored_simplex::doubles(M)> simplex_memory{};
  std::array<int, M> coordinates{};
  floored_simplex simplex(M, kappa.data(), simplex_memory.data(), coordinates.data());
  simplex.constrain([&](int k) { return options.frozen[k] || silent(k); },
                    [&](int k) {
                      return options.frozen[k] ? options.start[k] : silent(k) ? from[k] : options.floors[k];
                    });
  joint_minimum<M> result;
  result.alpha = from;
  if (!simplex.has_freedom()) return result;

  constexpr double smallest = 4 * smallest_normal<double>;
  const double unit = 1 / std::max(largest, smallest);
  joint_problem<M> problem(rows, unit, simplex, kappa.data());
  std::array<double, M> theta{};
  std::array<double, M> gradient{};
  std::array<double, M> sizes{};
  simplex.to_theta(options.start, theta.data());
  const double at_start = problem.gradient(theta.data(), gradient.data(), sizes.data());
  constexpr double exact = 1e-12;
  if (problem.objective() <= exact * exact * problem.scale()) return result;
  if (options.prior > 0 && is_finite(at_start)) {
    std::array<double, M> shares{};
    double sum = 0;
    for (int k = 0; k < M; ++k) sum += options.start[k] / kappa[static_cast<std::size_t>(k)];
    for (int k = 0; k < M; ++k) {
      shares[static_cast<std::size_t>(k)] = options.start[k] / kappa[static_cast<std::size_t>(k)] / sum;
    }
    problem.set_prior(options.prior * problem.objective() / n, shares);
  }

  std::vector<double> memory(static_cast<std::size_t>(simplex_doubles(M)));
  std::vector<int> indices(static_cast<std::size_t>(simplex_indices(M)));
  simplex_newton<joint_problem<M>> solver(problem, simplex.size(), memory.data(), indices.data());
  simplex.to_theta(from, theta.data());
  // Residuals r that are small against f are differences, with fewer digits.
  const double digits = 1 + std::sqrt(problem.scale() / problem.objective());
  const double tolerance = 4 * epsilon<double> * digits;
  result.solution = solver.minimise(theta.data(), tolerance);
  if (!simplex.to_fractions(theta.data(), result.alpha)) {
    result.status = rule_status::not_converged;
    return result;
  }
  problem.gradient(theta.data(), gradient.data(), sizes.data());
  double cost = 0;
  for (int k = 0; k < M; ++k) {
    result.beta[k] = problem.beta()[k] / unit;
    cost += result.alpha[k] / kappa[static_cast<std::size_t>(k)];
  }
  result.objective = problem.objective() / cost;
  result.status = result.solution.residual <= 1e5 * tolerance ? rule_status::updated : rule_status::not_converged;
  return result;
}

}  // namespace phimis

#endif  // PHIMIS_SOLVER_JOINT_PROBLEM_HPP
