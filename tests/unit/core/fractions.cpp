// SPDX-License-Identifier: MIT
#include "catch.hpp"
#include "random.hpp"

#include <phimis/core/fractions.hpp>

#include <cmath>
#include <limits>

namespace {

constexpr int M = 5;

template <class Real>
Real sum(const phimis::per_technique<Real, M>& all) {
  Real total = 0;
  for (const Real a : all) total += a;
  return total;
}

}  // namespace

TEMPLATE_TEST_CASE("Equal fractions are all 1/M", "", float, double) {
  constexpr auto one = phimis::equal_fractions<TestType, 1>();
  static_assert(one[0] == 1, "");
  constexpr auto four = phimis::equal_fractions<TestType, 4>();
  for (const TestType a : four) CHECK(a == TestType(0.25));
}

TEMPLATE_TEST_CASE("Fractions with floors are on the simplex, above their floors, and proportional where free", "", float,
                   double) {
  // M products, M sums and one quotient each: under 4M roundings.
  constexpr TestType rounding = 4 * M * std::numeric_limits<TestType>::epsilon();
  random_numbers random(1);
  int bound = 0;
  for (int i = 0; i < 2000; ++i) {
    phimis::per_technique<TestType, M> shares{};
    phimis::per_technique<TestType, M> floors{};
    for (int k = 0; k < M; ++k) {
      shares[k] = static_cast<TestType>(random() < 0.2 ? 0 : random.over_decades(1e-4, 1));
      floors[k] = static_cast<TestType>(random() < 0.3 ? 0 : random() * 0.99 / M);
    }
    const auto alpha = phimis::with_floors(shares, floors);
    REQUIRE(std::fabs(sum(alpha) - 1) <= rounding);
    TestType c = 0;  // α_k = max(floor_k, c shares_k): c is known from any technique above its floor
    for (int k = 0; k < M; ++k) {
      REQUIRE(alpha[k] >= floors[k]);
      if (alpha[k] > floors[k] && shares[k] > 0) c = alpha[k] / shares[k];
    }
    for (int k = 0; k < M && c > 0; ++k) {
      if (alpha[k] == floors[k]) {
        REQUIRE(shares[k] * c <= floors[k] * (1 + rounding));
        if (floors[k] > 0) ++bound;
      } else {
        REQUIRE(std::fabs(alpha[k] - shares[k] * c) <= rounding * alpha[k]);
      }
    }
  }
  CHECK(bound > 500);  // the floors were active
}

TEMPLATE_TEST_CASE("Without shares the free budget is shared equally", "", float, double) {
  const phimis::per_technique<TestType, 3> none{};
  const auto alpha = phimis::with_floors(none, {{TestType(0.5), 0, 0}});
  CHECK(alpha[0] == TestType(0.5));
  CHECK(alpha[1] == TestType(0.25));
  CHECK(alpha[2] == TestType(0.25));
}

TEMPLATE_TEST_CASE("Floors that sum to one are the fractions", "", float, double) {
  const phimis::per_technique<TestType, 4> floors{{TestType(0.1), TestType(0.2), TestType(0.3), TestType(0.4)}};
  const auto alpha = phimis::with_floors<TestType, 4>({{1, 0, 0, 7}}, floors);
  for (int k = 0; k < 4; ++k) CHECK(std::fabs(alpha[k] - floors[k]) <= 4 * std::numeric_limits<TestType>::epsilon());
}

TEMPLATE_TEST_CASE("Floors bind one after the other", "", float, double) {
  // Raising the first to .5 leaves .5 for shares 4 : 1, .4 and .1; raising the third to .2 leaves .3 for the second.
  const auto alpha = phimis::with_floors<TestType, 3>({{1, 8, 2}}, {{TestType(0.5), 0, TestType(0.2)}});
  constexpr TestType epsilon = std::numeric_limits<TestType>::epsilon();
  CHECK(alpha[0] == TestType(0.5));
  CHECK(std::fabs(alpha[1] - TestType(0.3)) <= epsilon);
  CHECK(alpha[2] == TestType(0.2));
}

TEMPLATE_TEST_CASE("The scale of the shares changes no fraction", "", float, double) {
  const TestType large = std::numeric_limits<TestType>::max() / 16;
  const TestType small = std::numeric_limits<TestType>::min() * 16;
  const phimis::per_technique<TestType, 3> shares{{1, 2, 5}};
  const phimis::per_technique<TestType, 3> floors{{TestType(0.2), 0, 0}};
  const auto wanted = phimis::with_floors(shares, floors);
  for (const TestType scale : {large, small}) {
    auto scaled = shares;
    for (int k = 0; k < 3; ++k) scaled[k] *= scale;
    const auto alpha = phimis::with_floors(scaled, floors);
    for (int k = 0; k < 3; ++k) {
      CHECK(std::fabs(alpha[k] - wanted[k]) <= 4 * std::numeric_limits<TestType>::epsilon() * wanted[k]);
    }
  }
}

TEMPLATE_TEST_CASE("The mixture is the sum of fractions times pdfs", "", float, double) {
  constexpr phimis::per_technique<TestType, 3> alpha{{TestType(0.25), TestType(0.5), TestType(0.25)}};
  constexpr phimis::per_technique<TestType, 3> pdfs{{4, 8, 0}};
  static_assert(phimis::mixture(alpha, pdfs) == 5, "");
  CHECK(alpha.size() == 3);
}

TEMPLATE_TEST_CASE("Shares whose sum is no number are shared like any others", "", float, double) {
  const TestType largest = std::numeric_limits<TestType>::max();
  const auto alpha = phimis::with_floors<TestType, 3>({{largest, largest, largest / 2}}, {{0, 0, TestType(0.5)}});
  CHECK(alpha[0] == TestType(0.25));
  CHECK(alpha[1] == TestType(0.25));
  CHECK(alpha[2] == TestType(0.5));
}
