// SPDX-License-Identifier: MIT
// Integrands that are hard: zero nearly everywhere or wherever a technique looks, of both signs, with a huge outlier.
#include "any_rule.hpp"
#include "cases.hpp"
#include "catch.hpp"
#include "random.hpp"

#include <phimis/core/moments.hpp>
#include <phimis/integrate.hpp>

#include <cmath>
#include <cstdint>
#include <string>

namespace {

using namespace hard;
using phimis::control_variate;
using phimis::rule_status;

const phimis::technique_set powers(power_of{0}, power_of{1}, power_of{2});

/// Whether a rule looks at the sign of f: estimates have it, divergences do not.
template <class Rule>
bool looks_at_the_sign(const Rule& rule) {
  return (rule.divergence() && rule.divergence()->variance) || rule.name() == "sigma" ||
         rule.name() == "inverse variance" || rule.name() == "joint";
}

}  // namespace

TEMPLATE_TEST_CASE("Where f is 0 on 99.9 % of the domain, the technique that is narrow around the rest has all", "",
                   float, double) {
  // f = 1000 on [0, .001], p_1 = 1, p_2 = 500 on [0, .002]: G_2 − G_1 = .499 (s(t) − s(0)) >= 0 at every mixture.
  const auto f = [](double x) { return x < 0.001 ? 1000.0 : 0.0; };
  const phimis::technique_set pair(uniform_on{0, 1}, uniform_on{0, 0.002});
  const auto all = quadrature<TestType>(f, pair, {0, 0.001, 0.002, 1}, 2);
  for (const TestType start : {TestType(0), TestType(0.5), TestType(1)}) {
    const auto options = starting_at<TestType, 2>({{start, 1 - start}});
    for (auto& rule : exact_rules<TestType, 2>(options, control_variate::off)) {
      CAPTURE(rule.name(), start, rule.fractions()[0]);
      const auto status = teach(rule, all);
      if (rule.infinite_at_zero()) {
        CHECK(status == rule_status::infinite_divergence);
        CHECK(same(rule.fractions(), options.start));
      } else {
        CHECK(rule.fractions()[1] == 1);
      }
    }
  }
}

TEST_CASE("Where f is 0 on 99.9 % of the domain estimates of every rule are unbiased") {
  const auto f = [](double x) { return x < 0.001 ? 1e6 * x : 0.0; };  // ∫ = ½
  const phimis::technique_set pair(uniform_on{0, 1}, uniform_on{0, 0.002});
  for (const auto& rule : every_rule<double, 2>({.floors = {{0.1, 0.1}}})) {
    phimis::moments<double> estimates;
    random_numbers random(7);
    const auto next = [&] { return random(); };
    for (int i = 0; i < 100; ++i) {
      const auto run =
          phimis::integrate(f, pair, {.budget = 60, .iterations = 3, .growth = 2}, rule, next, phimis::square_root{});
      estimates.add(run.estimate);
    }
    CAPTURE(rule.name(), estimates.mean);
    // |z| < 5: a false alarm in 6e-7, 66 of them.
    CHECK(std::fabs(estimates.mean - 0.5) <= 5 * std::sqrt(estimates.variance() / 100));
  }
}

TEMPLATE_TEST_CASE("The sign of f changes nothing where |f| is learnt from, and -f nothing at all", "", float,
                   double) {
  const auto f = [](double x) { return std::cos(5 * x) + 0.3; };
  auto plain = every_rule<TestType, 3>();
  auto minus = plain;
  auto magnitude = plain;
  const auto all = drawn<TestType>(f, powers, 150);
  auto negative = all;
  auto positive = all;
  for (auto& o : negative) o.f = -o.f;
  for (auto& o : positive) o.f = std::fabs(o.f);
  for (std::size_t i = 0; i < plain.size(); ++i) {
    CAPTURE(plain[i].name());
    teach(plain[i], all, 5);
    teach(minus[i], negative, 5);
    teach(magnitude[i], positive, 5);
    CHECK(same(plain[i].fractions(), minus[i].fractions()));
    if (!looks_at_the_sign(plain[i])) CHECK(same(plain[i].fractions(), magnitude[i].fractions()));
  }
}

TEST_CASE("An integrand of both signs has the divergences of its magnitude by quadrature, and its own variance") {
  const auto f = [](double x) { return std::cos(5 * x) + 0.3; };
  const phimis::technique_set pair(power_of{0}, power_of{1});
  const double root = std::acos(-0.3) / 5;
  const double second = (2 * std::acos(-1.0) - std::acos(-0.3)) / 5;
  const phimis::analysis::problem on(f, pair, phimis::interval(0, 1), {root, second});
  for (auto& rule : exact_rules<double, 2>(phimis::without_floors<double, 2>())) {
    if (rule.infinite_at_zero()) continue;  // f has roots: integrals near them diverge
    const auto wanted = rule.divergence()->optimum(on, phimis::without_floors<double, 2>());
    CAPTURE(rule.name(), wanted.alpha[0], wanted.error);
    teach(rule, quadrature(f, pair, {0, root, second, 1}));
    // |f| = |x − root|^γ is no polynomial: quadrature is off by a panel's share of it, 1/20^{1 + γ}.
    CHECK(apart(rule.fractions(), wanted.alpha) <= 1e-2);
  }
}

TEMPLATE_TEST_CASE("Batches of zeros change no fraction of any rule, and what comes after them does", "", float,
                   double) {
  auto options = phimis::rule_options<TestType, 3>{};
  options.start = {{TestType(0.25), TestType(0.25), TestType(0.5)}};
  const auto zeros = drawn<TestType>([](double) { return 0; }, powers, 30);
  const auto good = drawn<TestType>([](double x) { return 0.3 + x * x * x; }, powers, 300);
  for (auto& rule : every_rule<TestType, 3>(options)) {
    CAPTURE(rule.name());
    for (int batch = 0; batch < 3; ++batch) {
      teach(rule, zeros, 1);
      CHECK(same(rule.fractions(), options.start));
      if (rule.name() == "fixed") continue;
      CHECK(rule.status() ==
            (rule.infinite_at_zero() ? rule_status::infinite_divergence : rule_status::no_information));
    }
    CHECK(rule.counters().zero == 90);
    teach(rule, good, 1);
    if (rule.name() != "fixed" && !rule.infinite_at_zero()) CHECK_FALSE(same(rule.fractions(), options.start));
  }
}

TEST_CASE("A run in which every sample is 0 says so under every rule, and has no error bar") {
  for (const auto& rule : every_rule<double, 3>()) {
    const auto run = phimis::integrate([](double) { return 0.0; }, powers,
                                       {.budget = 40, .iterations = 4, .growth = 4}, rule, phimis::square_root{});
    CAPTURE(rule.name());
    CHECK(run.status == phimis::integration_status::all_zero);
    CHECK(run.estimate == 0);
    CHECK_FALSE(phimis::is_finite(run.standard_error));
    CHECK(same(run.fractions, phimis::equal_fractions<double, 3>()));
  }
}

TEMPLATE_TEST_CASE("A technique that is silent for five batches is heard in the sixth", "", float, double) {
  // Technique 3 reaches only what no sample falls into at first; then it alone has a peak.
  const auto early = drawn<TestType>([](double x) { return 1 + x; },
                                     phimis::technique_set(power_of{0}, power_of{1}, uniform_on{2, 3}), 60);
  observations<TestType, 3> silent;
  observations<TestType, 3> loud;
  for (const auto& o : early) {
    if (o.technique != 2) silent.push_back(o);
    loud.push_back(o);
    if (o.technique == 2) loud.back().f = TestType(5);
  }
  for (auto& rule : every_rule<TestType, 3>()) {
    CAPTURE(rule.name());
    for (int batch = 0; batch < 5; ++batch) teach(rule, silent, 1);
    const auto before = rule.fractions();
    for (int batch = 0; batch < 5; ++batch) teach(rule, loud, 1);
    // |f| at the peak is some four times that elsewhere: what minimises anything wants more of it.
    if (rule.how() == way::otherwise) continue;
    if (rule.divergence()->variance) continue;  // V[F]: the peak is constant, and one technique's counts are decided
    CHECK(rule.fractions()[2] > before[2]);
    CHECK(rule.status() == rule_status::updated);
  }
}

TEST_CASE(
    "A silent technique keeps its fraction, and afterwards the exact rules know what they know without the silence") {
  const auto f = [](double x) { return 0.3 + x * x * x; };
  const auto all = drawn(f, powers, 240);
  auto silent = drawn(f, powers, 60);
  for (auto& o : silent) o.pdfs[2] = 0;
  auto waiting = exact_rules<double, 3>();
  auto at_once = waiting;
  for (std::size_t i = 0; i < waiting.size(); ++i) {
    for (int batch = 0; batch < 3; ++batch) {
      teach(waiting[i], silent);
      CHECK(waiting[i].fractions()[2] == Approx(1.0 / 3).epsilon(1e-15));
      for (const auto& o : silent) at_once[i].observe(o);
    }
    teach(waiting[i], all);
    teach(at_once[i], all);
    CAPTURE(waiting[i].name(), waiting[i].fractions()[0], at_once[i].fractions()[0]);
    // Both are minima of the same sums, whose residual is 1e-13: α is as near as its root where φ is flat, of kinks that are
    // rounded off as near as a row.
    CHECK(apart(waiting[i].fractions(), at_once[i].fractions()) <= (waiting[i].divergence()->steps ? 1e-3 : 1e-6));
  }
}

TEST_CASE("A technique that alone sees an outlier of 1e12 has the fraction of the formula") {
  // p_1 reaches the outlier alone and p_2 the 99 others: (1e12/α_1)^β = 99 α_2^{−β}.
  observations<double, 2> all{{1e12, {{1, 0}}, 1, 0}};
  all.resize(100, {1, {{0, 1}}, 1, 1});
  for (auto& rule : exact_rules<double, 2>(phimis::without_floors<double, 2>(), control_variate::off)) {
    if (!rule.divergence()->power || rule.divergence()->exponent == 0) continue;  // log t has a unit
    const double ratio = 1e12 * std::pow(99, -1 / rule.divergence()->exponent);
    CAPTURE(rule.name(), ratio);
    CHECK(teach(rule, all) == rule_status::updated);
    // Each α is precise to its own last digits; the root of ζ to ε of G over its logarithmic slope |β| >= .1.
    CHECK(rule.fractions()[0] / rule.fractions()[1] == Approx(ratio).epsilon(1e-9));
  }
}

TEMPLATE_TEST_CASE("One outlier of 1e12 times the mean leaves no rule without a number", "", float, double) {
  for (const int at : {0, 31, 59}) {
    auto all = drawn<TestType>([](double x) { return 1 + x; }, powers, 60);
    all[static_cast<std::size_t>(at)].f *= TestType(1e12);
    for (const auto variate : {control_variate::on, control_variate::off}) {
      for (auto& rule : every_rule<TestType, 3>({}, variate)) {
        CAPTURE(rule.name(), at, static_cast<int>(variate));
        teach(rule, all, 5);
        if (!rule.divergence() || rule.divergence()->steps) continue;
        CHECK((rule.status() == rule_status::updated || rule.status() == rule_status::local));
      }
    }
  }
}

TEST_CASE("With an outlier of 1e12 the condition of optimality holds in long double") {
  auto all = drawn([](double x) { return 1 + x; }, phimis::technique_set(power_of{0}, power_of{1}), 60);
  for (const std::size_t at : {std::size_t(0), std::size_t(33)}) {
    auto with = all;
    with[at].f *= 1e12;
    for (auto& rule : exact_rules<double, 2>(phimis::without_floors<double, 2>(), control_variate::off)) {
      if (!rule.divergence()->power || rule.divergence()->exponent == 0) continue;
      const long double beta = rule.divergence()->exponent;
      teach(rule, with);
      const long double a[2] = {rule.fractions()[0], rule.fractions()[1]};
      long double g[2] = {0, 0};
      for (const auto& o : with) {
        const long double p = a[0] * o.pdfs[0] + a[1] * o.pdfs[1];
        const long double s = (beta > 0 ? 1 : -1) * std::pow(o.f / p, beta);
        for (int k = 0; k < 2; ++k) g[k] += o.pdfs[k] / static_cast<long double>(o.q) * s;
      }
      const long double size = a[0] * std::fabs(g[0]) + a[1] * std::fabs(g[1]);
      CAPTURE(rule.name(), rule.fractions()[0], at);
      if (a[0] > 0 && a[1] > 0) CHECK(std::fabs(g[0] - g[1]) <= 1e-12L * size);
      if (!(a[0] > 0)) CHECK(g[0] <= g[1] * (1 + (g[1] > 0 ? 1e-12L : -1e-12L)));
      if (!(a[1] > 0)) CHECK(g[1] <= g[0] * (1 + (g[0] > 0 ? 1e-12L : -1e-12L)));
    }
  }
}
