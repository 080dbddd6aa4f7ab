// SPDX-License-Identifier: MIT
#include "catch.hpp"
#include "three_powers.hpp"

#include <phimis/core/estimator.hpp>
#include <phimis/core/sigma_proportional.hpp>

#include <cmath>
#include <limits>
#include <type_traits>

namespace {

using phimis::rule_status;

template <class Real>
using sigma = phimis::sigma_proportional<Real, 3>;

double f(double x) { return x * x * x + 0.2 * x; }

template <class Rule>
Rule& observe_all(Rule& rule, const std::vector<phimis::observation<typename Rule::real, 3>>& all) {
  for (const auto& o : all) rule.observe(o);
  return rule;
}

/// σ of the contributions w_i f/p_i of technique i, in two passes.
template <class Heuristic>
phimis::per_technique<double, 3> spreads(const Heuristic& heuristic,
                                         const std::vector<phimis::observation<double, 3>>& all) {
  phimis::moments<double> of[3];
  for (const auto& o : all) {
    of[o.technique].add(heuristic(o.technique, phimis::equal_fractions<double, 3>(), o.pdfs) * o.f /
                        o.pdfs[o.technique]);
  }
  return {{std::sqrt(of[0].variance()), std::sqrt(of[1].variance()), std::sqrt(of[2].variance())}};
}

}  // namespace

TEMPLATE_TEST_CASE("Fractions are in proportion to the spread of f over the sum of pdfs", "", float, double) {
  const double digits = 1000 * static_cast<double>(std::numeric_limits<TestType>::epsilon());
  const auto s = spreads(phimis::balance{}, three_powers::observe(f, {{30, 50, 20}}, 1));
  sigma<TestType> rule;
  observe_all(rule, three_powers::observe<TestType>(f, {{30, 50, 20}}, 1));
  CHECK(rule.update() == rule_status::updated);
  for (int k = 0; k < 3; ++k) {
    CHECK(static_cast<double>(rule.fractions()[k]) == Approx(s[k] / (s[0] + s[1] + s[2])).epsilon(digits));
  }
}

TEST_CASE("Costs divide the fractions by their root") {
  const auto all = three_powers::observe(f, {{30, 30, 30}}, 2);
  const auto s = spreads(phimis::balance{}, all);
  auto options = phimis::without_floors<double, 3>();
  options.costs = {{1, 6.24, 3.28}};
  sigma<double> rule(options);
  observe_all(rule, all).update();
  const double a = s[0], b = s[1] / std::sqrt(6.24), c = s[2] / std::sqrt(3.28);
  CHECK(rule.fractions()[0] == Approx(a / (a + b + c)).epsilon(1e-12));
  CHECK(rule.fractions()[1] == Approx(b / (a + b + c)).epsilon(1e-12));
}

TEMPLATE_TEST_CASE("The spread is that of the heuristic that estimates use", "", phimis::power, phimis::cutoff,
                   phimis::maximum, phimis::count_independent<phimis::balance>) {
  const auto all = three_powers::observe(f, {{40, 40, 40}}, 3);
  const auto s = spreads(TestType{}, all);
  phimis::sigma_proportional<double, 3, TestType> rule(phimis::without_floors<double, 3>());
  observe_all(rule, all).update();
  for (int k = 0; k < 3; ++k) CHECK(rule.fractions()[k] == Approx(s[k] / (s[0] + s[1] + s[2])).epsilon(1e-12));
}

TEST_CASE("The sign of f counts: spreads are those of the estimate") {
  // f = ±Σ p: |f| has no spread.
  sigma<double> rule(phimis::without_floors<double, 3>());
  const auto sum = [](double x) { return 1 + 2 * x + 3 * x * x; };
  const auto all = three_powers::observe([&](double x) { return x < 0.5 ? -sum(x) : sum(x); }, {{40, 40, 40}}, 4);
  observe_all(rule, all);
  CHECK(rule.update() == rule_status::updated);
  const auto s = spreads(phimis::balance{}, all);
  CHECK(rule.fractions()[0] == Approx(s[0] / (s[0] + s[1] + s[2])).epsilon(1e-12));
}

TEMPLATE_TEST_CASE("Where f is proportional to the sum of pdfs no fractions are better: they stay", "", float,
                   double) {
  auto options = phimis::rule_options<TestType, 3>{};
  options.start = {{TestType(0.5), TestType(0.25), TestType(0.25)}};
  sigma<TestType> rule(options);
  observe_all(
      rule, three_powers::observe<TestType>([](double x) { return (1 + 2 * x + 3 * x * x) / 7; }, {{20, 10, 10}}, 5));
  CHECK(rule.update() == rule_status::no_information);
  CHECK(rule.fractions()[0] == TestType(0.5));
  CHECK(rule.fractions()[1] == TestType(0.25));
}

TEST_CASE("Two samples of each technique that has a fraction are needed") {
  sigma<double> rule;
  for (const auto& o : three_powers::observe(f, {{9, 9, 1}}, 6)) rule.observe(o);
  CHECK(rule.update() == rule_status::no_information);
  CHECK(rule.fractions()[0] == 1.0 / 3);
  for (const auto& o : three_powers::observe(f, {{0, 0, 1}}, 7)) rule.observe(o);
  CHECK(rule.update() == rule_status::updated);

  // One without a fraction never has samples, and is not waited for.
  auto options = phimis::without_floors<double, 3>();
  options.start = {{0.5, 0, 0.5}};
  sigma<double> without(options);
  observe_all(without, three_powers::observe(f, {{9, 0, 9}}, 6));
  CHECK(without.update() == rule_status::updated);
  CHECK(without.fractions()[1] == 0);
}

TEST_CASE("A technique whose contributions are all the same keeps its floor") {
  auto options = phimis::without_floors<double, 3>();
  options.floors = {{0.125, 0.125, 0.125}};
  sigma<double> rule(options);
  // f = 0 wherever the first technique was sampled
  for (auto o : three_powers::observe(f, {{10, 10, 10}}, 8)) {
    if (o.technique == 0) o.f = 0;
    rule.observe(o);
  }
  CHECK(rule.update() == rule_status::updated);
  CHECK(rule.fractions()[0] == 0.125);
  CHECK(rule.fractions()[1] + rule.fractions()[2] == Approx(0.875));
}

TEST_CASE("Under floors the fractions are those of the least variance") {
  const auto all = three_powers::observe(f, {{30, 30, 30}}, 9);
  const auto s = spreads(phimis::balance{}, all);
  const auto variance = [&](const phimis::fractions<double, 3>& a) {
    return s[0] * s[0] / a[0] + s[1] * s[1] / a[1] + s[2] * s[2] / a[2];
  };
  auto options = phimis::without_floors<double, 3>();
  options.floors = {{0.1, 0.1, 0.5}};
  sigma<double> rule(options);
  observe_all(rule, all).update();
  CHECK(rule.fractions()[2] == 0.5);
  const double least = variance(rule.fractions());
  random_numbers random(1);
  for (int i = 0; i < 1000; ++i) {
    const auto a = phimis::with_floors({{random(), random(), random()}}, options.floors);
    REQUIRE(variance(a) >= least * (1 - 1e-14));
  }
}

TEST_CASE("The prior is the weight of the start in samples") {
  const auto all = three_powers::observe(f, {{30, 30, 30}}, 10);
  const auto learn = [&](double prior) {
    auto options = phimis::without_floors<double, 3>();
    options.start = {{0.6, 0.3, 0.1}};
    options.costs = {{1, 2, 3}};
    options.prior = prior;
    sigma<double> rule(options);
    observe_all(rule, all).update();
    return rule.fractions();
  };
  const auto free = learn(0);
  const auto half = learn(90);
  const auto bound = learn(9e9);
  const auto s = spreads(phimis::balance{}, all);
  const double root[3] = {1, std::sqrt(2.0), std::sqrt(3.0)};
  const double total = s[0] + s[1] * root[1] + s[2] * root[2];
  const double mean_cost = 0.6 + 0.6 + 0.3;
  const double start[3] = {0.6, 0.3, 0.1};
  double shares[3];
  for (int k = 0; k < 3; ++k) shares[k] = std::hypot(s[k] / total, start[k] * root[k] / mean_cost) / root[k];
  for (int k = 0; k < 3; ++k) {
    CHECK(std::fabs(bound[k] - start[k]) <= 1e-7);
    CHECK(half[k] == Approx(shares[k] / (shares[0] + shares[1] + shares[2])).epsilon(1e-12));
    CHECK(std::fabs(half[k] - start[k]) < std::fabs(free[k] - start[k]));
  }
}

TEMPLATE_TEST_CASE("Spreads merge, and no scale of f or of the measure changes fractions", "", float, double) {
  const double digits = 256 * static_cast<double>(std::numeric_limits<TestType>::epsilon());
  const auto all = three_powers::observe<TestType>(f, {{20, 20, 20}}, 11);
  sigma<TestType> whole;
  observe_all(whole, all).update();
  sigma<TestType> first, second;
  for (std::size_t j = 0; j < all.size(); ++j) (j < 23 ? first : second).observe(all[j]);
  first.merge(second);
  CHECK(first.update() == rule_status::updated);
  constexpr int range = std::is_same_v<TestType, float> ? 90 : 900;
  sigma<TestType> scaled, measured;
  for (auto o : all) {
    o.f = std::ldexp(o.f, range);
    scaled.observe(o);
    o.f = std::ldexp(o.f, -range);
    for (int k = 0; k < 3; ++k) o.pdfs[k] *= TestType(1e-6);
    o.q *= TestType(1e-6);
    measured.observe(o);
  }
  scaled.update();
  measured.update();
  for (int k = 0; k < 3; ++k) {
    const double wanted = static_cast<double>(whole.fractions()[k]);
    CHECK(std::fabs(static_cast<double>(first.fractions()[k]) - wanted) <= digits);
    CHECK(static_cast<double>(scaled.fractions()[k]) == wanted);
    CHECK(std::fabs(static_cast<double>(measured.fractions()[k]) - wanted) <= digits);
  }
  CHECK(first.counters().observations == 60);
}

TEST_CASE("A sample where its own technique has no density is counted, by weights that divide by it") {
  phimis::sigma_proportional<double, 3, phimis::power> rule;
  rule.observe({1, {{0, 1, 1}}, 1, 0});
  CHECK(rule.counters().nonfinite == 1);
  rule.observe({0, {{0, 0, 0}}, 0, 0});  // a lost sample
  CHECK(rule.counters().nonfinite == 1);
  CHECK(rule.counters().zero == 1);
}

TEST_CASE("Frozen techniques keep their fraction under the sigma rule") {
  auto options = phimis::without_floors<double, 3>();
  options.start = {{0.5, 0.25, 0.25}};
  options.frozen = {{true, false, false}};
  const auto all = three_powers::observe(f, {{20, 20, 20}}, 12);
  const auto s = spreads(phimis::balance{}, all);
  sigma<double> rule(options);
  observe_all(rule, all).update();
  CHECK(rule.fractions()[0] == 0.5);
  CHECK(rule.fractions()[1] == Approx(0.5 * s[1] / (s[1] + s[2])).epsilon(1e-12));
}
