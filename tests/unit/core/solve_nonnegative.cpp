// SPDX-License-Identifier: MIT
#include "catch.hpp"
#include "random.hpp"

#include <phimis/core/solve_nonnegative.hpp>

#include <cmath>

namespace {

using phimis::solve_nonnegative;

constexpr int most = 8;
using matrix = double[most][most];
using vector = double[most];

/// G = A'A and b = A't of random rows A, and targets t.
void random_fit(random_numbers& random, int n, int rows, matrix& g, vector& b) {
  for (int i = 0; i < most; ++i) {
    b[i] = 0;
    for (int k = 0; k < most; ++k) g[i][k] = 0;
  }
  for (int j = 0; j < rows; ++j) {
    double a[most] = {};
    for (int i = 0; i < n; ++i) a[i] = random();
    const double target = random.between(-0.2, 1);
    for (int i = 0; i < n; ++i) {
      b[i] += a[i] * target;
      for (int k = 0; k < n; ++k) g[i][k] += a[i] * a[k];
    }
  }
}

double objective(const matrix& g, const vector& b, int n, const vector& x) {
  double value = 0;
  for (int i = 0; i < n; ++i) {
    value -= b[i] * x[i];
    for (int k = 0; k < n; ++k) value += g[i][k] * x[i] * x[k] / 2;
  }
  return value;
}

/// x ≥ 0, b − Gx ≤ 0, and 0 where x > 0, to a tolerance relative to the terms.
bool optimal(const matrix& g, const vector& b, int n, const vector& x, double tolerance) {
  for (int i = 0; i < n; ++i) {
    double wish = b[i];
    double size = std::fabs(b[i]);
    for (int k = 0; k < n; ++k) {
      wish -= g[i][k] * x[k];
      size += std::fabs(g[i][k] * x[k]);
    }
    if (x[i] < 0 || wish > tolerance * size || (x[i] > 0 && wish < -tolerance * size)) return false;
  }
  return true;
}

}  // namespace

TEST_CASE("Random nonnegative fits satisfy the conditions of optimality") {
  random_numbers random(1);
  int at_zero = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const int n = 1 + random.below(most);
    matrix g;
    vector b;
    vector x;
    random_fit(random, n, 3 * n, g, b);
    REQUIRE(solve_nonnegative<most>(g, b, n, x));
    CHECK(optimal(g, b, n, x, 1e-12));
    for (int i = 0; i < n; ++i) at_zero += x[i] == 0 ? 1 : 0;
  }
  CHECK(at_zero > 500);  // the constraints were at work
}

TEST_CASE("A fit without negative unknowns is that without constraints") {
  const double g[2][2] = {{2, 1}, {1, 3}};
  const double b[2] = {4, 7};
  double x[2];
  REQUIRE(solve_nonnegative<2>(g, b, 2, x));
  CHECK(x[0] == Approx(1).epsilon(1e-15));
  CHECK(x[1] == Approx(2).epsilon(1e-15));
}

TEST_CASE("An unknown that only another one asks for grows") {
  const double g[2][2] = {{2, -1.5}, {-1.5, 2}};
  const double b[2] = {4, -1};
  double x[2];
  REQUIRE(solve_nonnegative<2>(g, b, 2, x));
  CHECK(x[0] == Approx(6.5 / 1.75).epsilon(1e-15));
  CHECK(x[1] == Approx(4 / 1.75).epsilon(1e-15));
}

TEST_CASE("No unknown grows where every right side is negative") {
  const double g[2][2] = {{2, 1}, {1, 3}};
  const double b[2] = {-4, -7};
  double x[2];
  REQUIRE(solve_nonnegative<2>(g, b, 2, x));
  CHECK(x[0] == 0);
  CHECK(x[1] == 0);
}

TEST_CASE("Duplicate and zero columns, and fewer rows than unknowns, have a fit as well") {
  random_numbers random(2);
  for (int trial = 0; trial < 300; ++trial) {
    matrix g;
    vector b;
    vector x;
    random_fit(random, 5, trial % 3 == 0 ? 3 : 12, g, b);
    // Column 5 repeats column 1, column 6 is zero.
    for (int i = 0; i < 5; ++i) g[5][i] = g[i][5] = g[i][1];
    g[5][5] = g[1][1];
    b[5] = b[1];
    REQUIRE(solve_nonnegative<most>(g, b, 7, x));
    CHECK(optimal(g, b, 7, x, 1e-9));
    CHECK(x[6] == 0);
    CHECK((x[1] == 0 || x[5] == 0));
    vector without;
    REQUIRE(solve_nonnegative<most>(g, b, 5, without));
    CHECK(std::fabs(objective(g, b, 7, x) - objective(g, b, 5, without)) <= 1e-11 * (1 + std::fabs(b[1])));
  }
}

TEST_CASE("Nearly equal columns, of which the second cannot be told from the first, have a fit as well") {
  random_numbers random(4);
  for (int trial = 0; trial < 200; ++trial) {
    matrix g = {};
    vector b = {};
    for (int j = 0; j < 12; ++j) {
      double a[4] = {random(), random(), random(), 0};
      a[3] = a[1] * (1 + 1e-9 * random());
      const double target = random();
      for (int i = 0; i < 4; ++i) {
        b[i] += a[i] * target;
        for (int k = 0; k < 4; ++k) g[i][k] += a[i] * a[k];
      }
    }
    vector x;
    CHECK(solve_nonnegative<most>(g, b, 4, x));
    CHECK(optimal(g, b, 4, x, 1e-8));
  }
}

TEST_CASE("Units of the unknowns change the fit by the units alone") {
  random_numbers random(3);
  for (int trial = 0; trial < 100; ++trial) {
    matrix g;
    vector b;
    random_fit(random, 5, 15, g, b);
    matrix scaled = {};
    vector right = {};
    vector unit = {};
    for (int i = 0; i < 5; ++i) unit[i] = std::ldexp(1.0, random.below(200) - 100);
    for (int i = 0; i < 5; ++i) {
      right[i] = b[i] * unit[i];
      for (int k = 0; k < 5; ++k) scaled[i][k] = g[i][k] * unit[i] * unit[k];
    }
    vector x;
    vector y;
    REQUIRE(solve_nonnegative<most>(g, b, 5, x));
    REQUIRE(solve_nonnegative<most>(scaled, right, 5, y));
    for (int i = 0; i < 5; ++i) CHECK(std::fabs(y[i] * unit[i] - x[i]) <= 1e-10);
  }
}
