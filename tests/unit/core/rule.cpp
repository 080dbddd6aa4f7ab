// SPDX-License-Identifier: MIT
// What every rule does with its options, its counters and bad observations.
#include "catch.hpp"
#include "three_powers.hpp"
#include "two_triangles.hpp"

#include <phimis/core/exact_minimiser.hpp>
#include <phimis/core/inverse_variance_fractions.hpp>
#include <phimis/core/linear_heuristic.hpp>
#include <phimis/core/newton_raphson.hpp>
#include <phimis/core/rule.hpp>
#include <phimis/core/second_order.hpp>
#include <phimis/core/sigma_proportional.hpp>

#include <cmath>
#include <limits>
#include <type_traits>

namespace {

using phimis::kullback_leibler;
using phimis::rule_options;
using phimis::rule_status;

template <class Real>
using fixed = phimis::fixed_fractions<Real, 2>;
template <class Real>
using newton = phimis::newton_raphson<kullback_leibler, Real>;
template <class Real>
using minimiser = phimis::exact_minimiser<kullback_leibler, phimis::fixed_table<Real, 2, 64>>;

template <class Rule>
Rule make(const rule_options<typename Rule::real, 2>& options) {
  if constexpr (std::is_same_v<Rule, newton<typename Rule::real>>) {
    return Rule({}, phimis::newton_form::safeguarded, options);
  } else if constexpr (std::is_same_v<Rule, fixed<typename Rule::real>>) {
    return Rule(options);
  } else {
    return Rule({}, options);
  }
}

double falling(double x) { return 3 - 2 * x; }

}  // namespace

TEMPLATE_TEST_CASE("A rule that learns begins at its start, raised to its floors; fixed fractions are their start", "", fixed<float>, fixed<double>, newton<float>,
                   newton<double>, minimiser<float>, minimiser<double>) {
  using real = typename TestType::real;
  const TestType plain = make<TestType>({});
  CHECK(plain.fractions()[0] == real(0.5));
  CHECK(plain.fractions()[1] == real(0.5));
  CHECK(plain.status() == rule_status::start);
  CHECK(plain.options().prior == 0);

  auto options = phimis::without_floors<real, 2>();
  options.start = {{real(0.25), real(0.75)}};
  CHECK(make<TestType>(options).fractions()[0] == real(0.25));
  options.floors = {{real(0.5), 0}};
  const TestType raised = make<TestType>(options);
  const real first = std::is_same_v<TestType, fixed<real>> ? real(0.25) : real(0.5);
  CHECK(raised.fractions()[0] == first);
  CHECK(raised.fractions()[1] == 1 - first);
}

TEMPLATE_TEST_CASE("Every rule counts what it meets, and refuses what is not finite", "", fixed<float>, fixed<double>,
                   newton<float>, newton<double>, minimiser<float>, minimiser<double>) {
  using real = typename TestType::real;
  using limits = std::numeric_limits<real>;
  TestType rule = make<TestType>({});
  rule.observe({1, {{1, 2}}, 1, 0});
  rule.observe({0, {{1, 2}}, 1, 0});
  for (const real bad : {limits::quiet_NaN(), limits::infinity(), -limits::infinity()}) {
    rule.observe({bad, {{1, 2}}, 1, 0});
    rule.observe({1, {{bad, 2}}, 1, 0});
    rule.observe({1, {{1, 2}}, bad, 1});
  }
  rule.observe({1, {{-1, 2}}, 1, 1});
  rule.observe({1, {{0, 0}}, 1, 1});
  rule.observe({1, {{1, 2}}, 0, 1});
  CHECK(rule.counters().observations == 14);
  CHECK(rule.counters().zero == 1);
  CHECK(rule.counters().nonfinite == 12);
  CHECK(rule.counters().dropped == 0);
  rule.update();
  CHECK(phimis::is_density(rule.fractions()[0]));
  CHECK(phimis::is_density(rule.fractions()[1]));

  TestType twice = rule;
  twice.merge(rule);
  CHECK(twice.counters().observations == 28);
  CHECK(twice.counters().zero == 2);
  CHECK(twice.counters().nonfinite == 24);
}

TEMPLATE_TEST_CASE("Bad observations among good ones change no fraction", "", newton<float>, newton<double>,
                   minimiser<float>, minimiser<double>) {
  using real = typename TestType::real;
  TestType clean = make<TestType>({});
  TestType mixed = make<TestType>({});
  for (const auto& o : two_triangles::observe<real>(falling, 0.5, 40, 1)) {
    clean.observe(o);
    mixed.observe(o);
    auto bad = o;
    bad.f = std::numeric_limits<real>::quiet_NaN();
    mixed.observe(bad);
  }
  CHECK(clean.update() == rule_status::updated);
  CHECK(mixed.update() == rule_status::updated);
  CHECK(clean.fractions()[0] != real(0.5));
  CHECK(mixed.fractions()[0] == clean.fractions()[0]);
}

TEMPLATE_TEST_CASE("Without information fractions stay", "", newton<float>, newton<double>, minimiser<float>,
                   minimiser<double>) {
  using real = typename TestType::real;
  auto options = phimis::without_floors<real, 2>();
  options.start = {{real(0.25), real(0.75)}};
  SECTION("no observations") {
    TestType rule = make<TestType>(options);
    CHECK(rule.update() == rule_status::no_information);
    CHECK(rule.fractions()[0] == real(0.25));
  }
  SECTION("every f is 0") {
    TestType rule = make<TestType>(options);
    for (const auto& o : two_triangles::observe<real>([](double) { return 0; }, 0.25, 40, 1)) rule.observe(o);
    CHECK(rule.update() == rule_status::no_information);
    CHECK(rule.counters().zero == 40);
    CHECK(rule.fractions()[0] == real(0.25));
    CHECK(rule.fractions()[1] == real(0.75));
  }
  SECTION("the pdfs are identical") {
    TestType rule = make<TestType>(options);
    for (auto o : two_triangles::observe<real>(falling, 0.25, 40, 1)) {
      o.pdfs[1] = o.pdfs[0];
      o.q = o.pdfs[0];
      rule.observe(o);
    }
    rule.update();
    CHECK(rule.fractions()[0] == real(0.25));
    CHECK(rule.fractions()[1] == real(0.75));
  }
}

TEMPLATE_TEST_CASE("A technique that is silent leaves the minimiser's fractions", "", minimiser<float>, minimiser<double>) {
  using real = typename TestType::real;
  TestType rule = make<TestType>({});
  for (auto o : two_triangles::observe<real>(falling, 0.5, 40, 1)) {
    o.pdfs[1] = 0;
    rule.observe(o);
  }
  CHECK(rule.update() == rule_status::no_information);
  CHECK(rule.fractions()[0] == real(0.5));
}

TEMPLATE_TEST_CASE("No prior is a prior of 0, and an infinite one keeps the start", "", newton<float>, newton<double>,
                   minimiser<float>, minimiser<double>) {
  using real = typename TestType::real;
  const auto learn = [](real prior) {
    auto options = phimis::without_floors<real, 2>();
    options.start = {{real(0.25), real(0.75)}};
    options.prior = prior;
    TestType rule = make<TestType>(options);
    for (const auto& o : two_triangles::observe<real>(falling, 0.25, 40, 1)) rule.observe(o);
    CHECK(rule.update() == rule_status::updated);
    CHECK(std::fabs(rule.fractions()[0] + rule.fractions()[1] - 1) <= std::numeric_limits<real>::epsilon());
    return rule.fractions()[0];
  };
  auto unset = phimis::without_floors<real, 2>();
  unset.start = {{real(0.25), real(0.75)}};
  TestType rule = make<TestType>(unset);
  for (const auto& o : two_triangles::observe<real>(falling, 0.25, 40, 1)) rule.observe(o);
  rule.update();
  const real free = rule.fractions()[0];
  CHECK(learn(0) == free);
  CHECK(free > real(0.4));  // f asks for two thirds
  // The more prior, the nearer: 40 samples move it by at most about 40/prior.
  CHECK(std::fabs(learn(real(1e7)) - real(0.25)) <= real(4e-6));
  const real half = learn(40);
  CHECK(half > real(0.27));
  CHECK(half < free - real(0.02));
}

TEMPLATE_TEST_CASE("Floors hold", "", newton<float>, newton<double>, minimiser<float>, minimiser<double>) {
  using real = typename TestType::real;
  // f = p_1 asks for α_1 = 1, f = p_2 for α_1 = 0.
  for (const bool first : {true, false}) {
    auto options = phimis::without_floors<real, 2>();
    options.floors = {{real(0.05), real(0.1)}};
    TestType rule = make<TestType>(options);
    for (int batch = 0; batch < 12; ++batch) {
      const double alpha = static_cast<double>(rule.fractions()[0]);
      const auto f = [first](double x) { return first ? two_triangles::p1(x) : two_triangles::p2(x); };
      const int n = batch < 6 ? 10 : 0;  // the table holds 64
      for (const auto& o : two_triangles::observe<real>(f, alpha, n, 1 + static_cast<std::uint64_t>(batch))) rule.observe(o);
      if (n > 0) rule.update();
      CHECK(rule.fractions()[0] >= real(0.05));
      CHECK(rule.fractions()[1] >= real(0.1) - std::numeric_limits<real>::epsilon());
    }
    if constexpr (std::is_same_v<TestType, minimiser<real>>) {
      CHECK(rule.fractions()[first ? 1 : 0] == (first ? real(0.1) : real(0.05)));
    }
  }
}

TEMPLATE_TEST_CASE("Floors that leave no choice are the fractions", "", newton<float>, newton<double>, minimiser<float>,
                   minimiser<double>) {
  using real = typename TestType::real;
  auto options = phimis::without_floors<real, 2>();
  options.floors = {{real(0.25), real(0.75)}};
  TestType rule = make<TestType>(options);
  for (const auto& o : two_triangles::observe<real>(falling, 0.25, 40, 1)) rule.observe(o);
  rule.update();
  CHECK(rule.fractions()[0] == real(0.25));
  CHECK(rule.fractions()[1] == real(0.75));
}

TEST_CASE("The rule that learns nothing learns nothing") {
  rule_options<double, 3> options;
  options.start = {{0.2, 0.3, 0.5}};
  phimis::fixed_fractions<double, 3> rule(options);
  rule.observe({1, {{1, 2, 3}}, 1, 0});
  CHECK(rule.update() == rule_status::start);
  CHECK(rule.fractions()[2] == 0.5);
}

namespace {
template <class Real>
using minimiser_of_three = phimis::exact_minimiser<phimis::chi_squared, phimis::fixed_table<Real, 3, 96>>;
}  // namespace

TEMPLATE_TEST_CASE("A frozen technique keeps its start even below its floor, the others keep theirs", "",
                   (phimis::linear_heuristic<double, 3>), (phimis::second_order<double, 3>),
                   (phimis::sigma_proportional<double, 3, phimis::balance>),
                   (phimis::inverse_variance_fractions<double, 3>), minimiser_of_three<double>) {
  rule_options<double, 3> options;
  options.start = {{0.05, 0, 0.95}};
  options.floors = {{0.1, 0.1, 0.1}};
  options.frozen[0] = true;
  TestType rule = [&] {
    if constexpr (std::is_same_v<TestType, minimiser_of_three<double>>) {
      return TestType({}, options);
    } else {
      return TestType(options);
    }
  }();
  CHECK(rule.fractions()[0] == 0.05);
  CHECK(rule.fractions()[1] == Approx(0.1));
  CHECK(rule.fractions()[2] == Approx(0.85));
  for (const auto& o : three_powers::tabulate([](double x) { return 0.1 + x * x * x; }, 32)) rule.observe(o);
  rule.update();
  CHECK(rule.fractions()[0] == 0.05);
  CHECK(rule.fractions()[1] >= 0.1 * (1 - 1e-15));
  CHECK(rule.fractions()[2] >= 0.1 * (1 - 1e-15));
  CHECK(rule.fractions()[1] + rule.fractions()[2] == Approx(0.95).epsilon(1e-14));
}

TEMPLATE_TEST_CASE("A floor holds beside frozen techniques that have all but rounding", "", float, double) {
  const TestType least = std::numeric_limits<TestType>::epsilon() / 64;
  rule_options<TestType, 3> options;
  options.start = {{TestType(0.25), TestType(0.75), 0}};
  options.floors = {{0, 0, least}};
  options.frozen = {{true, true, false}};
  const auto alpha = phimis::share_budget<TestType, 3>({{1, 1, 1}}, options);
  CHECK(alpha[0] == TestType(0.25));
  CHECK(alpha[1] == TestType(0.75));
  CHECK(alpha[2] == least);
}

TEMPLATE_TEST_CASE("A rule that learns nothing has equal fractions unless told otherwise", "", float, double) {
  phimis::fixed_fractions<TestType, 4> rule;
  rule.observe({1, {{1, 2, 3, 4}}, 1, 0});
  CHECK(rule.update() == rule_status::start);
  for (int k = 0; k < 4; ++k) CHECK(rule.fractions()[k] == TestType(0.25));
}
