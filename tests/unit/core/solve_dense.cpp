// SPDX-License-Identifier: MIT
#include "catch.hpp"
#include "random.hpp"

#include <phimis/core/solve_dense.hpp>

#include <cmath>

namespace {

using phimis::solve_dense;

/// Solves a copy; the largest |x − truth|, or −1 where it is refused.
template <int M>
double distance(const double (&a)[M][M], const double (&truth)[M], int n, double rounding = 2.3e-16) {
  double copy[M][M] = {};
  double b[M] = {};
  double x[M] = {};
  for (int k = 0; k < n; ++k) {
    for (int i = 0; i < n; ++i) {
      copy[k][i] = a[k][i];
      b[k] += a[k][i] * truth[i];
    }
  }
  if (!solve_dense<M>(copy, b, n, x, rounding)) return -1;
  double worst = 0;
  for (int i = 0; i < n; ++i) worst = std::fmax(worst, std::fabs(x[i] - truth[i]));
  return worst;
}

}  // namespace

TEST_CASE("Equations that need their rows exchanged are solved") {
  const double a[3][3] = {{0, 2, 1}, {1, 0, 0}, {0, 1, 3}};
  const double truth[3] = {5, -2, 0.5};
  const double error = distance<3>(a, truth, 3);
  CHECK(error >= 0);
  CHECK(error <= 1e-15);
}

TEST_CASE("Random equations of every size are solved to rounding") {
  random_numbers random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const int n = 1 + random.below(9);
    double a[9][9] = {};
    double truth[9] = {};
    for (int k = 0; k < n; ++k) {
      truth[k] = random.between(-1, 1);
      for (int i = 0; i < n; ++i) a[k][i] = random.between(-1, 1) + (i == k ? 3 : 0);
    }
    const double error = distance<9>(a, truth, n);
    CHECK(error >= 0);
    CHECK(error <= 1e-13);
  }
}

TEST_CASE("The unit of an equation or of an unknown does not matter") {
  const double plain[3][3] = {{2, -1, 0.5}, {0.3, 0.1, 4}, {-1, 3, 1}};
  const double row[3] = {1e-120, 1, 1e100};
  const double column[3] = {1e60, 1e-80, 1};
  double a[3][3];
  double b[3];
  double x[3];
  for (int k = 0; k < 3; ++k) {
    b[k] = 0;
    for (int i = 0; i < 3; ++i) {
      a[k][i] = plain[k][i] * row[k] * column[i];
      b[k] += plain[k][i] * (i + 1) * row[k];
    }
  }
  REQUIRE(solve_dense<3>(a, b, 3, x));
  for (int i = 0; i < 3; ++i) CHECK(x[i] * column[i] == Approx(i + 1).epsilon(1e-14));
}

TEST_CASE("Singular equations are refused") {
  const double truth[3] = {1, 1, 1};
  const double duplicate[3][3] = {{1, 1, 0.1}, {0.3, 0.3, 2}, {0.7, 0.7, 5}};
  CHECK(distance<3>(duplicate, truth, 3) < 0);
  const double dependent[3][3] = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
  CHECK(distance<3>(dependent, truth, 3) < 0);
  const double no_row[3][3] = {{1, 2, 3}, {0, 0, 0}, {7, 8, 1}};
  CHECK(distance<3>(no_row, truth, 3) < 0);
  const double no_column[3][3] = {{1, 0, 3}, {4, 0, 6}, {7, 0, 1}};
  CHECK(distance<3>(no_column, truth, 3) < 0);
  const double infinite[3][3] = {{1, 2, 3}, {phimis::infinity<double>, 0, 1}, {7, 8, 1}};
  CHECK(distance<3>(infinite, truth, 3) < 0);
}

TEST_CASE("What is singular depends on the rounding of the entries") {
  const double nearly[2][2] = {{1, 1}, {1, 1 + 1e-7}};
  const double truth[2] = {1, 1};
  CHECK(distance<2>(nearly, truth, 2) >= 0);
  CHECK(distance<2>(nearly, truth, 2, 1.2e-7) < 0);
}
