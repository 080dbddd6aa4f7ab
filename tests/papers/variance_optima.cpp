// SPDX-License-Identifier: MIT
// Optima for the examples of Sbert, Havran & Szirmay-Kalos 2016, most of which the paper did not look for.
#include "catch.hpp"
#include "variance_data.hpp"

#include <phimis/analysis/allocation.hpp>

#include <cmath>
#include <functional>
#include <map>
#include <string>

using namespace papers_test;

namespace {

using phimis::equal_fractions;
using phimis::measured;
using namespace phimis::analysis;

/// V[F] of a heuristic at equal counts, and at n_i ∝ σ_i.
struct heuristic_variances {
  measured equal;
  measured best;
};

template <class Heuristic, int M>
heuristic_variances of_heuristic(const Heuristic& heuristic, const phimis::analysis::problem<M>& on) {
  const auto parts = moments_of_parts(heuristic, on);
  return {variance_of_parts(parts.variance, equal_fractions<double, M>()), least_inefficiency(parts.variance)};
}

template <int M>
heuristic_variances by_name(const std::string& heuristic, const phimis::analysis::problem<M>& on) {
  if (heuristic == "balance") return of_heuristic(phimis::balance{}, on);
  if (heuristic == "power2") return of_heuristic(phimis::power{2}, on);
  if (heuristic == "cutoff0.1") return of_heuristic(phimis::cutoff{0.1}, on);
  if (heuristic == "maximum") return of_heuristic(phimis::maximum{}, on);
  throw std::runtime_error("no heuristic '" + heuristic + "'");
}

heuristic_variances heuristic_of_example(const std::string& name, const std::string& heuristic) {
  if (name[0] == 'T') return by_name(heuristic, example(name[1] - '0'));
  if (name == "L4") return by_name(heuristic, linear_example_4());
  if (name == "L5") return by_name(heuristic, linear_example_5());
  return by_name(heuristic, variance_example(name).problem);
}

}  // namespace

TEST_CASE("The fractions of the least variance, and of the least cost times variance, are the reference") {
  for (const auto& row : read_data("variance_optima.csv")) {
    const std::string& name = row.at("example");
    const std::string& objective = row.at("objective");
    INFO(name << ' ' << objective);
    const auto& of = variance_example(name);
    const bool multi = objective.find("multi") != std::string::npos;
    const bool priced = objective.find("cost") == 0;
    const papers::allotment& found = priced ? (multi ? of.cheapest_multi_sample : of.cheapest_one_sample)
                                            : (multi ? of.least_multi_sample : of.least_one_sample);
    for (int k = 0; k < 3; ++k) {
      const double alpha = number(row.at("alpha_" + std::to_string(k + 1)));
      CHECK(std::fabs(found.alpha[k] - alpha) <= 1e-9);
      if (alpha == 0 || alpha == 1) CHECK(found.alpha[k] == alpha);
    }
    const measured value = priced ? (multi ? found.multi_sample_times_cost() : found.one_sample_times_cost())
                                  : (multi ? found.variance.multi_sample : found.variance.one_sample);
    const double truth = number(row.at("value"));
    CHECK(std::fabs(value.value - truth) <= 1e-13 * truth + 1e-20);
    if (!row.at("multi_sample_variance").empty()) {
      const double multi_truth = number(row.at("multi_sample_variance"));
      const double one_truth = number(row.at("one_sample_variance"));
      CHECK(std::fabs(found.variance.multi_sample.value - multi_truth) <= 1e-10 * multi_truth + 1e-20);
      CHECK(std::fabs(found.variance.one_sample.value - one_truth) <= 1e-10 * one_truth + 1e-20);
    }
  }
}

TEST_CASE("No fractions of the paper, nor any on a grid, are better than the optima") {
  for (const char* const name : {"V1", "V2", "V3", "V4"}) {
    INFO(name);
    const auto& of = variance_example(name);
    const auto check = [&](const papers::triple& alpha) {
      const papers::allotment at = papers::allot(of.problem, alpha);
      constexpr double slack = 1 + 1e-12;
      const auto at_most = [](double least, double value) { return least <= value * slack + 1e-20; };
      REQUIRE(at_most(of.least_multi_sample.variance.multi_sample.value, at.variance.multi_sample.value));
      REQUIRE(at_most(of.least_one_sample.variance.one_sample.value, at.variance.one_sample.value));
      REQUIRE(at_most(of.cheapest_multi_sample.multi_sample_times_cost().value, at.multi_sample_times_cost().value));
      REQUIRE(at_most(of.cheapest_one_sample.one_sample_times_cost().value, at.one_sample_times_cost().value));
    };
    for (const auto& at : {of.equal, of.by_variance, of.by_cost_and_variance, of.by_true_variance}) check(at.alpha);
    for (int i = 0; i <= 12; ++i) {
      for (int j = 0; i + j <= 12; ++j) check({{i / 12.0, j / 12.0, (12 - i - j) / 12.0}});
    }
  }
}

TEST_CASE(
    "Variances under every weight heuristic are the reference, at equal counts and at those in proportion to sigma") {
  for (const auto& row : read_data("variance_heuristics.csv")) {
    const std::string& name = row.at("example");
    INFO(name << ' ' << row.at("heuristic"));
    const heuristic_variances found = heuristic_of_example(name, row.at("heuristic"));
    const double equal = number(row.at("equal_counts"));
    const double best = number(row.at("sigma_counts"));
    CHECK(std::fabs(found.equal.value - equal) <= 1e-12 * equal + found.equal.error);
    CHECK(std::fabs(found.best.value - best) <= 1e-12 * best + found.best.error);
    CHECK(found.equal.error <= 1e-10 * equal + 1e-20);
  }
}

TEST_CASE(
    "The corrected condition of the least V[F] holds at the optimum, with V[F] as its value; the printed one does "
    "not") {
  const auto check = [](const auto& on, const std::string& name, const auto& rows) {
    const auto alpha = optimum(phimis::multi_sample_variance{}, on).alpha;
    const auto corrected = multi_sample_condition(on, alpha);
    const auto printed = papers::detail::as_printed_in_eq_43(on, alpha);
    const double least = variance(on, alpha).multi_sample.value;
    int k = 0;
    for (const auto& row : rows) {
      if (row.at("example") != name) continue;
      INFO(name << ", technique " << k + 1);
      CHECK(corrected[k] == Approx(number(row.at("corrected"))).epsilon(1e-9));
      CHECK(corrected[k] == Approx(least).epsilon(1e-9));
      CHECK(printed[k] == Approx(number(row.at("printed"))).epsilon(1e-5));  // α is near 0 or 1: steep
      ++k;
    }
    CHECK(k == alpha.size());
  };
  const auto rows = read_data("variance_condition.csv");
  check(example(1), "T1", rows);
  check(example(3), "T3", rows);
  check(linear_example_4(), "L4", rows);
  check(linear_example_5(), "L5", rows);
}

TEST_CASE("V[F] has two local minima on four points") {
  const auto on = papers::detail::four_points();
  const auto from = [&](double start) {
    auto options = phimis::without_floors<double, 2>();
    options.start = {{start, 1 - start}};
    return optimum(phimis::multi_sample_variance{}, on, options);
  };
  const auto low = from(1e-6);
  const auto high = from(0.5);
  CHECK(low.alpha[0] == 0);
  CHECK(high.alpha[0] == Approx(0.203166).margin(5e-7));
  CHECK(low.local);
  CHECK(high.local);
  CHECK(std::fabs(variance(on, low.alpha).multi_sample.value - 0.246082663) <= 5e-10);
  CHECK(std::fabs(variance(on, high.alpha).multi_sample.value - 0.245839075) <= 5e-10);
}
