// SPDX-License-Identifier: MIT
#include "catch.hpp"
#include "random.hpp"

#include <phimis/core/estimator.hpp>
#include <phimis/core/weight_heuristic.hpp>

#include <cmath>
#include <limits>

namespace {

constexpr int M = 4;

template <class Real>
using numbers = phimis::per_technique<Real, M>;

template <class Real>
numbers<Real> random_pdfs(random_numbers& random) {
  numbers<Real> pdfs{};
  for (int k = 0; k < M; ++k) pdfs[k] = static_cast<Real>(random() < 0.2 ? 0 : random.over_decades(1e-2, 1e2));
  return pdfs;
}

template <class Real, class Heuristic>
void check_weights(const Heuristic& heuristic) {
  constexpr Real rounding = 8 * M * std::numeric_limits<Real>::epsilon();
  // β |log share| roundings of a share of at least 1e-6, for the powers.
  constexpr Real scaled_rounding = 20 * rounding;
  random_numbers random(1);
  for (int i = 0; i < 500; ++i) {
    const auto pdfs = random_pdfs<Real>(random);
    const auto alpha = phimis::with_floors(random_pdfs<Real>(random), numbers<Real>{});
    const bool any = phimis::mixture(alpha, pdfs) > 0;
    Real sum = 0;
    for (int k = 0; k < M; ++k) {
      const Real w = heuristic(k, alpha, pdfs);
      REQUIRE(w >= 0);
      REQUIRE(w <= 1 + rounding);
      if (!(alpha[k] * pdfs[k] > 0)) REQUIRE(w == 0);
      sum += w;
      // No unit of the pdfs changes a weight.
      for (const Real unit :
           {std::numeric_limits<Real>::max() / Real(1e4), std::numeric_limits<Real>::min() * Real(1e8)}) {
        auto scaled = pdfs;
        for (int l = 0; l < M; ++l) scaled[l] *= unit;
        REQUIRE(std::fabs(heuristic(k, alpha, scaled) - w) <= scaled_rounding);
      }
    }
    if (any) {
      REQUIRE(std::fabs(sum - 1) <= rounding);
    } else {
      REQUIRE(sum == 0);
    }
  }
  for (int k = 0; k < M; ++k) CHECK(heuristic(k, phimis::equal_fractions<Real, M>(), numbers<Real>{}) == 0);
}

constexpr numbers<double> alpha{{0.1, 0.2, 0.3, 0.4}};
constexpr numbers<double> pdfs{{10, 10, 1, 0}};  // α p = 1, 2, .3, 0

}  // namespace

TEMPLATE_TEST_CASE("Balance weights sum to one and are free of units", "", float, double) {
  check_weights<TestType>(phimis::balance{});
}
TEMPLATE_TEST_CASE("Power weights sum to one and are free of units", "", float, double) {
  for (const double beta : {0.0, 0.5, 1.0, 2.0, 3.0, 20.0}) check_weights<TestType>(phimis::power{beta});
}
TEMPLATE_TEST_CASE("Maximum weights sum to one and are free of units", "", float, double) {
  check_weights<TestType>(phimis::maximum{});
}
TEMPLATE_TEST_CASE("Cutoff weights sum to one and are free of units", "", float, double) {
  for (const double threshold : {0.0, 0.1, 0.7, 1.0}) check_weights<TestType>(phimis::cutoff{threshold});
}

TEST_CASE("The heuristics have the values of their formulas") {
  const double epsilon = 4 * std::numeric_limits<double>::epsilon();
  const double shares[M] = {1, 2, 0.3, 0};
  for (int k = 0; k < M; ++k) {
    CHECK(std::fabs(phimis::balance{}(k, alpha, pdfs) - shares[k] / 3.3) <= epsilon);
    CHECK(std::fabs(phimis::power{2}(k, alpha, pdfs) - shares[k] * shares[k] / 5.09) <= epsilon);
    CHECK(std::fabs(phimis::power{3}(k, alpha, pdfs) - std::pow(shares[k], 3) / 9.027) <= epsilon);
    CHECK(phimis::maximum{}(k, alpha, pdfs) == (k == 1 ? 1 : 0));
    // .2 of the largest is .4: the third is cut.
    CHECK(std::fabs(phimis::cutoff{0.2}(k, alpha, pdfs) - (k < 2 ? shares[k] / 3 : 0)) <= epsilon);
    CHECK(std::fabs(phimis::cutoff{0.1}(k, alpha, pdfs) - shares[k] / 3.3) <= epsilon);
  }
  CHECK(phimis::power{}.beta == 2);
}

TEST_CASE("Of equals the maximum heuristic takes the first") {
  const auto equal = phimis::equal_fractions<double, M>();
  const numbers<double> ties{{1, 3, 3, 3}};
  for (int k = 0; k < M; ++k) CHECK(phimis::maximum{}(k, equal, ties) == (k == 1 ? 1 : 0));
}

TEST_CASE("The heuristics meet where their parameters make them the same") {
  random_numbers random(2);
  for (int i = 0; i < 200; ++i) {
    const auto p = random_pdfs<double>(random);
    const auto a = phimis::with_floors(random_pdfs<double>(random), numbers<double>{});
    for (int k = 0; k < M; ++k) {
      const double balanced = phimis::balance{}(k, a, p);
      REQUIRE(std::fabs(phimis::power{1}(k, a, p) - balanced) <= 1e-14);
      REQUIRE(std::fabs(phimis::cutoff{0}(k, a, p) - balanced) <= 1e-14);
      REQUIRE(phimis::cutoff{1}(k, a, p) == phimis::maximum{}(k, a, p));  // no ties among random numbers
      // Shares differ by more than 1e-5 of the largest, (1 − 1e-5)^1e8 = 1e-434.
      REQUIRE(std::fabs(phimis::power{1e8}(k, a, p) - phimis::maximum{}(k, a, p)) <= 1e-14);
    }
  }
}

TEST_CASE("Power zero shares equally among the techniques that reach a point") {
  for (int k = 0; k < M; ++k) CHECK(phimis::power{0}(k, alpha, pdfs) == (k < 3 ? 1.0 / 3 : 0));
}

TEST_CASE("Count-independent weights are those of the heuristic at equal fractions, whatever the fractions") {
  using phimis::count_independent;
  const auto equal = phimis::equal_fractions<double, M>();
  random_numbers random(3);
  for (int i = 0; i < 200; ++i) {
    const auto p = random_pdfs<double>(random);
    const auto a = phimis::with_floors(random_pdfs<double>(random), numbers<double>{});
    double sum = 0;
    for (int k = 0; k < M; ++k) {
      REQUIRE(count_independent<>{}(k, a, p) == phimis::balance{}(k, equal, p));
      REQUIRE(count_independent{phimis::power{3}}(k, a, p) == phimis::power{3}(k, equal, p));
      REQUIRE(count_independent{phimis::cutoff{0.3}}(k, a, p) == phimis::cutoff{0.3}(k, equal, p));
      REQUIRE(count_independent{phimis::maximum{}}(k, a, p) == phimis::maximum{}(k, equal, p));
      sum += count_independent<>{}(k, a, p);
    }
    if (phimis::mixture(equal, p) > 0) REQUIRE(sum == Approx(1));
  }
  for (int k = 0; k < M; ++k) CHECK(count_independent<>{}(k, alpha, numbers<double>{}) == 0);
}

TEMPLATE_TEST_CASE(
    "A contribution under count-independent balance weights is f over the sum of pdfs, over the fraction", "", float,
    double) {
  // N times the estimate: y = f / (α_k Σ p)
  const numbers<TestType> a{{TestType(0.125), TestType(0.25), TestType(0.125), TestType(0.5)}};
  const numbers<TestType> p{{8, 2, 4, 2}};
  for (int k = 0; k < M; ++k) {
    CHECK(phimis::contribution(phimis::count_independent<>{}, k, TestType(3), a, p) == TestType(3) / 16 / a[k]);
  }
  CHECK(phimis::contribution(phimis::count_independent<>{}, 0, TestType(0), a, numbers<TestType>{}) == 0);
}
