// SPDX-License-Identifier: MIT
// Units change nothing: of f, of the measure, of both, by factors near the ends of the range. A power of two rounds nothing,
// so that not a digit may change; other factors round f or p once.
#include "any_rule.hpp"
#include "cases.hpp"
#include "catch.hpp"
#include "random.hpp"

#include <phimis/integrate.hpp>

#include <array>
#include <cmath>
#include <string>

namespace {

using namespace hard;
using phimis::control_variate;

const phimis::technique_set pair(power_of{0}, power_of{1});
const phimis::technique_set powers(power_of{0}, power_of{1}, power_of{2});

double plain(double x) { return 0.3 + x * x * x; }
double signs(double x) { return std::cos(4 * x) + 0.3; }

/// The rules taught with observations and with changed ones; check(rule, other) compares.
template <class Real, int M, class Change, class Check>
void compare(const observations<Real, M>& all, const phimis::rule_options<Real, M>& options, const Change& change,
             const Check& check) {
  observations<Real, M> changed = all;
  for (auto& o : changed) change(o);
  for (const auto variate : {control_variate::on, control_variate::off}) {
    auto rules = every_rule<Real, M>(options, variate);
    auto others = rules;
    for (std::size_t i = 0; i < rules.size(); ++i) {
      CAPTURE(rules[i].name(), static_cast<int>(variate));
      const auto status = teach(rules[i], all, 3);
      CHECK(teach(others[i], changed, 3) == status);
      CAPTURE(rules[i].fractions()[0], others[i].fractions()[0]);
      check(rules[i], others[i]);
    }
  }
}

const auto not_a_digit = [](const auto& rule, const auto& other) {
  CHECK(same(rule.fractions(), other.fractions()));
};

template <class Real>
phimis::rule_options<Real, 3> with_prior() {
  phimis::rule_options<Real, 3> options;
  options.prior = 3;
  return options;
}

}  // namespace

TEMPLATE_TEST_CASE("f times a power of two near 1e-300 or 1e+300 changes no digit of any rule", "", float, double) {
  for (const int exponent : is_float<TestType> ? std::array{-100, 100} : std::array{-996, 996}) {
    const auto change = [&](auto& o) { o.f = std::ldexp(o.f, exponent); };
    for (double (*f)(double) : {plain, signs}) {
      compare<TestType, 2>(drawn<TestType>(f, pair, 80), {}, change, not_a_digit);
      compare<TestType, 3>(drawn<TestType>(f, powers, 90), with_prior<TestType>(), change, not_a_digit);
    }
  }
}

TEMPLATE_TEST_CASE("f times 1e-300 and 1e+300 changes the fractions of every rule by rounding alone", "", float,
                   double) {
  for (const double scale : is_float<TestType> ? std::array{1e-30, 1e30} : std::array{1e-300, 1e300}) {
    const auto change = [&](auto& o) { o.f *= static_cast<TestType>(scale); };
    const auto check = [](const auto& rule, const auto& other) {
      // f is rounded once, to ε; a root of a jump moves with the rounding of the row that it sits on, one in 90.
      if (rule.divergence() && rule.divergence()->steps) return;
      CHECK(apart(rule.fractions(), other.fractions()) <= (is_float<TestType> ? 2e-3 : 1e-9));
    };
    compare<TestType, 3>(drawn<TestType>(plain, powers, 90), with_prior<TestType>(), change, check);
  }
}

TEMPLATE_TEST_CASE("A unit of the measure, for all samples or for each its own, changes no digit", "", float,
                   double) {
  for (const int exponent : {-100, 100}) {
    const auto change = [&](auto& o) {
      o.f = std::ldexp(o.f, exponent);
      o.q = std::ldexp(o.q, exponent);
      for (TestType& p : o.pdfs.value) p = std::ldexp(p, exponent);
    };
    compare<TestType, 2>(drawn<TestType>(plain, pair, 80), {}, change, not_a_digit);
    compare<TestType, 3>(drawn<TestType>(plain, powers, 90), with_prior<TestType>(), change, not_a_digit);
  }
  random_numbers random(3);
  const auto substitute = [&](auto& o) {  // dx = J du, another J at each sample
    const int exponent = random.below(101) - 50;
    o.f = std::ldexp(o.f, exponent);
    o.q = std::ldexp(o.q, exponent);
    for (TestType& p : o.pdfs.value) p = std::ldexp(p, exponent);
  };
  // The linear equations are sums of p and f themselves: they depend on the parametrisation, as their paper has them.
  const auto check = [](const auto& rule, const auto& other) {
    if (rule.name().find("linear") == std::string::npos) CHECK(same(rule.fractions(), other.fractions()));
  };
  compare<TestType, 3>(drawn<TestType>(plain, powers, 90), with_prior<TestType>(), substitute, check);
}

TEST_CASE("f times 1e-300 and 1e+300 scales the estimate of every rule and changes no fraction") {
  for (const auto& rule : every_rule<double, 2>()) {
    const auto run = [&](double scale) {
      return phimis::integrate([scale](double x) { return scale * plain(x); }, pair,
                               {.budget = 80, .iterations = 3, .growth = 4}, rule, phimis::square_root{});
    };
    const auto one = run(1);
    for (const int exponent : {-990, 990}) {
      const double scale = std::ldexp(1.0, exponent);
      const auto other = run(scale);
      CAPTURE(rule.name(), exponent);
      CHECK(same(one.fractions, other.fractions));
      CHECK(other.estimate / scale == Approx(one.estimate).epsilon(1e-14));
      CHECK(other.standard_error / scale == Approx(one.standard_error).epsilon(1e-12));
    }
  }
}

TEMPLATE_TEST_CASE("What only a technique without a fraction reaches is seen, however little it weighs", "", float,
                   double) {
  // Disjoint techniques, f/p = 1 in both: w_1 α_1^{−β} = w_2 α_2^{−β}. At α_1 = 0 the mixture is 0 there, and w p no number
  // where subnormal ones are flushed; then a vertex would have a certificate.
  const double weight = is_float<TestType> ? 1e-3 : 1e-20;
  observations<TestType, 2> all(20, {1, {{0, 1}}, 1, 1});
  for (std::size_t j = 0; j < 10; ++j) all[j] = {1, {{1, 0}}, static_cast<TestType>(1 / weight), 0};
  for (const int vertex : {0, 1}) {
    const auto options = starting_at<TestType, 2>({{TestType(1 - vertex), TestType(vertex)}});
    for (auto& rule : exact_rules<TestType, 2>(options, control_variate::off)) {
      if (!rule.divergence()->power || rule.divergence()->exponent == 0) continue;
      const double ratio = std::pow(weight, 1 / rule.divergence()->exponent);
      CHECK(teach(rule, all) == phimis::rule_status::updated);
      CAPTURE(rule.name(), vertex, ratio, rule.fractions()[0], rule.fractions()[1]);
      // ζ is solved to 4ε of λ: α to as much over its logarithmic slope |β| >= .1.
      const double found = static_cast<double>(rule.fractions()[0]) / static_cast<double>(rule.fractions()[1]);
      CHECK(found == Approx(ratio).epsilon(is_float<TestType> ? 1e-4 : 1e-12));
    }
  }
}
