// SPDX-License-Identifier: MIT
#include "catch.hpp"
#include "random.hpp"

#include <phimis/core/movable_techniques.hpp>

namespace {

using phimis::movable_techniques;

phimis::rule_options<double, 4> some_options() {
  auto options = phimis::without_floors<double, 4>();
  options.start = {{0.1, 0.2, 0.3, 0.4}};
  options.floors = {{0.05, 0.01, 0.15, 0}};
  options.frozen[1] = true;
  return options;
}

}  // namespace

TEST_CASE("Floors and frozen techniques are what is fixed") {
  const movable_techniques<4> on(some_options());
  REQUIRE(on.size == 3);
  CHECK(on.any());
  CHECK(on.technique[0] == 0);
  CHECK(on.technique[1] == 2);
  CHECK(on.technique[2] == 3);
  CHECK(on.free == Approx(1 - 0.05 - 0.2 - 0.15).epsilon(1e-15));
  const double tau[4] = {0.5, 0, 0.5, 7};
  const auto alpha = on.at(tau);
  CHECK(alpha[0] == Approx(0.05 + on.free / 2));
  CHECK(alpha[1] == 0.2);
  CHECK(alpha[2] == 0.15);
  CHECK(alpha[3] == Approx(on.free / 2));
  CHECK(on.feasible(tau));
  const double below[4] = {0.5, -1e-20, 0.5, 0};
  CHECK_FALSE(on.feasible(below));
}

TEST_CASE("Nothing moves with floors of one in all, or with one technique") {
  auto options = phimis::without_floors<double, 4>();
  options.frozen = {{true, true, true, false}};
  CHECK_FALSE(movable_techniques<4>(options).any());
  auto full = phimis::without_floors<double, 4>();
  full.floors = {{0.25, 0.25, 0.25, 0.25}};
  CHECK_FALSE(movable_techniques<4>(full).any());
}

TEST_CASE("The equations at the corners are those of the mixtures there") {
  random_numbers random(1);
  const movable_techniques<4> on(some_options());
  double p[6][4];
  double target[6];
  double g[4][4] = {};
  double b[4] = {};
  for (int j = 0; j < 6; ++j) {
    target[j] = random();
    for (int i = 0; i < 4; ++i) p[j][i] = random();
    for (int i = 0; i < 4; ++i) {
      b[i] += target[j] * p[j][i];
      for (int k = 0; k < 4; ++k) g[i][k] += p[j][i] * p[j][k];
    }
  }
  on.to_corners(g, b);
  for (int i = 0; i < 3; ++i) {
    const auto mixture = [&](int corner, int j) {
      double tau[4] = {};
      tau[corner] = 1;
      double x = 0;
      for (int k = 0; k < 4; ++k) x += on.at(tau)[k] * p[j][k];
      return x;
    };
    double right = 0;
    for (int j = 0; j < 6; ++j) right += target[j] * mixture(i, j);
    CHECK(b[i] == Approx(right).epsilon(1e-14));
    for (int k = 0; k < 3; ++k) {
      double product = 0;
      for (int j = 0; j < 6; ++j) product += mixture(i, j) * mixture(k, j);
      CHECK(g[i][k] == Approx(product).epsilon(1e-14));
    }
  }
}
