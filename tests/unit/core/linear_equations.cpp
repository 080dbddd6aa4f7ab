// SPDX-License-Identifier: MIT
#include "catch.hpp"
#include "random.hpp"

#include <phimis/core/linear_equations.hpp>

#include <cmath>

namespace {

using phimis::linear_equations;
using phimis::movable_techniques;

template <int M>
phimis::rule_options<double, M> free_options() {
  return phimis::without_floors<double, M>();
}

/// P_ik of overlapping pdfs: the diagonal dominates by the given factor.
template <int M>
linear_equations<M> random_equations(random_numbers& random, double diagonal) {
  linear_equations<M> e{};
  e.rounding = 2.3e-16;
  for (int k = 0; k < M; ++k) {
    e.f[k] = random.between(0.1, 2);
    for (int i = 0; i < M; ++i) e.p[i][k] = random.between(0.1, 1) * (i == k ? diagonal : 1);
  }
  return e;
}

/// Σ_i α_i P_ik / F_k is the same for every technique.
template <int M>
bool solves(const linear_equations<M>& e, const phimis::fractions<double, M>& alpha, const bool (&moves)[M]) {
  double first = -1;
  for (int k = 0; k < M; ++k) {
    if (!moves[k]) continue;
    double sum = 0;
    for (int i = 0; i < M; ++i) sum += alpha[i] * e.p[i][k];
    if (first < 0) first = sum / e.f[k];
    if (std::fabs(sum / e.f[k] - first) > 1e-12 * std::fabs(first)) return false;
  }
  return true;
}

}  // namespace

TEST_CASE("Two techniques have the fraction of Eq. 17") {
  random_numbers random(1);
  const movable_techniques<2> on(free_options<2>());
  for (int trial = 0; trial < 200; ++trial) {
    const auto e = random_equations<2>(random, 3);
    double tau[2];
    REQUIRE(e.solve(on, on.all(), tau));
    const long double p11 = e.p[0][0], p12 = e.p[0][1], p21 = e.p[1][0], p22 = e.p[1][1], f1 = e.f[0], f2 = e.f[1];
    const long double alpha = (p22 * f1 - p21 * f2) / (p11 * f2 - p21 * f2 - p12 * f1 + p22 * f1);
    CHECK(std::fabs(tau[0] - static_cast<double>(alpha)) <= 1e-14 * (1 + std::fabs(static_cast<double>(alpha))));
    CHECK(tau[0] + tau[1] == Approx(1).epsilon(1e-14));
  }
}

TEST_CASE("Many techniques satisfy Eq. 14, whatever their floors") {
  random_numbers random(2);
  auto options = free_options<5>();
  for (int trial = 0; trial < 200; ++trial) {
    if (trial == 100) options.floors = {{0.01, 0, 0.1, 0.02, 0.3}};
    const movable_techniques<5> on(options);
    const auto e = random_equations<5>(random, 4);
    double tau[5];
    REQUIRE(e.solve(on, on.all(), tau));
    CHECK(solves(e, on.at(tau), {true, true, true, true, true}));
  }
}

TEST_CASE("A frozen technique stays and has no equation") {
  random_numbers random(3);
  auto options = free_options<4>();
  options.start = {{0.1, 0.2, 0.3, 0.4}};
  options.frozen[2] = true;
  const movable_techniques<4> on(options);
  CHECK(on.size == 3);
  for (int trial = 0; trial < 50; ++trial) {
    const auto e = random_equations<4>(random, 4);
    double tau[4];
    REQUIRE(e.solve(on, on.all(), tau));
    const auto alpha = on.at(tau);
    CHECK(alpha[2] == 0.3);
    CHECK(alpha[0] + alpha[1] + alpha[2] + alpha[3] == Approx(1).epsilon(1e-14));
    CHECK(solves(e, alpha, {true, true, false, true}));
  }
}

TEST_CASE("Dropping the most negative fraction solves the equations that are left") {
  random_numbers random(4);
  const movable_techniques<5> on(free_options<5>());
  int dropped = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const auto e = random_equations<5>(random, 2);
    double tau[5];
    if (!e.solve(on, on.all(), tau)) continue;
    int first = 0;
    for (int i = 1; i < 5; ++i) {
      if (tau[i] < tau[first]) first = i;
    }
    const bool negative = tau[first] < 0;
    REQUIRE(e.drop_most_negative(on, tau));
    bool moves[5];
    for (int i = 0; i < 5; ++i) {
      CHECK(tau[i] >= 0);
      moves[i] = tau[i] > 0;
      dropped += moves[i] ? 0 : 1;
    }
    if (negative) CHECK(tau[first] == 0);
    CHECK(solves(e, on.at(tau), moves));
  }
  CHECK(dropped > 300);
}

TEST_CASE("A technique that is left alone has all that is free") {
  // Each equation by itself asks for a negative fraction of the other.
  linear_equations<2> e{{{1, 3}, {3, 1}}, {1, 10}, 2.3e-16};
  const movable_techniques<2> on(free_options<2>());
  double tau[2];
  REQUIRE(e.solve(on, on.all(), tau));
  REQUIRE(tau[1] < 0);
  REQUIRE(e.drop_most_negative(on, tau));
  CHECK(tau[0] == 1);
  CHECK(tau[1] == 0);
}

TEST_CASE("The best face is the feasible one of least cost, on the largest faces that have one") {
  random_numbers random(5);
  const movable_techniques<4> on(free_options<4>());
  int small = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const auto e = random_equations<4>(random, 1.5);
    const phimis::per_technique<double, 4> price{{random(), random(), random(), random()}};
    const auto cost = [&](const phimis::fractions<double, 4>& alpha) { return phimis::mixture(alpha, price); };
    double tau[4];
    REQUIRE(e.best_face(on, cost, tau));
    // By hand, in order of size.
    double least = 1e300;
    int size = 3;
    for (; size >= 1 && least == 1e300; --size) {
      for (unsigned face = 1; face < 15; ++face) {
        double trial_tau[4];
        int bits = 0;
        for (int i = 0; i < 4; ++i) bits += (face >> i & 1u) != 0 ? 1 : 0;
        if (bits != size || !e.solve(on, face, trial_tau) || !on.feasible(trial_tau)) continue;
        least = std::fmin(least, cost(on.at(trial_tau)));
      }
    }
    small += size < 2 ? 1 : 0;
    CHECK(on.feasible(tau));
    CHECK(cost(on.at(tau)) == least);
  }
  CHECK(small > 10);
}

TEST_CASE("Equal pdfs, and techniques without samples, have no solution") {
  const movable_techniques<3> on(free_options<3>());
  double tau[3];
  linear_equations<3> equal{{{2, 3, 1}, {2, 3, 1}, {1, 1, 4}}, {1, 1, 1}, 2.3e-16};
  CHECK_FALSE(equal.solve(on, on.all(), tau));
  CHECK(equal.solve(on, 5, tau));  // without the second
  CHECK(tau[1] == 0);
  linear_equations<3> silent{{{2, 3, 0}, {2, 1, 0}, {1, 1, 0}}, {1, 1, 0}, 2.3e-16};
  CHECK_FALSE(silent.solve(on, on.all(), tau));
  CHECK(silent.solve(on, 3, tau));
}

TEST_CASE("Pdfs that differ by rounding alone have no solution") {
  const movable_techniques<2> on(free_options<2>());
  const double third = 0.1 * 3;
  REQUIRE(third != 0.3);
  const linear_equations<2> e{{{third, 0.7}, {0.3, 0.7}}, {1, 3}, 2.3e-16};
  double tau[2];
  CHECK_FALSE(e.solve(on, on.all(), tau));
}

TEST_CASE("A solution whose sum is no number is none") {
  phimis::linear_equations<3> equations{};
  equations.rounding = phimis::epsilon<double>;
  for (int k = 0; k < 3; ++k) {
    equations.p[k][k] = 1e-300;
    equations.f[k] = 1e8;
  }
  const phimis::movable_techniques<3> on(phimis::without_floors<double, 3>());
  double tau[3] = {};
  CHECK_FALSE(equations.solve(on, on.all(), tau));
}
