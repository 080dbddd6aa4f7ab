// SPDX-License-Identifier: MIT
#include "catch.hpp"
#include "random.hpp"

#include <phimis/core/counts.hpp>

#include <cmath>
#include <cstdint>
#include <limits>

namespace {

constexpr int M = 5;

template <class Real>
phimis::fractions<Real, M> random_fractions(random_numbers& random) {
  phimis::per_technique<Real, M> shares{};
  for (int k = 0; k < M; ++k) shares[k] = static_cast<Real>(random() < 0.2 ? 0 : random.over_decades(1e-3, 1));
  if (!(phimis::mixture(shares, phimis::per_technique<Real, M>{{1, 1, 1, 1, 1}}) > 0)) shares[random.below(M)] = 1;
  return phimis::with_floors(shares, phimis::per_technique<Real, M>{});
}

std::int64_t sum(const phimis::counts<M>& n) {
  std::int64_t total = 0;
  for (const std::int64_t count : n) total += count;
  return total;
}

}  // namespace

TEMPLATE_TEST_CASE("Largest remainder gives counts that sum to N, each within one of its share", "", float, double) {
  random_numbers random(1);
  int raised = 0;
  for (int i = 0; i < 2000; ++i) {
    const auto alpha = random_fractions<TestType>(random);
    const std::int64_t budget = i % 4 == 0 ? random.below(8) : random.below(3000);
    const auto n = phimis::split_largest_remainder(alpha, budget);
    REQUIRE(sum(n) == budget);
    int positive = 0;
    int one_by_clause = 0;
    for (int k = 0; k < M; ++k) {
      positive += alpha[k] > 0;
      one_by_clause += n[k] == 1 && static_cast<double>(alpha[k]) * static_cast<double>(budget) < 1;
    }
    for (int k = 0; k < M; ++k) {
      const double share = static_cast<double>(alpha[k]) * static_cast<double>(budget);
      REQUIRE(n[k] >= 0);
      if (!(alpha[k] > 0)) REQUIRE(n[k] == 0);
      if (budget >= positive && alpha[k] > 0) REQUIRE(n[k] >= 1);
      // Each sample that the at-least-one clause gives is taken from a larger count.
      const double allowed = 1 + (budget >= positive ? one_by_clause : 0);
      REQUIRE(std::fabs(static_cast<double>(n[k]) - share) < allowed + 1e-3);
    }
    raised += one_by_clause;
  }
  CHECK(raised > 50);  // the clause was met
}

TEST_CASE("Largest remainder gives what is left to the largest fractional parts") {
  // Shares 3.5, 2.7, .9, 1.6, 1.3 of 10: floors 3 2 0 1 1, three left for .9, .7, .6.
  const auto n = phimis::split_largest_remainder<double, M>({{0.35, 0.27, 0.09, 0.16, 0.13}}, 10);
  CHECK(n[0] == 3);
  CHECK(n[1] == 3);
  CHECK(n[2] == 1);
  CHECK(n[3] == 2);
  CHECK(n[4] == 1);
}

TEST_CASE("Every technique with a fraction gets a sample where the budget allows") {
  const auto enough = phimis::split_largest_remainder<double, 3>({{0.98, 0.01, 0.01}}, 3);
  for (const std::int64_t count : enough) CHECK(count == 1);
  const auto none = phimis::split_largest_remainder<double, 3>({{0.98, 0.02, 0}}, 3);
  CHECK(none[0] == 2);
  CHECK(none[1] == 1);
  CHECK(none[2] == 0);
  const auto scarce = phimis::split_largest_remainder<double, 3>({{0.5, 0.3, 0.2}}, 2);
  CHECK(scarce[0] == 1);
  CHECK(scarce[1] == 1);
  CHECK(scarce[2] == 0);
  const auto nothing = phimis::split_largest_remainder<double, 3>({{0.5, 0.3, 0.2}}, 0);
  for (const std::int64_t count : nothing) CHECK(count == 0);
}

TEST_CASE("Largest remainder gives no sample to a technique without a fraction, whatever Σα rounds to") {
  // Σα is one last digit short of one: 60 samples of 1e9 are left though every share is a whole number.
  const float short_of_one = std::nextafter(1.0f, 0.0f);
  const std::int64_t budget = std::int64_t(1) << 30;
  const auto n = phimis::split_largest_remainder<float, 2>({{0, short_of_one}}, budget);
  CHECK(n[0] == 0);
  CHECK(n[1] == budget);
}

TEST_CASE("Systematic counts have the expectation Nα exactly and are rounded up or down") {
  // With α_k = a_k/64, the sum over u = 0, 1/64, .. 63/64 of ⌊x + u⌋ is 64x for every multiple x of 1/64 (Hermite).
  random_numbers random(2);
  for (int i = 0; i < 200; ++i) {
    int a[M] = {};
    for (int j = 0; j < 64; ++j) ++a[random.below(random.below(M) + 1)];
    phimis::fractions<double, M> alpha{};
    for (int k = 0; k < M; ++k) alpha[k] = a[k] / 64.0;
    const std::int64_t budget = random.below(50);
    std::int64_t total[M] = {};
    for (int u = 0; u < 64; ++u) {
      const auto n = phimis::split_systematic(alpha, budget, u / 64.0);
      REQUIRE(sum(n) == budget);
      for (int k = 0; k < M; ++k) {
        const double share = alpha[k] * static_cast<double>(budget);
        REQUIRE(static_cast<double>(n[k]) >= std::floor(share));
        REQUIRE(static_cast<double>(n[k]) <= std::ceil(share));
        total[k] += n[k];
      }
    }
    for (int k = 0; k < M; ++k) REQUIRE(total[k] == budget * a[k]);
  }
}

TEMPLATE_TEST_CASE("Systematic counts sum to N whatever Σα rounds to", "", float, double) {
  random_numbers random(3);
  for (int i = 0; i < 2000; ++i) {
    const auto alpha = random_fractions<TestType>(random);
    const std::int64_t budget = random.below(2) ? random.below(100) : random.below(1 << 30);
    const double u = i % 3 == 0 ? phimis::uniform(~std::uint64_t(0)) : random();
    const auto n = phimis::split_systematic(alpha, budget, u);
    REQUIRE(sum(n) == budget);
    // Σα is off by a few last digits: so is N times it.
    const double slack = 8 * static_cast<double>(std::numeric_limits<TestType>::epsilon() * TestType(budget));
    for (int k = 0; k < M; ++k) {
      REQUIRE(n[k] >= 0);
      if (!(alpha[k] > 0)) REQUIRE(n[k] == 0);
      REQUIRE(std::fabs(static_cast<double>(n[k]) - static_cast<double>(alpha[k]) * static_cast<double>(budget)) <=
              1 + slack);
    }
  }
}

TEMPLATE_TEST_CASE("A uniform number picks each technique with its fraction, never one without", "", float, double) {
  const phimis::fractions<TestType, M> alpha{{0, TestType(0.25), TestType(0.5), 0, TestType(0.25)}};
  int picked[M] = {};
  for (int i = 0; i < 64; ++i) ++picked[phimis::pick_technique(alpha, i / 64.0)];
  for (int k = 0; k < M; ++k) CHECK(picked[k] == 64 * static_cast<double>(alpha[k]));
  CHECK(phimis::pick_technique(alpha, 0.0) == 1);
  CHECK(phimis::pick_technique(alpha, phimis::uniform(~std::uint64_t(0))) == 4);
  // Σα < 1 by rounding, and the last fractions are 0.
  const phimis::fractions<TestType, 3> short_of_one{{TestType(0.5), TestType(0.5) - TestType(0.001), 0}};
  CHECK(phimis::pick_technique(short_of_one, 0.9999) == 1);
}
