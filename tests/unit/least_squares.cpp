// SPDX-License-Identifier: MIT
#include "catch.hpp"
#include "colour.hpp"
#include "random.hpp"

#include <phimis/solver/least_squares.hpp>

#include <cmath>
#include <type_traits>
#include <vector>

namespace {

using phimis::least_squares;
using phimis::per_technique;

static_assert(std::is_trivially_copyable_v<least_squares<double, 3>>, "a state can be copied to a checkpoint");

template <int M>
struct row_of {
  per_technique<double, M> x;
  double y;
};

/// Rows of M random columns, and y = Σ β_k x_k + noise.
template <int M>
std::vector<row_of<M>> random_rows(int n, const per_technique<double, M>& beta, double noise, std::uint64_t seed) {
  random_numbers random(seed);
  std::vector<row_of<M>> rows;
  for (int j = 0; j < n; ++j) {
    row_of<M> row{{}, noise * random.between(-1, 1)};
    for (int k = 0; k < M; ++k) {
      row.x[k] = random();
      row.y += beta[k] * row.x[k];
    }
    rows.push_back(row);
  }
  return rows;
}

template <int M>
least_squares<double, M> regression(const std::vector<row_of<M>>& rows) {
  least_squares<double, M> sums;
  for (const auto& row : rows) sums.add(row.x, row.y);
  return sums;
}

/// What is left of y; orthogonal to every column at the solution.
template <int M>
per_technique<double, M> gradient(const std::vector<row_of<M>>& rows, const per_technique<double, M>& beta) {
  per_technique<double, M> sum{};
  for (const auto& row : rows) {
    double rest = row.y;
    for (int k = 0; k < M; ++k) rest -= beta[k] * row.x[k];
    for (int k = 0; k < M; ++k) sum[k] += rest * row.x[k];
  }
  return sum;
}

}  // namespace

TEST_CASE("Coefficients are found exactly where y lies in the span of the columns") {
  const per_technique<double, 3> beta{{2, -5, 0.25}};
  const auto found = regression<3>(random_rows<3>(10, beta, 0, 1)).solve();
  CHECK(found.rank == 3);
  for (int k = 0; k < 3; ++k) CHECK(found.beta[k] == Approx(beta[k]).epsilon(1e-12));
  CHECK(found.residual_norm < 1e-13);
}

TEST_CASE("What is left of y is orthogonal to every column, and as long as the solution says") {
  const auto rows = random_rows<4>(200, {{1, 2, 3, 4}}, 0.5, 2);
  const auto found = regression<4>(rows).solve();
  const auto slope = gradient<4>(rows, found.beta);
  double squares = 0;
  for (const auto& row : rows) {
    double rest = row.y;
    for (int k = 0; k < 4; ++k) rest -= found.beta[k] * row.x[k];
    squares += rest * rest;
  }
  for (int k = 0; k < 4; ++k) CHECK(std::fabs(slope[k]) < 1e-11);
  CHECK(found.residual_norm == Approx(std::sqrt(squares)).epsilon(1e-12));
}

TEST_CASE("Columns that are nearly the same keep the digits that normal equations would lose") {
  random_numbers random(3);
  least_squares<double, 2> sums;
  for (int j = 0; j < 50; ++j) {
    const double x = random();
    const double near = x + 1e-7 * random();
    sums.add({{x, near}}, 3 * x - 2 * near);
  }
  const auto found = sums.solve();
  CHECK(found.rank == 2);  // the normal equations have a condition of 1e15
  CHECK(found.beta[0] == Approx(3).epsilon(1e-7));
  CHECK(found.beta[1] == Approx(-2).epsilon(1e-7));
}

TEST_CASE("Duplicate columns share a coefficient, a column of zeros has none") {
  random_numbers random(4);
  least_squares<double, 4> sums;
  for (int j = 0; j < 40; ++j) {
    const double x = random();
    const double y = random();
    sums.add({{x, y, x, 0}}, 4 * x - y);
  }
  const auto found = sums.solve();
  CHECK(found.rank == 2);
  CHECK(found.beta[0] == Approx(2).epsilon(1e-12));
  CHECK(found.beta[2] == Approx(2).epsilon(1e-12));
  CHECK(found.beta[1] == Approx(-1).epsilon(1e-12));
  CHECK(found.beta[3] == 0);
}

TEST_CASE("With fewer rows than columns the solution fits them all and is finite") {
  const auto rows = random_rows<5>(3, {{1, 1, 1, 1, 1}}, 1, 5);
  const auto found = regression<5>(rows).solve();
  CHECK(found.rank == 3);
  for (const auto& row : rows) {
    double rest = row.y;
    for (int k = 0; k < 5; ++k) rest -= found.beta[k] * row.x[k];
    CHECK(std::fabs(rest) < 1e-12);
  }
}

TEST_CASE("A column that is left out has no coefficient, and what it would have explained is left") {
  const auto rows = random_rows<3>(40, {{1, 2, -1}}, 0.1, 9);
  const auto found = regression<3>(rows).solve({{false, true, false}});
  CHECK(found.rank == 2);
  CHECK(found.beta[1] == 0);
  double squares = 0;
  double slope[2] = {};
  for (const auto& row : rows) {
    const double rest = row.y - found.beta[0] * row.x[0] - found.beta[2] * row.x[2];
    squares += rest * rest;
    slope[0] += rest * row.x[0];
    slope[1] += rest * row.x[2];
  }
  CHECK(std::fabs(slope[0]) < 1e-12);
  CHECK(std::fabs(slope[1]) < 1e-12);
  CHECK(found.residual_norm == Approx(std::sqrt(squares)).epsilon(1e-12));
}

TEST_CASE("Without rows every coefficient is 0") {
  const auto found = least_squares<double, 3>().solve();
  CHECK(found.rank == 0);
  for (int k = 0; k < 3; ++k) CHECK(found.beta[k] == 0);
}

TEST_CASE("States of a regression merge in any grouping, with themselves too") {
  const auto rows = random_rows<3>(60, {{1, 2, -1}}, 0.3, 6);
  const auto all = regression<3>(rows).solve();
  const auto part = [&](std::ptrdiff_t from, std::ptrdiff_t to) {
    return regression<3>(std::vector(rows.begin() + from, rows.begin() + to));
  };
  auto left = part(0, 7);
  left.merge(part(7, 40));
  left.merge(part(40, 60));
  auto tail = part(40, 60);
  tail.merge(part(7, 40));
  auto right = part(0, 7);
  right.merge(tail);
  least_squares<double, 3> into_empty;
  into_empty.merge(left);
  for (const auto& merged : {left, right, into_empty}) {
    CHECK(merged.rows() == 60);
    for (int k = 0; k < 3; ++k) CHECK(merged.solve().beta[k] == Approx(all.beta[k]).epsilon(1e-12));
    CHECK(merged.solve().residual_norm == Approx(all.residual_norm).epsilon(1e-12));
  }
  auto twice = regression<3>(rows);
  twice.merge(twice);
  CHECK(twice.rows() == 120);
  CHECK(twice.solve().beta[1] == Approx(all.beta[1]).epsilon(1e-12));
  CHECK(twice.solve().residual_norm == Approx(std::sqrt(2.0) * all.residual_norm).epsilon(1e-12));
}

TEST_CASE("No scale of y changes a coefficient by more than its scale") {
  const auto rows = random_rows<2>(30, {{1, 2}}, 0.5, 7);
  const auto one = regression<2>(rows).solve();
  for (const double unit : {1e-300, 1e-100, 1e100, 1e300}) {
    auto scaled = rows;
    for (auto& row : scaled) row.y *= unit;
    const auto found = regression<2>(scaled).solve();
    for (int k = 0; k < 2; ++k) CHECK(found.beta[k] / unit == Approx(one.beta[k]).epsilon(1e-12));
    CHECK(found.residual_norm / unit == Approx(one.residual_norm).epsilon(1e-12));
  }
}

TEMPLATE_TEST_CASE("A colour is regressed by component", "", float, double) {
  random_numbers random(8);
  least_squares<colour<TestType>, 2> sums;
  for (int j = 0; j < 50; ++j) {
    const TestType x = static_cast<TestType>(random());
    const TestType y = static_cast<TestType>(random());
    sums.add({{static_cast<double>(x), static_cast<double>(y)}}, {{x, 2 * y, x - y}});
  }
  const auto found = sums.solve();
  const double near = std::is_same_v<TestType, float> ? 1e-5 : 1e-12;
  const double wanted[2][3] = {{1, 0, 1}, {0, 2, -1}};
  for (int k = 0; k < 2; ++k) {
    for (int i = 0; i < 3; ++i) {
      CHECK(static_cast<double>(found.beta[k][i]) == Approx(wanted[k][i]).margin(near));
    }
  }
}
