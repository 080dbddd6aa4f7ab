// SPDX-License-Identifier: MIT
#include "catch.hpp"
#include "random.hpp"

#include <phimis/core/solve_pair.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace {

using phimis::pair_fractions;
using phimis::pair_solution;
using phimis::pair_sums;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double epsilon = 4 * std::numeric_limits<double>::epsilon();
constexpr pair_fractions zero{0, 1};
constexpr pair_fractions one{1, 0};

/// ζ = a^-n − c b^-n: its root has a/b = c^{-1/n}. The γ-moments of two techniques that share no point.
struct powers {
  double n, c;
  pair_sums operator()(const pair_fractions& alpha) const {
    const double first = std::pow(alpha.first, -n);
    const double second = c * std::pow(alpha.second, -n);
    return {first - second, n * (first / alpha.first + second / alpha.second), first + second};
  }
  pair_fractions root() const {
    const double ratio = std::pow(c, -1 / n);
    return {ratio / (1 + ratio), 1 / (1 + ratio)};
  }
};

/// Each fraction to its own last digits.
void check_root(const pair_solution& found, const pair_fractions& wanted, double tolerance) {
  CHECK(std::fabs(found.alpha.first - wanted.first) <= tolerance * wanted.first);
  CHECK(std::fabs(found.alpha.second - wanted.second) <= tolerance * wanted.second);
  CHECK(found.evaluations <= 100);
}

}  // namespace

TEST_CASE("A linear condition is solved in one step") {
  for (const double root : {0.1, 0.5, 0.93}) {
    const auto line = [root](const pair_fractions& alpha) { return pair_sums{root - alpha.first, 1, 1}; };
    for (const double start : {0.2, 0.5, 0.999}) {
      const auto found = phimis::solve_pair(line, zero, one, {start, 1 - start}, epsilon);
      check_root(found, {root, 1 - root}, 1e-14);
      CHECK(found.residual <= 1e-15);
      CHECK(found.evaluations <= 8);
    }
  }
}

TEST_CASE("A root is found from any start, also from ends where the condition is infinite") {
  for (const double n : {0.1, 1.0, 2.0, 20.0}) {
    for (const double c : {1e-3, 1.0, 7.0, 1e6}) {
      const powers f{n, c};
      const double conditioning = 1 + 1 / n;  // of the root on the rounding of the powers
      for (const pair_fractions start : {zero, one, pair_fractions{0.5, 0.5}, pair_fractions{1e-9, 1 - 1e-9},
                                         pair_fractions{1 - 1e-9, 1e-9}}) {
        INFO("n " << n << ", c " << c << ", start " << start.first);
        const auto found = phimis::solve_pair(f, zero, one, start, epsilon);
        check_root(found, f.root(), 20 * conditioning * epsilon);
        CHECK(found.residual <= 100 * (n + 1) * epsilon);
      }
    }
  }
}

namespace {

/// Two techniques that share no point, by s = ±t^β, also below 0: log(G_1/G_2) is linear in log(α_1/α_2).
struct disjoint {
  double beta, c;
  pair_sums operator()(const pair_fractions& alpha) const {
    const double g1 = std::pow(alpha.first, -beta);
    const double g2 = c * std::pow(alpha.second, -beta);
    const double sign = beta < 0 ? -1 : 1;
    return {sign * (g1 - g2), std::fabs(beta) * (g1 / alpha.first + g2 / alpha.second),
            alpha.first * g1 + alpha.second * g2, beta};
  }
  pair_fractions root() const {
    const double ratio = std::pow(c, -1 / beta);
    return {ratio / (1 + ratio), 1 / (1 + ratio)};
  }
};

}  // namespace

TEST_CASE("Where the score is a power, techniques that share nothing are balanced in one step") {
  for (const double beta : {0.5, 1.0, 2.0, 5.0, -0.5, -1.0}) {
    for (const double decades : {-6.0, -1.5, -0.3, 0.0, 0.7, 1.5, 6.0}) {
      const disjoint f{beta, std::pow(10, decades * beta)};
      for (const double start : {0.5, 0.2, 0.9}) {
        INFO("beta " << beta << ", decades " << decades << ", start " << start);
        const auto found = phimis::solve_pair(f, zero, one, {start, 1 - start}, epsilon);
        check_root(found, f.root(), 20 * (1 + 1 / std::fabs(beta)) * epsilon);
        // The start, the root, and another where the root has rounding to lose; near an end that is tried first.
        CHECK(found.evaluations <= (std::fabs(decades) < 2 ? 3 : 10));
      }
    }
  }
}

TEST_CASE("A root near either end is precise in the small fraction") {
  for (const double small : {1e-6, 1e-12, 1e-100}) {
    // n = 1: a/b = 1/c.
    for (const powers f : {powers{1, 1 / small}, powers{1, small}, powers{2, 1 / small / small}}) {
      for (const pair_fractions start : {zero, one, pair_fractions{0.5, 0.5}}) {
        INFO("c " << f.c << ", start " << start.first);
        check_root(phimis::solve_pair(f, zero, one, start, epsilon), f.root(), 20 * epsilon);
      }
    }
  }
}

TEST_CASE("A root whose products with its bracket are no numbers is found by halving alone") {
  for (const double small : {1e-180, 1e-250, 1e-290}) {
    for (const powers f : {powers{1, 1 / small}, powers{1, small}}) {
      for (const pair_fractions start : {zero, one, pair_fractions{0.5, 0.5}}) {
        INFO("c " << f.c << ", start " << start.first);
        const auto found = phimis::solve_pair(f, zero, one, start, epsilon);
        CHECK(std::fabs(found.alpha.first / f.root().first - 1) <= 20 * epsilon);
        CHECK(std::fabs(found.alpha.second / f.root().second - 1) <= 20 * epsilon);
      }
    }
  }
}

TEST_CASE("An end is the answer where the condition points out of it") {
  const auto up = [](const pair_fractions& alpha) { return pair_sums{2 - alpha.first, 1, 3}; };
  const auto down = [](const pair_fractions& alpha) { return pair_sums{-1 - alpha.first, 1, 3}; };
  const pair_fractions low{0.05, 0.95}, high{0.8, 0.2};
  for (const pair_fractions start : {low, pair_fractions{0.4, 0.6}, high}) {
    const auto at_high = phimis::solve_pair(up, low, high, start, epsilon);
    CHECK(at_high.alpha.first == high.first);
    CHECK(at_high.alpha.second == high.second);
    CHECK(at_high.residual == 0);
    CHECK(at_high.evaluations <= 3);
    const auto at_low = phimis::solve_pair(down, low, high, start, epsilon);
    CHECK(at_low.alpha.first == low.first);
    CHECK(at_low.alpha.second == low.second);
    CHECK(at_low.residual == 0);
    CHECK(at_low.evaluations <= 3);
  }
  for (const pair_fractions start : {zero, one}) {
    CHECK(phimis::solve_pair(up, zero, one, start, epsilon).alpha.first == 1);
    CHECK(phimis::solve_pair(down, zero, one, start, epsilon).alpha.first == 0);
  }
}

TEST_CASE("Bounds that leave one point give that point") {
  const powers f{1, 4};
  const auto found = phimis::solve_pair(f, {0.3, 0.7}, {0.3, 0.7}, {0.3, 0.7}, epsilon);
  CHECK(found.alpha.first == 0.3);
  CHECK(found.alpha.second == 0.7);
  CHECK(found.residual == 0);
}

TEST_CASE("A root at an end is found") {
  const auto at_zero = [](const pair_fractions& alpha) { return pair_sums{-alpha.first, 1, 1}; };
  const auto at_one = [](const pair_fractions& alpha) { return pair_sums{alpha.second, 1, 1}; };
  for (const double start : {0.0, 0.3, 1.0}) {
    const auto low = phimis::solve_pair(at_zero, zero, one, {start, 1 - start}, epsilon);
    CHECK(low.alpha.first <= 1e-16);
    CHECK(low.residual <= 1e-16);
    const auto high = phimis::solve_pair(at_one, zero, one, {start, 1 - start}, epsilon);
    CHECK(high.alpha.second <= 1e-16);
    CHECK(high.residual <= 1e-16);
  }
}

TEST_CASE("A step is bracketed to its last digit") {
  for (const double root : {1e-12, 0.001, 0.37, 0.5, 0.75}) {
    for (const bool mirrored : {false, true}) {
      const auto step = [root, mirrored](const pair_fractions& alpha) {
        const bool before = mirrored ? alpha.second > root : alpha.first < root;
        return pair_sums{before ? 1.0 : -1.0, 0, 1};
      };
      for (const double start : {0.0, 0.5, 1.0}) {
        INFO("root " << root << ", mirrored " << mirrored << ", start " << start);
        const auto found = phimis::solve_pair(step, zero, one, {start, 1 - start}, epsilon);
        CHECK(found.bracketed);
        const double small = mirrored ? found.alpha.second : found.alpha.first;
        CHECK(std::fabs(small - root) <= 2 * epsilon * root);
        CHECK(found.evaluations <= 100);
      }
    }
  }
}

TEST_CASE("Rounding of the height of a step does not keep a point that is further from it") {
  for (const double root : {1e-6, 0.126193, 0.75}) {
    for (const double start : {0.0, 1e-9, 0.5, 0.999, 1.0}) {
      INFO("root " << root << ", start " << start);
      random_numbers random(3);
      const auto step = [&](const pair_fractions& alpha) {
        const double height = 1 + 1e-15 * random.between(-1, 1);
        return pair_sums{alpha.first < root ? height : -2 * height, 0, 1};
      };
      const auto found = phimis::solve_pair(step, zero, one, {start, 1 - start}, epsilon);
      CHECK(found.bracketed);
      CHECK(std::fabs(found.alpha.first - root) <= 2 * epsilon * std::min(root, 1 - root));
    }
  }
}

TEST_CASE("A condition that is not a number at an end pushes away from it") {
  const auto line = [](const pair_fractions& alpha) {
    const bool end = alpha.first == 0 || alpha.second == 0;
    return end ? pair_sums{not_a_number, not_a_number, not_a_number} : pair_sums{0.3 - alpha.first, 1, 1};
  };
  for (const double start : {0.0, 0.4, 1.0}) {
    check_root(phimis::solve_pair(line, zero, one, {start, 1 - start}, epsilon), {0.3, 0.7}, 1e-14);
  }
}

TEST_CASE("A slope that is wrong or missing costs evaluations, not the root") {
  const powers f{1, 9};
  for (const double slope : {0.0, -1.0, not_a_number, infinity, 1e-3, 1e3}) {
    INFO("slope " << slope);
    const auto wrong = [&](const pair_fractions& alpha) {
      pair_sums at = f(alpha);
      at.slope = slope;
      return at;
    };
    const auto found = phimis::solve_pair(wrong, zero, one, {0.5, 0.5}, epsilon);
    check_root(found, f.root(), 20 * epsilon);
  }
}

TEST_CASE("Far starts take few evaluations, near ones fewer") {
  random_numbers random(1);
  int many = 0;
  for (int i = 0; i < 200; ++i) {
    const powers f{random.between(0.3, 3), random.over_decades(0.1, 10)};
    const int evaluations = phimis::solve_pair(f, zero, one, {0.5, 0.5}, epsilon).evaluations;
    many += evaluations > 8;
    REQUIRE(evaluations <= 30);
    const pair_fractions root = f.root();
    const pair_fractions close{root.first * (1 + 1e-4), root.second - root.first * 1e-4};
    REQUIRE(phimis::solve_pair(f, zero, one, close, epsilon).evaluations <= 6);
  }
  CHECK(many < 30);  // those whose first step leaves the simplex
}

TEST_CASE("No condition takes more than 100 evaluations") {
  random_numbers random(2);
  for (int i = 0; i < 300; ++i) {
    int evaluations = 0;
    const int kind = i % 4;
    const auto noise = [&](const pair_fractions& alpha) {
      ++evaluations;
      const double x = random.between(-1, 1);
      if (kind == 0) return pair_sums{x, random(), 1};
      if (kind == 1) return pair_sums{not_a_number, not_a_number, not_a_number};
      if (kind == 2) return pair_sums{alpha.first < 0.5 ? infinity : -infinity, infinity, infinity};
      return pair_sums{x < 0 ? not_a_number : x, -x, 0};
    };
    const auto found = phimis::solve_pair(noise, zero, one, {0.3, 0.7}, epsilon);
    REQUIRE(evaluations == found.evaluations);
    REQUIRE(evaluations <= 100);
    REQUIRE(found.alpha.first >= 0);
    REQUIRE(found.alpha.second >= 0);
    REQUIRE(std::fabs(found.alpha.first + found.alpha.second - 1) <= epsilon);
  }
}
