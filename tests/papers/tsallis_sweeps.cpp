// SPDX-License-Identifier: MIT
// The curves behind Figs. 2, 3, 5, 6, 8, 9 of Sbert & Szirmay-Kalos 2022: optima of Tsallis divergences.
#include "catch.hpp"
#include "tsallis_data.hpp"

#include <string>

namespace {

using namespace papers_test;
using phimis::analysis::divergence_at;
using phimis::analysis::optimum;
using phimis::analysis::variance;

/// Relative tolerance, and an absolute one where the variance vanishes.
void check_variance(const phimis::measured& computed, double truth, double equal) {
  CHECK(std::fabs(computed.value - truth) <= 1e-8 * truth + 1e-20);
  CHECK(within_error(computed, truth, 0));
  CHECK(computed.error <= 1e-11 * equal);
}

template <class Divergence>
void check_sweep(int n, const std::string& direction, Divergence (*of_order)(double)) {
  const problem& on = example(n);
  const double equal = variance(on, phimis::equal_fractions<double, 2>()).multi_sample.value;
  const auto rows = read_data("tsallis_" + std::to_string(n) + "_" + direction + ".csv");
  REQUIRE(rows.size() == 80);
  for (const auto& row : rows) {
    const double gamma = number(row.at("gamma"));
    CAPTURE(n, direction, gamma);
    const double alpha = number(row.at("alpha"));
    const auto found = optimum(of_order(gamma), on);
    CHECK(std::fabs(found.alpha[0] - alpha) <= 1e-9);
    CHECK(std::fabs(found.alpha[0] - alpha) <= found.error + 1e-14);
    CHECK(found.error <= 1e-11);
    CHECK_FALSE(found.local);
    const auto at = variance(on, found.alpha);
    check_variance(at.multi_sample, number(row.at("multi_sample_variance")), equal);
    check_variance(at.one_sample, number(row.at("one_sample_variance")), equal);
    if (row.count("divergence") == 1) {
      const auto value = divergence_at(of_order(gamma), on, found.alpha);
      CHECK(std::fabs(value.value - number(row.at("divergence"))) <= 1e-13);
      CHECK(within_error(value, number(row.at("divergence")), 1));
    }
  }
}

}  // namespace

TEST_CASE("Optima of Tsallis divergences for 80 orders agree with the reference") {
  for (int n = 1; n <= 3; ++n) {
    check_sweep<phimis::tsallis>(n, "forward", [](double gamma) { return phimis::tsallis{gamma}; });
  }
}

TEST_CASE("Optima of reversed Tsallis divergences for 80 orders agree with the reference") {
  for (int n = 1; n <= 3; ++n) {
    check_sweep<phimis::reversed<phimis::tsallis>>(
        n, "reversed", [](double gamma) { return phimis::reversed<phimis::tsallis>{{gamma}}; });
  }
}

TEST_CASE("A reversed Tsallis divergence of order below one has the optimum of order one minus it") {
  for (int n = 1; n <= 3; ++n) {
    for (int i = 1; i <= 9; ++i) {
      const double gamma = i / 10.0;
      CAPTURE(n, gamma);
      const auto reversed = optimum(phimis::reversed<phimis::tsallis>{{gamma}}, example(n));
      const auto forward = optimum(phimis::tsallis{1 - gamma}, example(n));
      CHECK(std::fabs(reversed.alpha[0] - forward.alpha[0]) <= 1e-14);
    }
  }
}
