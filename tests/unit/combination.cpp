// SPDX-License-Identifier: MIT
#include "catch.hpp"

#include <phimis/estimator/combination.hpp>

#include <cmath>
#include <vector>

namespace {

using phimis::iteration_summary;

template <class Combination>
std::vector<double> weights(const Combination& combination, std::vector<iteration_summary> iterations) {
  // The tests give variances.
  for (iteration_summary& it : iterations) it.standard_error = std::sqrt(it.standard_error);
  std::vector<double> result(iterations.size());
  combination(iterations, result);
  double sum = 0;
  for (const double w : result) {
    REQUIRE(std::isfinite(w));
    REQUIRE(w >= 0);
    sum += w;
  }
  REQUIRE(sum > 0);
  for (double& w : result) w /= sum;
  return result;
}

void check(const std::vector<double>& computed, const std::vector<double>& wanted) {
  REQUIRE(computed.size() == wanted.size());
  double sum = 0;
  for (const double w : wanted) sum += w;
  for (std::size_t b = 0; b < wanted.size(); ++b) CHECK(computed[b] == Approx(wanted[b] / sum).epsilon(1e-14));
}

}  // namespace

TEST_CASE("By count, every sample weighs the same") {
  check(weights(phimis::by_count{}, {{100, 3, false}, {50, 0, true}, {10, 7, false}}), {100, 50, 10});
}

TEST_CASE("By the square-root rule a sample of iteration k weighs the root of k") {
  check(weights(phimis::square_root{}, {{100, 3, false}, {100, 1, false}, {50, 1, false}}),
        {100, 100 * std::sqrt(2.0), 50 * std::sqrt(3.0)});
}

TEST_CASE("Fixed weights hold for samples, and the last for all later ones") {
  const phimis::fixed_weights fixed({0.15, 0.8, 1});
  check(weights(fixed, {{100, 1, false}, {100, 1, false}, {200, 1, false}, {50, 1, false}}), {15, 80, 200, 50});
  check(weights(fixed, {{100, 1, false}}), {1});
}

TEST_CASE("A run that stopped before the first weight that is not 0 counts all samples") {
  const phimis::fixed_weights late({0, 0, 1});
  check(weights(late, {{10, 1, false}, {30, 1, false}}), {10, 30});
  check(weights(late, {{10, 1, false}, {30, 1, false}, {20, 1, false}}), {0, 0, 20});
}

TEST_CASE("Inverse variance weighs by one over the variance of the iteration") {
  check(weights(phimis::inverse_variance{}, {{100, 4, false}, {100, 1, false}, {7, 0.5, false}}), {0.25, 1, 2});
}

TEST_CASE("Where iterations have no variance they share all of the weight") {
  check(weights(phimis::inverse_variance{}, {{100, 4, false}, {100, 0, false}, {50, 0, false}}), {0, 100, 50});
}

TEST_CASE("An iteration of zeros alone has an unknown variance: the largest that was seen") {
  check(weights(phimis::inverse_variance{}, {{100, 0, true}, {100, 1, false}, {100, 4, false}}), {0.25, 1, 0.25});
  check(weights(phimis::inverse_variance{}, {{100, 0, true}, {50, 0, true}}), {100, 50});
  check(weights(phimis::inverse_variance{}, {{100, 0, true}, {50, 0, false}}), {0, 50});
}

TEST_CASE("An iteration of one sample has an unknown variance too") {
  check(weights(phimis::inverse_variance{}, {{1, 0, false}, {100, 2, false}, {100, 4, false}}), {0.25, 0.5, 0.25});
  check(weights(phimis::inverse_variance{}, {{1, 0, false}, {1, 0, false}}), {1, 1});
}

TEST_CASE("No scale of the variances makes a weight that is no number") {
  for (const double unit : {1e-300, 1e-310, 1e300}) {
    const auto computed = weights(phimis::inverse_variance{}, {{100, 4 * unit, false}, {100, unit, false}});
    CHECK(computed[0] == Approx(0.2).epsilon(1e-12));
  }
}
