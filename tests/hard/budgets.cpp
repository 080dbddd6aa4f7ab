// SPDX-License-Identifier: MIT
// Budgets that are too small: fewer samples than techniques, one sample in all, for every rule and in every sampling model.
#include "any_rule.hpp"
#include "cases.hpp"
#include "catch.hpp"
#include "random.hpp"

#include <phimis/core/moments.hpp>
#include <phimis/integrate.hpp>

#include <cmath>
#include <cstdint>
#include <type_traits>
#include <utility>

namespace {

using namespace hard;
using phimis::rounding;
using phimis::sampling_model;

double f(double x) { return 0.3 + x * x; }  // ∫ = .6333
constexpr double mu = 0.3 + 1.0 / 3;

/// z of the mean of many runs, of which none has a number that is none.
template <class Techniques, class Rule, class... Policies>
double z_of(const Techniques& techniques, const Rule& rule, const phimis::integrate_options& options, int runs,
            Policies... policies) {
  phimis::moments<double> estimates;
  random_numbers random(11);
  const auto next = [&] { return random(); };
  for (int i = 0; i < runs; ++i) {
    const auto run = phimis::integrate(f, techniques, options, rule, next, policies...);
    INFO("run " << i << " of budget " << options.budget);
    CHECK(run.samples == options.budget);
    CHECK(phimis::is_finite(run.estimate));
    CHECK(invariants::off_simplex(run.fractions, rule.options()) == "");
    estimates.add(run.estimate);
  }
  return (estimates.mean - mu) / std::sqrt(estimates.variance() / runs);
}

/// f/p(α) <= 13, so that a mean of 200 runs is nearly normal.
template <int M>
phimis::rule_options<double, M> floored() {
  phimis::rule_options<double, M> options;
  for (int k = 0; k < M; ++k) options.floors[k] = 0.1;
  return options;
}

}  // namespace

TEST_CASE("Fewer samples than techniques in an iteration leave every rule unbiased") {
  // |z| < 5: false alarm 6e-7, three times for each of 79 rules and 47.
  for_two_and_three([](const auto& techniques) {
    constexpr int M = std::decay_t<decltype(techniques)>::techniques;
    for (const auto& rule : every_rule<double, M>(floored<M>())) {
      CAPTURE(rule.name(), M);
      const auto z = [&](const phimis::integrate_options& options, const auto& combination) {
        return std::fabs(z_of(techniques, rule, options, 200, combination));
      };
      CHECK(z({.budget = M - 1, .iterations = 1}, phimis::by_count{}) < 5);
      CHECK(z({.budget = 4 * (M - 1), .iterations = 4, .growth = 1}, phimis::square_root{}) < 5);
      CHECK(z({.budget = 9, .iterations = 5, .growth = 16}, phimis::square_root{}) < 5);
    }
  });
}

TEST_CASE("One sample in all is an unbiased estimate without an error bar, in every sampling model") {
  for (const sampling_model model : {sampling_model::multi_sample, sampling_model::one_sample}) {
    for (const rounding counts : {rounding::largest_remainder, rounding::systematic}) {
      const phimis::integrate_options options{.budget = 1, .iterations = 1, .model = model, .rounding = counts};
      for_two_and_three([&](const auto& techniques) {
        constexpr int M = std::decay_t<decltype(techniques)>::techniques;
        CAPTURE(M, static_cast<int>(model), static_cast<int>(counts));
        CHECK(std::fabs(z_of(techniques, phimis::exact_rule<M>(phimis::chi_squared{}), options, 2000)) < 5);
        for (const auto& rule : every_rule<double, M>()) {
          CAPTURE(rule.name());
          const auto run = phimis::integrate(f, techniques, options, rule);
          CHECK(run.samples == 1);
          CHECK(run.estimate > 0);
          CHECK_FALSE(phimis::is_finite(run.standard_error));
          CHECK(invariants::off_simplex(run.fractions, rule.options()) == "");
        }
      });
    }
  }
}

TEST_CASE("Sixteen techniques with a budget of one to sixteen are unbiased") {
  // Technique k is uniform on its own sixteenth: each alone reaches its part.
  const auto make = []<std::size_t... K>(std::index_sequence<K...>) {
    return phimis::technique_set(uniform_on{static_cast<double>(K) / 16, static_cast<double>(K + 1) / 16}...);
  };
  const auto parts = make(std::make_index_sequence<16>{});
  for (const std::int64_t budget : {1, 3, 15, 16}) {
    phimis::moments<double> estimates;
    random_numbers random(static_cast<std::uint64_t>(budget));
    const auto next = [&] { return random(); };
    for (int i = 0; i < 2000; ++i) {
      const auto run = phimis::integrate(f, parts, {.budget = budget, .iterations = 1}, next, phimis::by_count{},
                                         phimis::exact_rule<16>(phimis::chi_squared{}));
      estimates.add(run.estimate);
    }
    CAPTURE(budget);
    CHECK(std::fabs(estimates.mean - mu) <= 5 * std::sqrt(estimates.variance() / 2000));
  }
}

TEMPLATE_TEST_CASE("One observation, or none, leaves every rule on its simplex", "", float, double) {
  for_two_and_three([](const auto& techniques) {
    constexpr int M = std::decay_t<decltype(techniques)>::techniques;
    for (const int n : {0, 1, 2}) {
      for (const auto variate : {phimis::control_variate::on, phimis::control_variate::off}) {
        for (auto& rule : every_rule<TestType, M>({}, variate))
          teach(rule, drawn<TestType>(f, techniques, n), 3);  // which checks
      }
    }
  });
}
