// SPDX-License-Identifier: MIT
#include "catch.hpp"
#include "random.hpp"

#include <phimis/core/simplex_newton.hpp>

#include <cmath>
#include <vector>

namespace {

/// ½ θ'Aθ − b'θ: any minimum can be checked by its conditions, and small ones by looking everywhere.
struct quadratic {
  static constexpr bool convex = true;
  static constexpr bool may_vanish = false;
  int m;
  std::vector<double> a;
  std::vector<double> b;

  double gradient(const double* theta, double* g, double* sizes) const {
    double scale = 0;
    for (int i = 0; i < m; ++i) {
      g[i] = b[static_cast<std::size_t>(i)];
      for (int j = 0; j < m; ++j) g[i] -= a[static_cast<std::size_t>(i * m + j)] * theta[j];
      sizes[i] = std::fabs(g[i]);
      scale = std::fmax(scale, sizes[i]);
    }
    return scale;
  }
  void hessian(const int* support, int size, double* h) const {
    for (int i = 0; i < size; ++i) {
      for (int j = 0; j < size; ++j) h[i * size + j] = a[static_cast<std::size_t>(support[i] * m + support[j])];
    }
  }
  static double power() { return 0; }
};

/// A = B'B of the given rank.
quadratic random_quadratic(int m, int rank, random_numbers& next) {
  quadratic result{m, std::vector<double>(static_cast<std::size_t>(m * m)), {}};
  for (int r = 0; r < rank; ++r) {
    std::vector<double> row;
    for (int i = 0; i < m; ++i) row.push_back(next.between(-1, 1));
    for (int i = 0; i < m; ++i) {
      for (int j = 0; j < m; ++j) {
        result.a[static_cast<std::size_t>(i * m + j)] +=
            row[static_cast<std::size_t>(i)] * row[static_cast<std::size_t>(j)];
      }
    }
  }
  for (int i = 0; i < m; ++i) result.b.push_back(next.between(-1, 1));
  return result;
}

template <class Problem>
phimis::simplex_solution solve(Problem& on, std::vector<double>& theta) {
  const int m = static_cast<int>(theta.size());
  std::vector<double> memory(static_cast<std::size_t>(phimis::simplex_doubles(m)));
  std::vector<int> indices(static_cast<std::size_t>(phimis::simplex_indices(m)));
  return phimis::simplex_newton<Problem>(on, m, memory.data(), indices.data()).minimise(theta.data(), 1e-14);
}

}  // namespace

TEST_CASE("Quadratics of every rank are minimised from every corner and from the middle") {
  random_numbers next(1);
  for (int trial = 0; trial < 400; ++trial) {
    const int m = 2 + next.below(30);
    quadratic on = random_quadratic(m, 1 + next.below(m), next);
    for (const int corner : {-1, 0, m - 1}) {
      std::vector<double> theta(static_cast<std::size_t>(m), corner < 0 ? 1.0 / m : 0);
      if (corner >= 0) theta[static_cast<std::size_t>(corner)] = 1;
      const auto found = solve(on, theta);
      CAPTURE(trial, m, corner);
      CHECK(found.residual <= 1e-10);
      double sum = 0;
      for (const double value : theta) {
        CHECK(value >= 0);
        sum += value;
      }
      CHECK(std::fabs(sum - 1) <= 1e-14);
      // The conditions, from the problem itself.
      std::vector<double> g(theta.size());
      std::vector<double> sizes(theta.size());
      const double scale = on.gradient(theta.data(), g.data(), sizes.data());
      double nu = 0;
      for (std::size_t k = 0; k < g.size(); ++k) nu += theta[k] * g[k];
      for (std::size_t k = 0; k < g.size(); ++k) {
        CHECK((theta[k] > 0 ? std::fabs(g[k] - nu) : g[k] - nu) <= 1e-10 * scale);
      }
    }
  }
}

namespace {

/// −Σ log θ_k b_k, infinite at every corner.
struct barrier {
  static constexpr bool convex = true;
  static constexpr bool may_vanish = false;
  const double* b;
  int m;
  std::vector<double> at{};

  double gradient(const double* theta, double* g, double* sizes) {
    at.assign(theta, theta + m);
    for (int k = 0; k < m; ++k) sizes[k] = g[k] = b[k] / theta[k];
    return 1;
  }
  void hessian(const int* support, int size, double* h) const {
    for (int i = 0; i < size * size; ++i) h[i] = 0;
    for (int i = 0; i < size; ++i) {
      const double theta = at[static_cast<std::size_t>(support[i])];
      h[i * size + i] = b[support[i]] / (theta * theta);
    }
  }
  static double power() { return 1; }
};

/// A double well along the segment between two corners.
struct double_well {
  static constexpr bool convex = false;
  static constexpr bool may_vanish = false;
  double x = 0;

  double value() const { return (x - 0.2) * (x - 0.2) * (x - 0.8) * (x - 0.8) + 0.001 * x; }
  double gradient(const double* theta, double* g, double* sizes) {
    x = theta[0];
    g[0] = -(2 * (x - 0.2) * (x - 0.8) * (2 * x - 1) + 0.001);
    g[1] = sizes[0] = sizes[1] = 0;
    return 0.01;
  }
  void hessian(const int* support, int size, double* h) const {
    const double curvature = 2 * ((2 * x - 1) * (2 * x - 1) + 2 * (x - 0.2) * (x - 0.8));
    for (int i = 0; i < size; ++i) {
      for (int j = 0; j < size; ++j) h[i * size + j] = support[i] == 0 && support[j] == 0 ? curvature : 0;
    }
  }
  static double power() { return 0; }
};

}  // namespace

TEST_CASE("A start where the objective is infinite moves inwards, and orders of magnitude are crossed") {
  const double b[4] = {0.5, 0.4999, 1e-4, 1e-30};
  const double sum = b[0] + b[1] + b[2] + b[3];
  barrier on{b, 4};
  std::vector<double> theta{1, 0, 0, 0};
  const auto found = solve(on, theta);
  CHECK(found.residual <= 1e-10);
  for (std::size_t k = 0; k < 4; ++k) CHECK(std::fabs(theta[k] / (b[k] / sum) - 1) <= 1e-9);
}

TEST_CASE("One multiplicative step solves what is a power of one coordinate each") {
  // With G_k = b_k/θ_k and β = 1 the step is θ_k ← b_k/Σb.
  const double b[4] = {0.5, 0.2, 0.1, 0.2};
  barrier on{b, 4};
  std::vector<double> theta{0.1, 0.2, 0.3, 0.4};
  const auto found = solve(on, theta);
  CHECK(found.residual <= 1e-14);
  CHECK(found.evaluations == 2);
  for (std::size_t k = 0; k < 4; ++k) CHECK(std::fabs(theta[k] - b[k]) <= 1e-15);
}

TEST_CASE("Of an objective that is not convex the minimum downhill of the start is found") {
  double_well on;
  for (const double start : {0.1, 0.3, 0.7, 0.95}) {
    std::vector<double> theta{start, 1 - start};
    const auto found = solve(on, theta);
    CAPTURE(start);
    CHECK(found.residual <= 1e-10);
    // The wells tilt a little towards 0: f' = 0 near .2 − .0014 and .8 − .0014.
    CHECK(std::fabs(theta[0] - (start < 0.5 ? 0.2 : 0.8)) <= 0.002);
  }
}

TEST_CASE("One coordinate is its own minimum") {
  quadratic on{1, {2}, {1}};
  std::vector<double> theta{1};
  CHECK(solve(on, theta).residual == 0);
  CHECK(theta[0] == 1);
}

TEST_CASE("Where no gradient is finite the start is the solution") {
  struct nowhere : quadratic {
    double gradient(const double*, double* g, double*) const {
      g[0] = g[1] = 0;
      return phimis::infinity<double>;
    }
  };
  nowhere on;
  on.m = 2;
  std::vector<double> theta{0.875, 0.125};
  CHECK(solve(on, theta).residual == phimis::infinity<double>);
  CHECK(theta[0] == 0.875);
  CHECK(theta[1] == 0.125);
}
