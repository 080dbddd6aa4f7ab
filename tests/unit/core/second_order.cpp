// SPDX-License-Identifier: MIT
#include "catch.hpp"
#include "three_powers.hpp"
#include "two_triangles.hpp"

#include <phimis/core/second_order.hpp>

#include <cmath>
#include <limits>
#include <type_traits>

namespace {

using phimis::rule_status;
using fractions = phimis::fractions<double, 3>;
using options3 = phimis::rule_options<double, 3>;

template <class Real>
using second = phimis::second_order<Real, 3>;

double f(double x) { return x * x * x + 0.2 * x + 0.05; }

template <class Real>
second<Real> learnt(const std::vector<phimis::observation<Real, 3>>& all,
                    const phimis::rule_options<Real, 3>& options = phimis::without_floors<Real, 3>()) {
  second<Real> rule(options);
  for (const auto& o : all) rule.observe(o);
  rule.update();
  return rule;
}

/// The second-order expansion around the start of (Σ c a) ∫ f²/p, in the shares a_k ∝ c_k α_k, from its definition.
struct expansion {
  const std::vector<phimis::observation<double, 3>>& all;
  const options3& options;

  double operator()(const fractions& alpha) const {
    const auto& c = options.costs;
    const auto& start = options.start;
    double cost = 0, cost_here = 0;
    for (int k = 0; k < 3; ++k) cost += c[k] * start[k], cost_here += c[k] * alpha[k];
    double value = 0, mean = 0;
    for (const auto& o : all) mean += o.f / o.q / static_cast<double>(all.size());
    const auto add = [&](double weight, double f_here, const fractions& pdfs) {
      double p = 0, d = 0;
      for (int k = 0; k < 3; ++k)
        p += start[k] * pdfs[k] / cost, d += (alpha[k] / cost_here - start[k] / cost) * pdfs[k];
      // ∫ f²/(p + d) ≈ f²/p − f² d/p² + f² d²/p³
      if (p > 0) value += weight * f_here * f_here * (1 / p - d / (p * p) + d * d / (p * p * p));
    };
    for (const auto& o : all) add(1 / o.q, o.f, o.pdfs);
    for (int k = 0; k < 3 && options.prior > 0; ++k) {
      fractions only{};
      only[k] = 1;
      add(options.prior, mean * start[k], only);
    }
    return value;
  }
};

/// No fractions within the constraints are better than those that the rule found.
void check_minimum(const std::vector<phimis::observation<double, 3>>& all, const options3& options) {
  const auto rule = learnt(all, options);
  REQUIRE(rule.status() == rule_status::updated);
  const fractions found = rule.fractions();
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    CHECK(found[k] >= options.floors[k]);
    sum += found[k];
  }
  CHECK(sum == Approx(1).epsilon(1e-15));
  const expansion model{all, options};
  const double least = model(found);
  random_numbers random(1);
  for (int i = 0; i < 3000; ++i) {
    const fractions other = phimis::with_floors({{random(), random(), random()}}, options.floors);
    const double step = std::pow(10, -random.between(0, 5));
    fractions near{};
    for (int k = 0; k < 3; ++k) near[k] = found[k] + step * (other[k] - found[k]);
    REQUIRE(model(near) >= least * (1 - 1e-13));
  }
}

}  // namespace

TEST_CASE("Fractions are the minimum of the second-order expansion") {
  const auto all = three_powers::observe(f, {{40, 40, 40}}, 1);
  options3 options = phimis::without_floors<double, 3>();
  SECTION("around equal fractions") {}
  SECTION("around other fractions") { options.start = {{0.5, 0.3, 0.2}}; }
  SECTION("with floors") { options.floors = {{0.1, 0.3, 0.05}}; }
  SECTION("with costs") { options.costs = {{1, 2, 5}}; }
  SECTION("with costs and floors") {
    options.costs = {{4, 1, 9}};
    options.floors = {{0.2, 0.1, 0.15}};
  }
  SECTION("with a prior") {
    options.start = {{0.5, 0.3, 0.2}};
    options.prior = 50;
  }
  SECTION("with all of it") {
    options.start = {{0.4, 0.4, 0.2}};
    options.costs = {{1, 6, 3}};
    options.floors = {{0.05, 0.05, 0.25}};
    options.prior = 25;
  }
  check_minimum(all, options);
}

TEST_CASE("Two techniques take the step of the formula") {
  // V[ℱ](½ + d) ≈ V(½) − (b_1 − b_2) d + (A_11 − 2 A_12 + A_22) d², f = 1 + x/2 and p = 1 at ½.
  constexpr int n = 40000;
  phimis::second_order<double, 2> rule(phimis::without_floors<double, 2>());
  for (int j = 0; j < n; ++j) {
    const double x = (j + 0.5) / n;
    rule.observe({1 + x / 2, {{two_triangles::p1(x), two_triangles::p2(x)}}, 1, j % 2});
  }
  CHECK(rule.update() == rule_status::updated);
  // f² = 1 + x + x²/4 and p_1 − p_2 = 2 − 4x.
  const double tilt = (2 * (1 + 0.5 + 1.0 / 12)) - 4 * (0.5 + 1.0 / 3 + 1.0 / 16);
  const double square = 4 * (1 + 0.5 + 1.0 / 12) - 16 * (0.5 + 1.0 / 3 + 1.0 / 16) + 16 * (1.0 / 3 + 0.25 + 1.0 / 20);
  CHECK(std::fabs(rule.fractions()[0] - (0.5 + tilt / (2 * square))) <= 1e-7);
}

TEST_CASE("At its own minimum the expansion stays") {
  // f = Σ p: the gradient vanishes on exact integrals.
  const auto rule = learnt(three_powers::tabulate([](double x) { return 1 + 2 * x + 3 * x * x; }, 30000));
  for (int k = 0; k < 3; ++k) CHECK(std::fabs(rule.fractions()[k] - 1.0 / 3) <= 1e-5);
}

TEMPLATE_TEST_CASE("Float and double take the same step", "", float, double) {
  const auto wanted = learnt(three_powers::observe(f, {{40, 40, 40}}, 2)).fractions();
  const auto rule = learnt(three_powers::observe<TestType>(f, {{40, 40, 40}}, 2));
  CHECK(rule.status() == rule_status::updated);
  const double digits = 1e4 * static_cast<double>(std::numeric_limits<TestType>::epsilon());
  for (int k = 0; k < 3; ++k) CHECK(std::fabs(static_cast<double>(rule.fractions()[k]) - wanted[k]) <= digits);
  static_assert(std::is_trivially_copyable<second<TestType>>::value, "a pixel's state is copied by its bytes");
}

TEST_CASE("Without information the second-order rule stays where it was") {
  options3 options;
  options.start = {{0.5, 0.25, 0.25}};
  SECTION("no observations") { CHECK(learnt<double>({}, options).status() == rule_status::no_information); }
  SECTION("zeros") {
    const auto rule = learnt(three_powers::observe([](double) { return 0; }, {{9, 9, 9}}, 3), options);
    CHECK(rule.status() == rule_status::no_information);
    CHECK(rule.counters().zero == 27);
    CHECK(rule.fractions()[0] == 0.5);
  }
  SECTION("a silent technique") {
    auto all = three_powers::observe(f, {{9, 9, 9}}, 3);
    for (auto& o : all) o.pdfs[2] = 0;
    const auto rule = learnt(all, options);
    CHECK(rule.status() == rule_status::no_information);
    CHECK(rule.fractions()[0] == 0.5);
  }
  SECTION("pdfs that are the same") {
    auto all = three_powers::observe(f, {{9, 9, 9}}, 3);
    for (auto& o : all) o.pdfs = {{o.q, o.q, o.q}};
    const auto rule = learnt(all, options);
    for (int k = 0; k < 3; ++k) CHECK(rule.fractions()[k] == Approx(options.start[k]).epsilon(1e-12));
  }
}

TEST_CASE("Duplicate techniques share what one would get") {
  const auto all = three_powers::observe(f, {{30, 30, 30}}, 4);
  phimis::second_order<double, 2> pair(phimis::without_floors<double, 2>());
  options3 options = phimis::without_floors<double, 3>();
  options.start = {{0.5, 0.25, 0.25}};
  second<double> triple(options);
  for (const auto& o : all) {
    pair.observe({o.f, {{o.pdfs[0], o.pdfs[2]}}, o.q, 0});
    triple.observe({o.f, {{o.pdfs[0], o.pdfs[2], o.pdfs[2]}}, o.q, 0});
  }
  pair.update();
  CHECK(triple.update() == rule_status::updated);
  CHECK(triple.fractions()[0] == Approx(pair.fractions()[0]).margin(1e-9));
}

TEMPLATE_TEST_CASE("The sums of the expansion merge, and no scale of f or of the measure changes fractions", "",
                   float, double) {
  const double digits = 1e4 * static_cast<double>(std::numeric_limits<TestType>::epsilon());
  const auto all = three_powers::observe<TestType>(f, {{20, 20, 20}}, 5);
  const auto whole = learnt(all).fractions();
  second<TestType> first(phimis::without_floors<TestType, 3>());
  second<TestType> last = first;
  second<TestType> scaled = first;
  second<TestType> measured = first;
  constexpr int range = std::is_same_v<TestType, float> ? 90 : 900;
  for (std::size_t j = 0; j < all.size(); ++j) {
    auto o = all[j];
    (j < 31 ? first : last).observe(o);
    o.f = std::ldexp(o.f, range);
    scaled.observe(o);
    o.f = std::ldexp(o.f, -range);
    for (int k = 0; k < 3; ++k) o.pdfs[k] *= TestType(1e-6);
    o.q *= TestType(1e-6);
    measured.observe(o);
  }
  second<TestType> empty(phimis::without_floors<TestType, 3>());
  first.merge(empty);
  empty.merge(last);
  first.merge(empty);
  first.update();
  scaled.update();
  measured.update();
  for (int k = 0; k < 3; ++k) {
    CHECK(std::fabs(static_cast<double>(first.fractions()[k] - whole[k])) <= digits);
    CHECK(std::fabs(static_cast<double>(scaled.fractions()[k] - whole[k])) <= digits);
    CHECK(std::fabs(static_cast<double>(measured.fractions()[k] - whole[k])) <= digits);
  }
}

TEST_CASE("Frozen techniques keep their fraction in the expansion's minimum") {
  const auto all = three_powers::observe(f, {{30, 30, 30}}, 6);
  options3 options = phimis::without_floors<double, 3>();
  options.start = {{0.25, 0.5, 0.25}};
  options.frozen = {{false, true, false}};
  const fractions found = learnt(all, options).fractions();
  CHECK(found[1] == 0.5);
  const expansion model{all, options};
  for (int i = 0; i <= 100; ++i) CHECK(model({{0.005 * i, 0.5, 0.5 - 0.005 * i}}) >= model(found) * (1 - 1e-13));
  options.frozen = {{true, true, true}};
  CHECK(learnt(all, options).fractions()[0] == 0.25);
}

TEST_CASE("A sample that the start does not reach makes its expansion infinite: it is counted") {
  options3 options = phimis::without_floors<double, 3>();
  options.start = {{1, 0, 0}};
  second<double> rule(options);
  rule.observe({1, {{0, 1, 1}}, 1, 1});
  CHECK(rule.counters().nonfinite == 1);
}
