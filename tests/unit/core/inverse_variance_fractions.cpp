// SPDX-License-Identifier: MIT
#include "catch.hpp"
#include "three_powers.hpp"

#include <phimis/core/inverse_variance_fractions.hpp>
#include <phimis/core/moments.hpp>

#include <cmath>
#include <limits>
#include <type_traits>

namespace {

using phimis::rule_status;

template <class Real>
using inverse = phimis::inverse_variance_fractions<Real, 3>;

double f(double x) { return x * x * (1 + x); }

template <class Real>
inverse<Real> learnt(const std::vector<phimis::observation<Real, 3>>& all,
                     const phimis::rule_options<Real, 3>& options = phimis::without_floors<Real, 3>()) {
  inverse<Real> rule(options);
  for (const auto& o : all) rule.observe(o);
  rule.update();
  return rule;
}

/// 1/(c V[G_k]), normalised, in two passes.
phimis::per_technique<double, 3> shares_of(const std::vector<phimis::observation<double, 3>>& all,
                                           const phimis::per_technique<double, 3>& costs = {{1, 1, 1}}) {
  phimis::moments<double> of[3];
  for (const auto& o : all) of[o.technique].add(o.f / o.pdfs[o.technique]);
  phimis::per_technique<double, 3> shares{};
  for (int k = 0; k < 3; ++k) shares[k] = 1 / (costs[k] * of[k].variance());
  return phimis::with_floors(shares, {});
}

}  // namespace

TEMPLATE_TEST_CASE("Fractions are inverse to cost and variance of each technique alone", "", float, double) {
  const double digits = 5000 * static_cast<double>(std::numeric_limits<TestType>::epsilon());
  for (const bool costly : {false, true}) {
    auto options = phimis::without_floors<TestType, 3>();
    if (costly) options.costs = {{1, 4, TestType(0.5)}};
    const phimis::per_technique<double, 3> costs =
        costly ? phimis::per_technique<double, 3>{{1, 4, 0.5}} : phimis::per_technique<double, 3>{{1, 1, 1}};
    const auto wanted = shares_of(three_powers::observe(f, {{30, 50, 20}}, 1), costs);
    const auto rule = learnt(three_powers::observe<TestType>(f, {{30, 50, 20}}, 1), options);
    CHECK(rule.status() == rule_status::updated);
    for (int k = 0; k < 3; ++k) CHECK(static_cast<double>(rule.fractions()[k]) == Approx(wanted[k]).epsilon(digits));
  }
}

TEST_CASE("With many samples the fractions are those of the exact variances") {
  // f = 1 + x: V[G_1] = 1/12, V[G_2] = ∫ (1 + x)²/(2x) − 9/4 diverges at 0, and so does V[G_3].
  // f = x²: V[G_1] = 1/5 − 1/9, V[G_2] = 1/8 − 1/9, V[G_3] = 0.
  const auto rule = learnt(three_powers::tabulate([](double x) { return x * x * x; }, 40000));
  // f = x³: 1/7 − 1/16, 1/12 − 1/16, 1/15 − 1/16
  const double v[3] = {1.0 / 7 - 1.0 / 16, 1.0 / 12 - 1.0 / 16, 1.0 / 15 - 1.0 / 16};
  const double total = 1 / v[0] + 1 / v[1] + 1 / v[2];
  for (int k = 0; k < 3; ++k) CHECK(std::fabs(rule.fractions()[k] - 1 / v[k] / total) <= 1e-4);
}

TEMPLATE_TEST_CASE("A technique without variance gets all, up to the others' floors", "", float, double) {
  // f = 5 p_3
  const auto all = three_powers::observe<TestType>([](double x) { return 15 * x * x; }, {{10, 10, 10}}, 2);
  CHECK(learnt(all).fractions()[2] == 1);
  auto options = phimis::without_floors<TestType, 3>();
  options.floors = {{TestType(0.125), TestType(0.125), 0}};
  const auto floored = learnt(all, options);
  CHECK(floored.fractions()[0] == TestType(0.125));
  CHECK(floored.fractions()[2] == TestType(0.75));
}

TEST_CASE("The sign of f counts in the variance of a technique alone") {
  // f = ±p_1: |f|/p_1 has no variance.
  const auto all = three_powers::observe([](double x) { return x < 0.5 ? -1.0 : 1.0; }, {{20, 20, 20}}, 7);
  const auto wanted = shares_of(all);
  const auto rule = learnt(all);
  for (int k = 0; k < 3; ++k) CHECK(rule.fractions()[k] == Approx(wanted[k]).epsilon(1e-12));
}

TEST_CASE("Techniques without variance share by their costs") {
  // p_1 = p_2 = f on the samples
  auto options = phimis::without_floors<double, 3>();
  options.costs = {{1, 3, 1}};
  inverse<double> rule(options);
  for (int j = 1; j < 10; ++j) {
    rule.observe({1, {{1, 1, 0.1 * j}}, 1, 0});
    rule.observe({1, {{1, 1, 0.1 * j}}, 1, 1});
    rule.observe({1, {{1, 1, 0.1 * j}}, 1, 2});
  }
  CHECK(rule.update() == rule_status::updated);
  CHECK(rule.fractions()[0] == 0.75);
  CHECK(rule.fractions()[1] == 0.25);
  CHECK(rule.fractions()[2] == 0);
}

TEST_CASE("A technique of unknown variance keeps its floor") {
  auto options = phimis::without_floors<double, 3>();
  options.floors = {{0.0625, 0.0625, 0.0625}};
  SECTION("one sample") {
    const auto rule = learnt(three_powers::observe(f, {{9, 9, 1}}, 3), options);
    CHECK(rule.status() == rule_status::updated);
    CHECK(rule.fractions()[2] == 0.0625);
  }
  SECTION("nothing but zeros, whose variance would be the least") {
    inverse<double> rule(options);
    for (auto o : three_powers::observe(f, {{9, 9, 9}}, 3)) {
      if (o.technique == 0) o.f = 0;
      rule.observe(o);
    }
    CHECK(rule.update() == rule_status::updated);
    CHECK(rule.fractions()[0] == 0.0625);
  }
  SECTION("a variance beyond all bounds") {
    inverse<double> rule(options);
    for (auto o : three_powers::observe(f, {{9, 9, 9}}, 3)) {
      if (o.technique == 1) o.pdfs[1] *= 1e-300;
      rule.observe(o);
    }
    CHECK(rule.update() == rule_status::updated);
    CHECK(rule.fractions()[1] == 0.0625);
    CHECK(rule.fractions()[0] > 0.0625);
  }
  SECTION("all of them") {
    inverse<double> rule(options);
    CHECK(rule.update() == rule_status::no_information);
    for (const auto& o : three_powers::observe(f, {{1, 1, 1}}, 3)) rule.observe(o);
    CHECK(rule.update() == rule_status::no_information);
    CHECK(rule.fractions()[0] == 1.0 / 3);
  }
}

TEST_CASE("The prior of the inverse-variance rule is a mean") {
  const auto all = three_powers::observe(f, {{10, 10, 10}}, 4);
  auto options = phimis::without_floors<double, 3>();
  options.start = {{0.5, 0.25, 0.25}};
  const auto free = learnt(all, options).fractions();
  options.prior = 60;
  const auto bound = learnt(all, options).fractions();
  for (int k = 0; k < 3; ++k) CHECK(bound[k] == Approx((free[k] + 2 * options.start[k]) / 3).epsilon(1e-12));
}

TEMPLATE_TEST_CASE("Variances merge, and no scale of f or of the measure changes fractions", "", float, double) {
  const double digits = 512 * static_cast<double>(std::numeric_limits<TestType>::epsilon());
  const auto all = three_powers::observe<TestType>(f, {{20, 20, 20}}, 5);
  const auto whole = learnt(all).fractions();
  inverse<TestType> first(phimis::without_floors<TestType, 3>());
  inverse<TestType> second = first;
  inverse<TestType> scaled = first;
  inverse<TestType> measured = first;
  constexpr int range = std::is_same_v<TestType, float> ? 90 : 900;
  for (std::size_t j = 0; j < all.size(); ++j) {
    auto o = all[j];
    (j < 31 ? first : second).observe(o);
    o.f = std::ldexp(o.f, range);
    scaled.observe(o);
    o.f = std::ldexp(o.f, -range);
    for (int k = 0; k < 3; ++k) o.pdfs[k] *= TestType(1e-6);
    o.q *= TestType(1e-6);
    measured.observe(o);
  }
  first.merge(second);
  first.update();
  scaled.update();
  measured.update();
  for (int k = 0; k < 3; ++k) {
    CHECK(std::fabs(static_cast<double>(first.fractions()[k] - whole[k])) <= digits);
    CHECK(scaled.fractions()[k] == whole[k]);
    CHECK(std::fabs(static_cast<double>(measured.fractions()[k] - whole[k])) <= digits);
  }
}

TEST_CASE("A sample where its own technique has no density has no variance: it is counted") {
  inverse<double> rule;
  rule.observe({1, {{0, 1, 1}}, 1, 0});
  CHECK(rule.counters().nonfinite == 1);
  static_assert(std::is_trivially_copyable<inverse<float>>::value, "a pixel's state is copied by its bytes");
}

TEST_CASE("Frozen techniques keep their fraction under the inverse-variance rule") {
  auto options = phimis::without_floors<double, 3>();
  options.start = {{0.25, 0.5, 0.25}};
  options.frozen = {{false, true, false}};
  const auto all = three_powers::observe(f, {{10, 10, 10}}, 6);
  const auto wanted = shares_of(all);
  const auto rule = learnt(all, options);
  CHECK(rule.fractions()[1] == 0.5);
  CHECK(rule.fractions()[0] == Approx(0.5 * wanted[0] / (wanted[0] + wanted[2])).epsilon(1e-12));
}
