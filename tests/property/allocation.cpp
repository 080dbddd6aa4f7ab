// SPDX-License-Identifier: MIT
// Theorems 1 to 4 of Sbert, Havran & Szirmay-Kalos 2016, and Eq. 10, on random numbers.
#include "catch.hpp"
#include "random.hpp"

#include <phimis/analysis/allocation.hpp>
#include <phimis/analysis/optimum.hpp>
#include <phimis/analysis/variance.hpp>
#include <phimis/technique/density.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace {

using namespace phimis::analysis;
using phimis::measured;

template <int M>
using numbers = phimis::per_technique<double, M>;

/// σ² over six decades, some of them 0.
template <int M>
phimis::per_technique<measured, M> random_variances(random_numbers& random, double zeros = 0) {
  phimis::per_technique<measured, M> variances{};
  for (int k = 0; k < M; ++k) variances[k] = {random() < zeros ? 0 : random.over_decades(1e-3, 1e3), 0};
  return variances;
}

template <int M>
numbers<M> random_positive(random_numbers& random) {
  numbers<M> all{};
  for (int k = 0; k < M; ++k) all[k] = random.over_decades(1e-2, 1e2);
  return all;
}

template <int M>
phimis::fractions<double, M> random_fractions(random_numbers& random) {
  return phimis::with_floors(random_positive<M>(random), {});
}

template <int M>
double cost_of_variance(const phimis::per_technique<measured, M>& variances,
                        const phimis::fractions<double, M>& alpha, const numbers<M>& costs) {
  return mean_cost(alpha, costs) * variance_of_parts(variances, alpha).value;
}

/// A positive polynomial with random coefficients, and three techniques on [0, 1].
struct random_problem {
  std::array<double, 4> c;
  double operator()(double x) const { return c[0] + x * (c[1] + x * (c[2] + x * c[3])); }
};
const phimis::interval unit(0, 1);
auto three() {
  return phimis::technique_set(phimis::density([](double) { return 1.0; }, unit),
                               phimis::density([](double x) { return x; }, unit),
                               phimis::density([](double x) { return 1 + std::cos(3 * x); }, unit));
}

}  // namespace

TEST_CASE("Theorem 1: of all pairings the variance is least where counts and variances are in the same order") {
  constexpr int M = 5;
  random_numbers random(1);
  for (int i = 0; i < 50; ++i) {
    auto variances = random_variances<M>(random);
    auto alpha = random_fractions<M>(random);
    std::sort(variances.value, variances.value + M, [](measured a, measured b) { return a.value < b.value; });
    std::sort(alpha.value, alpha.value + M);
    const double same = variance_of_parts(variances, alpha).value;
    auto inverse_order = alpha;
    std::reverse(inverse_order.value, inverse_order.value + M);
    const double inverse = variance_of_parts(variances, inverse_order).value;
    auto pairing = alpha;
    do {
      const double value = variance_of_parts(variances, pairing).value;
      REQUIRE(value >= same * (1 - 1e-14));
      REQUIRE(value <= inverse * (1 + 1e-14));
    } while (std::next_permutation(pairing.value, pairing.value + M));
  }
}

TEMPLATE_TEST_CASE_SIG("Theorem 2: counts in proportion to sigma have the least variance", "", ((int M), M), 1, 2, 3,
                       8) {
  random_numbers random(2);
  for (int i = 0; i < 200; ++i) {
    const auto variances = random_variances<M>(random, 0.1);
    const double least = least_inefficiency(variances).value;
    REQUIRE(variance_of_parts(variances, best_fractions(variances)).value == Approx(least).epsilon(1e-13).margin(0));
    double sum = 0;
    for (int k = 0; k < M; ++k) sum += std::sqrt(variances[k].value);
    REQUIRE(least == Approx(sum * sum).epsilon(1e-13));
    for (int j = 0; j < 20; ++j) {
      REQUIRE(variance_of_parts(variances, random_fractions<M>(random)).value >= least * (1 - 1e-13));
    }
    // Eq. 30: never more than equal counts, and at best M times less.
    const double equal = variance_of_parts(variances, phimis::equal_fractions<double, M>()).value;
    REQUIRE(least <= equal * (1 + 1e-13));
    REQUIRE(equal <= M * least * (1 + 1e-13));
  }
}

TEMPLATE_TEST_CASE_SIG(
    "Theorem 3: counts in proportion to sigma over the root of the cost have the least cost times variance", "",
    ((int M), M), 1, 2, 3, 8) {
  random_numbers random(3);
  for (int i = 0; i < 200; ++i) {
    const auto variances = random_variances<M>(random, 0.1);
    const auto costs = random_positive<M>(random);
    const double least = least_inefficiency(variances, costs).value;
    const auto best = best_fractions(variances, costs);
    REQUIRE(cost_of_variance(variances, best, costs) == Approx(least).epsilon(1e-13).margin(0));
    for (int j = 0; j < 20; ++j) {
      REQUIRE(cost_of_variance(variances, random_fractions<M>(random), costs) >= least * (1 - 1e-13));
    }
    // Eq. 32
    double all_costs = 0, all_variances = 0;
    for (int k = 0; k < M; ++k) all_costs += costs[k], all_variances += variances[k].value;
    REQUIRE(least <= all_costs * all_variances * (1 + 1e-13));
    if (least > 0) {
      const double cost = mean_cost(best, costs);
      REQUIRE(efficiency(cost, variance_of_parts(variances, best).value) == Approx(1 / least).epsilon(1e-12));
    }
  }
}

TEMPLATE_TEST_CASE_SIG("Eq. 10: counts in proportion to sigma squared have the variance of equal counts", "",
                       ((int M), M), 1, 2, 3, 8) {
  random_numbers random(4);
  for (int i = 0; i < 200; ++i) {
    const auto variances = random_variances<M>(random);
    numbers<M> shares{};
    double sum = 0;
    for (int k = 0; k < M; ++k) sum += shares[k] = variances[k].value;
    const auto alpha = phimis::with_floors(shares, {});
    REQUIRE(variance_of_parts(variances, alpha).value == Approx(M * sum).epsilon(1e-13));
    REQUIRE(variance_of_parts(variances, phimis::equal_fractions<double, M>()).value ==
            Approx(M * sum).epsilon(1e-13));
  }
}

TEST_CASE("Theorem 4: the one-sample variance is never less than the multi-sample variance") {
  random_numbers random(5);
  for (int i = 0; i < 40; ++i) {
    const random_problem f{{random(), random(), random(), random()}};
    const problem on(f, three(), unit);
    for (int j = 0; j < 5; ++j) {
      const auto alpha = random_fractions<3>(random);
      const auto at = variance(on, alpha);
      REQUIRE(at.difference.value >= 0);
      REQUIRE(at.one_sample.value >= at.multi_sample.value);
      // Eq. 44, from μ_i = α_i μ'_i; its terms cancel.
      double squares = 0;
      double spread = 0;
      for (int k = 0; k < 3; ++k) {
        const double mean = on.integral([&](double value, const numbers<3>& p, double) {
                                return value * p[k] / phimis::mixture(alpha, p);
                              }).value;
        squares += alpha[k] * mean * mean;
        spread = std::max(spread, std::fabs(mean - on.mean().value));
      }
      const double mu2 = on.mean().value * on.mean().value;
      REQUIRE(std::fabs(at.difference.value - (squares - mu2)) <= 1e-13 * mu2);
      // Positive exactly where the μ'_k differ.
      REQUIRE((at.difference.value > 1e-25 * mu2) == (spread > 1e-11 * on.mean().value));
    }
  }
}

TEST_CASE(
    "Theorem 4: equality where all techniques are the same, at zero variance, and at the Kullback-Leibler optimum") {
  random_numbers random(6);
  const auto flat = [](double) { return 1.0; };
  for (int i = 0; i < 10; ++i) {
    const random_problem f{{0.1 + random(), random(), random(), random()}};
    const problem same(f, phimis::technique_set(phimis::density(flat, unit), phimis::density(flat, unit)), unit);
    const double mu2 = same.mean().value * same.mean().value;
    const auto at = variance(same, random_fractions<2>(random));
    CHECK(at.difference.value <= 1e-28 * mu2);
    CHECK(at.one_sample.value > 1e-6 * mu2);

    const auto mixed = random_fractions<3>(random);
    const auto techniques = three();
    const problem zero([&](double x) { return phimis::mixture(mixed, techniques.pdfs(x)); }, techniques, unit);
    CHECK(variance(zero, mixed).one_sample.value <= 1e-25);
    CHECK(variance(zero, mixed).difference.value <= 1e-28);

    // Not among the two cases that the paper names: techniques differ, and the variance is not zero.
    const problem pair([&](double x) { return f(x) * (2 + std::cos(7 * x)); },
                       phimis::technique_set(phimis::density([](double x) { return 1.05 - x; }, unit),
                                             phimis::density([](double x) { return 0.05 + x; }, unit)),
                       unit);
    const auto kl = optimum(phimis::kullback_leibler{}, pair);
    if (!(kl.alpha[0] > 0 && kl.alpha[1] > 0)) continue;
    const auto there = variance(pair, kl.alpha);
    CHECK(there.difference.value <= 1e-24 * mu2);
    CHECK(there.one_sample.value > 1e-3 * mu2);
  }
}
