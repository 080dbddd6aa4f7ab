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
#include <limits>
#include <string>
#include <type_traits>

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
      const auto status = teach(rule, all);
      CAPTURE(rule.name(), start, rule.fractions()[0]);
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
    // |z| < 5: a false alarm in 6e-7, 79 of them.
    CHECK(std::fabs(estimates.mean - 0.5) <= 5 * std::sqrt(estimates.variance() / 100));
  }
}

TEMPLATE_TEST_CASE("The sign of f changes nothing where |f| is learnt from, and -f nothing at all", "", float,
                   double) {
  const auto f = [](double x) { return std::cos(5 * x) + 0.3; };
  for_two_and_three([&](const auto& techniques) {
    constexpr int M = std::decay_t<decltype(techniques)>::techniques;
    auto plain = every_rule<TestType, M>();
    auto minus = plain;
    auto magnitude = plain;
    const auto all = drawn<TestType>(f, techniques, 150);
    auto negative = all;
    auto positive = all;
    for (auto& o : negative) o.f = -o.f;
    for (auto& o : positive) o.f = std::fabs(o.f);
    for (std::size_t i = 0; i < plain.size(); ++i) {
      CAPTURE(plain[i].name(), M);
      teach(plain[i], all, 5);
      teach(minus[i], negative, 5);
      teach(magnitude[i], positive, 5);
      CHECK(same(plain[i].fractions(), minus[i].fractions()));
      if (!looks_at_the_sign(plain[i])) CHECK(same(plain[i].fractions(), magnitude[i].fractions()));
    }
  });
}

namespace {

/// How far a Gauss rule of 20 points on panels of this length leaves an optimum, where f has its roots between panels.
double off_by_quadrature(const any_divergence& divergence, double length) {
  // A kink where |f| = p(α) is inside a panel, whose nodes are .077 lengths apart at most. With s like |x − x_0|^{k−1} there,
  // ζ is off by that gap to the power k; five for the slope of |f|/p and four kinks.
  const double k = divergence.steps                         ? 1
                   : divergence.name == "Pearson-Vajda 1.5" ? 1.5
                   : divergence.name == "Pearson-Vajda 3"   ? 3
                                                            : 0;
  if (k > 0) return 5 * std::pow(0.077 * length, k);
  // Otherwise s is smooth between the roots, near which it is |x − root|^β: the rule is off by (length/20²)^{1 + β}, ten for
  // four ends and the slope of ζ. Of whole β it is smooth there, too: left are the solver's 1e-13 over the slope of ζ.
  const double beta = divergence.power ? divergence.exponent : 2;
  return 1e-11 + (beta == std::floor(beta) ? 0 : 10 * std::pow(length / 400, 1 + beta));
}

}  // namespace

TEST_CASE("An integrand of both signs has the divergences of its magnitude by quadrature, and its own variance") {
  const auto f = [](double x) { return std::cos(5 * x) + 0.3; };
  // Both techniques are needed: with p_2 = 2x in place of 2(1 − x) the first had all, and there were no digits to compare.
  const phimis::technique_set pair(power_of{0}, power_of{-1});
  const double root = std::acos(-0.3) / 5;
  const double second = (2 * std::acos(-1.0) - std::acos(-0.3)) / 5;
  const phimis::analysis::problem on(f, pair, phimis::interval(0, 1), {root, second});
  const double length = (second - root) / 20;  // of the longest panel
  for (auto& rule : exact_rules<double, 2>(phimis::without_floors<double, 2>())) {
    if (rule.infinite_at_zero()) continue;  // f has roots: integrals near them diverge
    const auto wanted = rule.divergence()->optimum(on, phimis::without_floors<double, 2>());
    teach(rule, quadrature(f, pair, {0, root, second, 1}));
    const double allowed = off_by_quadrature(*rule.divergence(), length);
    CAPTURE(rule.name(), rule.fractions()[0], wanted.alpha[0], wanted.error, allowed);
    CHECK(wanted.alpha[0] > 0.2);
    CHECK(wanted.alpha[0] < 0.5);
    CHECK(apart(rule.fractions(), wanted.alpha) <= allowed + wanted.error);
  }
}

TEMPLATE_TEST_CASE("Batches of zeros change no fraction of any rule, and what comes after them does", "", float,
                   double) {
  for_two_and_three([](const auto& techniques) {
    constexpr int M = std::decay_t<decltype(techniques)>::techniques;
    auto options = phimis::rule_options<TestType, M>{};
    options.start = phimis::fractions<TestType, M>{};
    for (int k = 0; k < M; ++k) options.start[k] = k == M - 1 ? TestType(0.5) : TestType(0.5) / (M - 1);
    options.start[0] -= TestType(0.125);
    options.start[M - 1] += TestType(0.125);
    const auto zeros = drawn<TestType>([](double) { return 0; }, techniques, 30);
    const auto good = drawn<TestType>([](double x) { return 0.3 + x * x * x; }, techniques, 300);
    for (auto& rule : every_rule<TestType, M>(options)) {
      CAPTURE(rule.name(), M);
      for (int batch = 0; batch < 3; ++batch) {
        teach(rule, zeros, 1);
        CHECK(same(rule.fractions(), options.start));
        if (rule.name() == "fixed") continue;
        CHECK(rule.status() ==
              (rule.infinite_at_zero() ? rule_status::infinite_divergence : rule_status::no_information));
      }
      CHECK(rule.counters().zero == 90);
      teach(rule, good, 1);
      // A rule of one batch has forgotten the zeros, and with them that its divergence was infinite.
      const bool remembers = rule.infinite_at_zero() && rule.how() == way::at_once;
      if (rule.name() != "fixed" && !remembers) CHECK_FALSE(same(rule.fractions(), options.start));
    }
  });
}

TEST_CASE("A run in which every sample is 0 says so under every rule, and has no error bar") {
  for_two_and_three([](const auto& techniques) {
    constexpr int M = std::decay_t<decltype(techniques)>::techniques;
    for (const auto& rule : every_rule<double, M>()) {
      const auto run = phimis::integrate([](double) { return 0.0; }, techniques,
                                         {.budget = 40, .iterations = 4, .growth = 4}, rule, phimis::square_root{});
      CAPTURE(rule.name(), M);
      CHECK(run.status == phimis::integration_status::all_zero);
      CHECK(run.estimate == 0);
      CHECK_FALSE(phimis::is_finite(run.standard_error));
      CHECK(same(run.fractions, phimis::equal_fractions<double, M>()));
    }
  });
}

namespace {

/// α_1 after one step for techniques that reach nothing in common, where t = a_k/α_k: ζ = s_1 − s_2 over its slope.
template <class Real>
double newton_step(double beta, const phimis::fractions<Real, 2>& from, const phimis::fractions<double, 2>& parts,
                   const phimis::per_technique<Real, 2>& floors, const std::string& name) {
  double s[2];
  double slope = 0;
  for (int k = 0; k < 2; ++k) {
    const double t = parts[k] / static_cast<double>(from[k]);
    const double power = std::pow(t, beta);
    s[k] = beta == 0 ? std::log(t) : beta > 0 ? power : -power;
    slope += (beta == 0 ? 1 : std::fabs(beta) * power) / static_cast<double>(from[k]);
  }
  const double start = static_cast<double>(from[0]);
  const double first = start + (s[0] - s[1]) / slope;
  const double edge = first < 0.5 ? static_cast<double>(floors[0]) : 1 - static_cast<double>(floors[1]);
  if (first < 0.5 ? first >= edge : first <= edge) return first;
  return name.find("Newton, ") == 0 ? (start + edge) / 2 : edge;  // the safeguard, or the nearest
}

}  // namespace

TEMPLATE_TEST_CASE("A technique that is silent for five batches is heard in the sixth", "", float, double) {
  // The last technique reaches only what no sample falls into at first. Then f = Σ a_k p_k, so that p ∝ a is best for every
  // divergence, whatever the rows before: f/p is constant.
  const auto check = [](const auto& techniques, const auto& parts) {
    constexpr int M = std::decay_t<decltype(techniques)>::techniques;
    const auto f = [&](double x) {
      const auto p = techniques.pdfs(x);
      double sum = 0;
      for (int k = 0; k < M; ++k) sum += parts[k] * p[k];
      return sum;
    };
    phimis::fractions<double, M> wanted{};
    double total = 0;
    for (const double part : parts) total += part;
    for (int k = 0; k < M; ++k) wanted[k] = parts[k] / total;
    const auto loud = drawn<TestType>(f, techniques, 60);
    observations<TestType, M> silent;
    for (const auto& o : loud) {
      if (o.technique != M - 1) silent.push_back(o);
    }
    // Where φ is flat around t = 1 a fraction is known to the root of the last digit.
    const double flat = 4 * std::sqrt(static_cast<double>(std::numeric_limits<TestType>::epsilon()));
    for (auto& rule : every_rule<TestType, M>()) {
      const bool linear = rule.name().find("linear") == 0;
      if (rule.how() == way::otherwise && !linear) continue;
      for (int batch = 0; batch < 5; ++batch) teach(rule, silent, 1);
      const auto before = rule.fractions();
      teach(rule, loud, 1);
      const auto after = rule.fractions();
      CAPTURE(rule.name(), M, before[M - 1], after[0], after[M - 1]);
      const bool variance = rule.divergence() && rule.divergence()->variance;
      if (rule.how() != way::by_steps) {
        CHECK(static_cast<double>(before[M - 1]) == Approx(1.0 / M).epsilon(4 * flat * flat));
        CHECK(rule.status() == (variance ? rule_status::local : rule_status::updated));
        // V[F] is 0 wherever the parts in reach of each other are as they are wanted: two of three techniques.
        if (!variance) CHECK(apart(after, wanted) <= flat);
        if (variance && M == 3) CHECK(std::fabs(after[0] / after[1] - wanted[0] / wanted[1]) <= 4 * flat);
      } else if (!variance) {
        CHECK(rule.status() == rule_status::updated);
        if constexpr (M == 2) {
          // The sums of 60 rows, rounded, over a slope of |β|.
          const double beta = rule.divergence()->exponent;
          const double rounded = 60 * std::numeric_limits<TestType>::epsilon() / (beta == 0 ? 1 : std::fabs(beta));
          const double first = newton_step(beta, before, wanted, rule.options().floors, rule.name());
          CAPTURE(first);
          CHECK(std::fabs(static_cast<double>(after[0]) - first) <= rounded);
        } else {
          // The streaming rule alone, from the floor at which the silence left the technique.
          CHECK(after[M - 1] > before[M - 1]);
          CHECK(after[M - 1] < static_cast<TestType>(wanted[M - 1]));
        }
      }
    }
  };
  check(phimis::technique_set(power_of{1}, uniform_on{2, 3}), phimis::per_technique<double, 2>{{1, 5}});
  check(phimis::technique_set(power_of{0}, power_of{1}, uniform_on{2, 3}),
        phimis::per_technique<double, 3>{{1, 0.5, 5}});
}

TEST_CASE("A silent technique keeps its fraction, and updates on the way do not matter to the exact rules") {
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
  for_two_and_three([](const auto& techniques) {
    constexpr int M = std::decay_t<decltype(techniques)>::techniques;
    for (const int at : {0, 31, 59}) {
      auto all = drawn<TestType>([](double x) { return 1 + x; }, techniques, 60);
      all[static_cast<std::size_t>(at)].f *= TestType(1e12);
      for (const auto variate : {control_variate::on, control_variate::off}) {
        for (auto& rule : every_rule<TestType, M>({}, variate)) {
          CAPTURE(rule.name(), M, at, static_cast<int>(variate));
          teach(rule, all, 5);
          if (!rule.divergence() || rule.divergence()->steps) continue;
          CHECK((rule.status() == rule_status::updated || rule.status() == rule_status::local));
        }
      }
    }
  });
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
