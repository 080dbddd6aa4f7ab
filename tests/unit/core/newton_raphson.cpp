// SPDX-License-Identifier: MIT
#include "catch.hpp"
#include "two_triangles.hpp"

#include <phimis/core/newton_raphson.hpp>

#include <cmath>
#include <limits>
#include <type_traits>
#include <vector>

namespace {

using phimis::newton_form;
using phimis::newton_raphson;
using phimis::rule_options;
using phimis::rule_status;
template <class Real>
using observations = std::vector<phimis::observation<Real, 2>>;

double f(double x) { return 0.6 + 0.8 * x * x; }

/// α_1 after one step, from the formulas of the paper and of the control variate, in long double.
///
///     ζ  = Σ (p_1 − p_2)/q s(t),   −ζ' = Σ (p_1 − p_2)²/(q p) t s'(t),   t = f/p,   T Eqs. 30–32
///     control variate: ζ − λ Σ (p_1 − p_2)/q,   λ = Σ p/q s / Σ p/q
template <class Real>
long double one_step(const observations<Real>& all, long double beta, long double alpha, bool control_variate) {
  long double zeta = 0, slope = 0, score = 0, tilt = 0, mixture = 0;
  for (const auto& o : all) {
    const long double p1 = o.pdfs[0], p2 = o.pdfs[1], q = o.q;
    const long double p = alpha * p1 + (1 - alpha) * p2;
    const long double t = std::fabs(static_cast<long double>(o.f)) / p;
    const long double s = beta == 0 ? std::log(t) : (beta > 0 ? 1 : -1) * (t > 0 ? std::pow(t, beta) : 0);
    const long double ts = beta == 0 ? 1 : std::fabs(beta) * (t > 0 ? std::pow(t, beta) : 0);
    zeta += (p1 - p2) / q * s;
    slope += (p1 - p2) * (p1 - p2) / (q * p) * ts;
    score += p / q * s;
    tilt += (p1 - p2) / q;
    mixture += p / q;
  }
  if (control_variate) zeta -= score / mixture * tilt;
  return alpha + zeta / slope;
}

template <class Divergence, class Real>
newton_raphson<Divergence, Real> at(const Divergence& divergence, newton_form form, double alpha) {
  auto options = phimis::without_floors<Real, 2>();
  options.start = {{static_cast<Real>(alpha), 1 - static_cast<Real>(alpha)}};
  return newton_raphson<Divergence, Real>(divergence, form, options);
}

/// γ = .1 .. 3 forward, exponents down to −1 reversed.
template <class F>
void for_each_exponent(F&& test) {
  for (const double gamma : {0.1, 0.5, 1.0, 2.0, 3.0}) test(phimis::tsallis{gamma});
  for (const double gamma : {0.5, 1.0, 2.0}) test(phimis::reversed<phimis::tsallis>{{gamma}});
}

}  // namespace

// The sizes that README.md and docs/policies.md state.
static_assert(sizeof(void*) != 8 || sizeof(phimis::newton_raphson<phimis::hellinger, double>::state_type) == 128, "");
static_assert(sizeof(void*) != 8 || sizeof(phimis::newton_raphson<phimis::hellinger, float>::state_type) == 64, "");

TEMPLATE_TEST_CASE("One update is the step of Eqs. 30-32, in both forms", "", float, double) {
  const auto all = two_triangles::observe<TestType>(f, 0.4, 100, 1);
  // 100 terms of either sign with a few roundings each, over a slope of about their size.
  const long double tolerance = 200 * static_cast<long double>(std::numeric_limits<TestType>::epsilon());
  int inside = 0;
  for_each_exponent([&](const auto& divergence) {
    using divergence_type = std::decay_t<decltype(divergence)>;
    for (const auto form : {newton_form::paper, newton_form::safeguarded}) {
      INFO("exponent " << divergence.exponent() << (form == newton_form::paper ? ", paper" : ", safeguarded"));
      auto rule = at<divergence_type, TestType>(divergence, form, 0.4);
      for (const auto& o : all) rule.observe(o);
      const long double alpha = static_cast<long double>(rule.fractions()[0]);
      REQUIRE(rule.update() == rule_status::updated);
      // Reversed Kullback–Leibler takes the control variate in either form.
      const bool variate = form == newton_form::safeguarded || divergence.exponent() == 0;
      const long double step = one_step(all, divergence.exponent(), alpha, variate);
      const bool left = step < 0 || step > 1;
      const long double end = step < 0 ? 0 : 1;
      const long double wanted = !left ? step : form == newton_form::paper ? end : (alpha + end) / 2;
      inside += !left;
      CHECK(std::fabs(static_cast<long double>(rule.fractions()[0]) - wanted) <= tolerance);
      CHECK(std::fabs(rule.fractions()[0] + rule.fractions()[1] - 1) <= std::numeric_limits<TestType>::epsilon());
      CHECK(rule.counters().left == left);
    }
  });
  CHECK(inside >= 12);  // of 16
}

TEMPLATE_TEST_CASE("Samples with f = 0 are observations of both forms", "", float, double) {
  const auto with_zeros = [](double x) { return x < 0.3 ? 0.0 : f(x); };
  const auto all = two_triangles::observe<TestType>(with_zeros, 0.4, 100, 5);
  const long double tolerance = 200 * static_cast<long double>(std::numeric_limits<TestType>::epsilon());
  for (const double gamma : {0.5, 1.0, 2.0}) {
    for (const auto form : {newton_form::paper, newton_form::safeguarded}) {
      auto rule = at<phimis::tsallis, TestType>(phimis::tsallis{gamma}, form, 0.4);
      for (const auto& o : all) rule.observe(o);
      CHECK(rule.counters().zero > 15);
      const long double alpha = static_cast<long double>(rule.fractions()[0]);
      REQUIRE(rule.update() == rule_status::updated);
      const long double step = one_step(all, gamma, alpha, form == newton_form::safeguarded);
      const bool left = step < 0 || step > 1;
      const long double end = step < 0 ? 0 : 1;
      const long double wanted = !left ? step : form == newton_form::paper ? end : (alpha + end) / 2;
      CAPTURE(gamma, left);
      CHECK(std::fabs(static_cast<long double>(rule.fractions()[0]) - wanted) <= tolerance);
    }
  }
}

TEMPLATE_TEST_CASE("Each update uses its own batch alone", "", float, double) {
  auto rule = at<phimis::kullback_leibler, TestType>({}, newton_form::safeguarded, 0.4);
  for (const auto& o : two_triangles::observe<TestType>(f, 0.4, 100, 1)) rule.observe(o);
  rule.update();
  const TestType after_one = rule.fractions()[0];
  auto fresh = at<phimis::kullback_leibler, TestType>({}, newton_form::safeguarded, static_cast<double>(after_one));
  for (const auto& o : two_triangles::observe<TestType>(f, static_cast<double>(after_one), 100, 2)) {
    rule.observe(o);
    fresh.observe(o);
  }
  rule.update();
  fresh.update();
  CHECK(rule.fractions()[0] == fresh.fractions()[0]);
  // A batch of nothing, and one of zeros.
  const TestType before = rule.fractions()[0];
  CHECK(rule.update() == rule_status::no_information);
  rule.observe({0, {{1, 1}}, 1, 0});
  CHECK(rule.update() == rule_status::no_information);
  CHECK(rule.fractions()[0] == before);
}

TEMPLATE_TEST_CASE("No scale of f changes the step", "", float, double) {
  const auto all = two_triangles::observe<TestType>(f, 0.4, 100, 1);
  const TestType tolerance = 200 * std::numeric_limits<TestType>::epsilon();
  const std::vector<TestType> scales = std::is_same<TestType, float>::value
                                           ? std::vector<TestType>{TestType(1e-30), TestType(1e30)}
                                           : std::vector<TestType>{TestType(1e-300), TestType(1e300)};
  for_each_exponent([&](const auto& divergence) {
    using divergence_type = std::decay_t<decltype(divergence)>;
    for (const auto form : {newton_form::paper, newton_form::safeguarded}) {
      for (const TestType prior : {TestType(0), TestType(5)}) {
        INFO("exponent " << divergence.exponent() << ", prior " << prior);
        const auto learn = [&](TestType scale) {
          auto options = phimis::without_floors<TestType, 2>();
          options.start = {{TestType(0.4), TestType(0.6)}};
          options.prior = prior;
          newton_raphson<divergence_type, TestType> rule(divergence, form, options);
          for (auto o : all) {
            o.f *= scale;
            rule.observe(o);
          }
          CHECK(rule.update() == rule_status::updated);
          return rule.fractions()[0];
        };
        const TestType wanted = learn(1);
        for (const TestType scale : scales) CHECK(std::fabs(learn(scale) - wanted) <= tolerance);
        CHECK(std::fabs(learn(-1) - wanted) == 0);  // |f| is what is mimicked
      }
    }
  });
}

TEMPLATE_TEST_CASE("A unit of the measure changes no step", "", float, double) {
  const auto all = two_triangles::observe<TestType>(f, 0.4, 100, 1);
  const auto learn = [&](TestType unit) {
    auto rule = at<phimis::tsallis, TestType>({0.5}, newton_form::safeguarded, 0.4);
    for (auto o : all) {
      o.f *= unit;
      o.q *= unit;
      for (int k = 0; k < 2; ++k) o.pdfs[k] *= unit;
      rule.observe(o);
    }
    rule.update();
    return rule.fractions()[0];
  };
  for (const int exponent : {-60, 60}) CHECK(learn(std::ldexp(TestType(1), exponent)) == learn(1));
}

TEMPLATE_TEST_CASE("Merged batches are one batch, in any grouping", "", float, double) {
  const auto all = two_triangles::observe<TestType>([](double x) { return x < 0.1 ? 0 : f(x); }, 0.4, 100, 1);
  const TestType tolerance = 200 * std::numeric_limits<TestType>::epsilon();
  random_numbers random(2);
  const auto check = [&](const auto& divergence, const observations<TestType>& batch) {
    using rule_type = newton_raphson<std::decay_t<decltype(divergence)>, TestType>;
    const rule_type empty = at<std::decay_t<decltype(divergence)>, TestType>(divergence, newton_form::safeguarded, 0.4);
    rule_type whole = empty;
    std::vector<rule_type> groups(8, empty);
    for (const auto& o : batch) {
      whole.observe(o);
      groups[random.bits() % 7].observe(o);  // the eighth stays empty
    }
    while (groups.size() > 1) {
      groups[random.bits() % (groups.size() - 1)].merge(groups.back());
      groups.pop_back();
    }
    CHECK(groups[0].counters().observations == 100);
    CHECK(groups[0].update() == whole.update());
    CHECK(std::fabs(groups[0].fractions()[0] - whole.fractions()[0]) <= tolerance);
    CHECK(whole.fractions()[0] != empty.fractions()[0]);
  };
  for (const double gamma : {0.1, 0.5, 1.0, 2.0, 3.0}) check(phimis::tsallis{gamma}, all);
  const auto positive = two_triangles::observe<TestType>(f, 0.4, 100, 3);
  for (const double gamma : {0.5, 1.0, 2.0}) check(phimis::reversed<phimis::tsallis>{{gamma}}, positive);
  static_assert(std::is_trivially_copyable<newton_raphson<phimis::tsallis, TestType>>::value, "");
}

TEMPLATE_TEST_CASE("A merged state with a divergence that is infinite says so", "", float, double) {
  using rule_type = newton_raphson<phimis::reversed<phimis::kullback_leibler>, TestType>;
  rule_type one, other;
  one.observe({1, {{1, 2}}, 1, 0});
  other.observe({0, {{1, 2}}, 1, 0});
  one.merge(other);
  CHECK(one.update() == rule_status::infinite_divergence);
  CHECK(one.fractions()[0] == TestType(0.5));
  // The next batch is free of it.
  for (const auto& o : two_triangles::observe<TestType>(f, 0.5, 50, 1)) one.observe(o);
  CHECK(one.update() == rule_status::updated);
}

TEMPLATE_TEST_CASE("Reversed divergences of order one and more are infinite at f = 0, of less are not", "", float, double) {
  for (const double gamma : {0.5, 1.0, 2.0}) {
    newton_raphson<phimis::reversed<phimis::tsallis>, TestType> rule(phimis::reversed<phimis::tsallis>{{gamma}});
    for (const auto& o : two_triangles::observe<TestType>(f, 0.5, 50, 1)) rule.observe(o);
    rule.observe({0, {{1, 1}}, 1, 0});
    CHECK(rule.update() == (gamma < 1 ? rule_status::updated : rule_status::infinite_divergence));
  }
}

TEMPLATE_TEST_CASE("Iterates that leave the simplex are counted and brought back, in both forms", "", float, double) {
  // f is steeper than any mixture: the step goes far beyond 1.
  const auto all = two_triangles::observe<TestType>([](double x) { return std::pow(1 - x, 6); }, 0.5, 200, 1);
  for (const auto form : {newton_form::paper, newton_form::safeguarded}) {
    auto options = phimis::without_floors<TestType, 2>();
    options.floors = {{TestType(0.01), TestType(0.01)}};
    newton_raphson<phimis::tsallis, TestType> rule({0.1}, form, options);
    for (const auto& o : all) rule.observe(o);
    REQUIRE(one_step(all, 0.1L, 0.5L, form == newton_form::safeguarded) > 1.05L);
    REQUIRE(rule.update() == rule_status::updated);
    CHECK(rule.counters().left == 1);
    // The paper's form ends at the floor, the safeguarded one half the way to it.
    const double wanted = form == newton_form::paper ? 0.99 : (0.5 + 0.99) / 2;
    CHECK(static_cast<double>(rule.fractions()[0]) == Approx(wanted).epsilon(1e-6));
    CHECK(rule.fractions()[1] >= TestType(0.01) - std::numeric_limits<TestType>::epsilon());
  }
}

TEMPLATE_TEST_CASE("A step below the floor goes half the way in the safeguarded form", "", float, double) {
  const auto all = two_triangles::observe<TestType>([](double x) { return std::pow(x, 6); }, 0.5, 200, 1);
  REQUIRE(one_step(all, 0.1L, 0.5L, true) < -0.05L);
  auto options = phimis::without_floors<TestType, 2>();
  options.floors = {{TestType(0.1), 0}};
  newton_raphson<phimis::tsallis, TestType> rule({0.1}, newton_form::safeguarded, options);
  for (const auto& o : all) rule.observe(o);
  rule.update();
  CHECK(rule.counters().left == 1);
  CHECK(static_cast<double>(rule.fractions()[0]) == Approx((0.5 + 0.1) / 2).epsilon(1e-6));
}

TEMPLATE_TEST_CASE("A sample that the current mixture cannot reach is counted, not summed", "", float, double) {
  auto rule = at<phimis::kullback_leibler, TestType>({}, newton_form::paper, 1.0);
  rule.observe({1, {{0, 2}}, 1, 1});  // p(α) = 0 < f
  CHECK(rule.counters().nonfinite == 1);
  rule.observe({0, {{0, 2}}, 1, 1});  // f = 0 there is an observation
  CHECK(rule.counters().nonfinite == 1);
  CHECK(rule.counters().zero == 1);
  CHECK(rule.update() == rule_status::no_information);
  CHECK(rule.fractions()[0] == 1);
}

TEMPLATE_TEST_CASE("The prior is an observation of each technique where only it has density", "", float, double) {
  // ζ + prior (s(μ̂ π_1/α_1) − s(μ̂ π_2/α_2)) and its slope, by hand; μ̂ = Σ f/q / n.
  const auto all = two_triangles::observe<TestType>(f, 0.4, 100, 1);
  const long double prior = 25, alpha = static_cast<long double>(static_cast<TestType>(0.4));
  for (const double gamma : {0.5, 1.0, 2.0}) {
    long double zeta = 0, slope = 0, mean = 0;
    for (const auto& o : all) {
      const long double p1 = o.pdfs[0], p2 = o.pdfs[1], q = o.q, p = alpha * p1 + (1 - alpha) * p2;
      const long double s = std::pow(static_cast<long double>(o.f) / p, static_cast<long double>(gamma));
      zeta += (p1 - p2) / q * s;
      slope += (p1 - p2) * (p1 - p2) / (q * p) * gamma * s;
      mean += static_cast<long double>(o.f) / q / 100;
    }
    // At the start π = α, both scores are those of the mean: the prior only adds slope.
    const long double s = std::pow(mean, static_cast<long double>(gamma));
    slope += prior * gamma * s * (1 / alpha + 1 / (1 - alpha));
    auto options = phimis::without_floors<TestType, 2>();
    options.start = {{TestType(0.4), TestType(0.6)}};
    options.prior = TestType(prior);
    newton_raphson<phimis::tsallis, TestType> rule({gamma}, newton_form::paper, options);
    for (const auto& o : all) rule.observe(o);
    rule.update();
    const long double tolerance = 200 * static_cast<long double>(std::numeric_limits<TestType>::epsilon());
    CHECK(std::fabs(static_cast<long double>(rule.fractions()[0]) - (alpha + zeta / slope)) <= tolerance);
  }
}

TEMPLATE_TEST_CASE("A prior pulls fractions back to the start from anywhere", "", float, double) {
  auto options = phimis::without_floors<TestType, 2>();
  options.start = {{TestType(0.3), TestType(0.7)}};
  options.prior = TestType(1e6);
  newton_raphson<phimis::kullback_leibler, TestType> rule({}, newton_form::safeguarded, options);
  for (int batch = 0; batch < 5; ++batch) {
    const double alpha = static_cast<double>(rule.fractions()[0]);
    for (const auto& o : two_triangles::observe<TestType>(two_triangles::p1, alpha, 50, 4)) rule.observe(o);
    rule.update();
    CHECK(std::fabs(rule.fractions()[0] - TestType(0.3)) <= TestType(5 * 50e-6));
  }
}

TEST_CASE("With many samples the steps converge to the fractions of a zero-variance integrand") {
  // f = p(.3): with the control variate exactly, from any batch.
  for_each_exponent([](const auto& divergence) {
    INFO(divergence.exponent());
    const auto mix = [](double x) { return 7 * (0.3 * two_triangles::p1(x) + 0.7 * two_triangles::p2(x)); };
    newton_raphson<std::decay_t<decltype(divergence)>, double> rule(divergence);
    for (int batch = 0; batch < 12; ++batch) {
      for (const auto& o : two_triangles::observe(mix, rule.fractions()[0], 50, 5 + static_cast<std::uint64_t>(batch))) {
        rule.observe(o);
      }
      rule.update();
    }
    CHECK(std::fabs(rule.fractions()[0] - 0.3) <= 1e-12);
  });
}

TEMPLATE_TEST_CASE("A floor that one minus the other's rounds away holds all the same", "", float, double) {
  const TestType least = std::numeric_limits<TestType>::epsilon() / 64;
  for (const newton_form form : {newton_form::paper, newton_form::safeguarded}) {
    newton_raphson<phimis::chi_squared, TestType> rule({}, form, {{{0, 1}}, {{least, 1}}});
    // All that is seen speaks for the second technique.
    for (const TestType x : {TestType(1), TestType(2)}) rule.observe({x, {{TestType(0.5), x}}, x, 1});
    CHECK(rule.update() == rule_status::updated);
    CHECK(rule.fractions()[0] == least);
    CHECK(rule.fractions()[1] == 1);
  }
}

TEMPLATE_TEST_CASE("From an end, infinitely far from its prior, a step goes back to the start", "", float, double) {
  auto options = phimis::without_floors<TestType, 2>();
  options.prior = 1;
  for (const TestType first : {TestType(0), TestType(1)}) {
    newton_raphson<phimis::chi_squared, TestType> rule({}, newton_form::paper, options);
    auto state = rule.state();
    state.fractions = {{first, 1 - first}};
    rule.resume(state);
    for (const auto& o : two_triangles::observe<TestType>(f, 0.5, 20, 3)) rule.observe(o);
    CHECK(rule.update() == rule_status::updated);
    CHECK(rule.fractions()[0] == TestType(0.5));
  }
}

TEMPLATE_TEST_CASE("A technique without a share of the prior gets none of a reversed divergence", "", float, double) {
  phimis::rule_options<TestType, 2> options{.start = {{1, 0}}, .floors = {{0, TestType(0.1)}}};
  options.prior = 1;
  newton_raphson<phimis::reversed<phimis::chi_squared>, TestType> rule({}, newton_form::safeguarded, options);
  for (int batch = 0; batch < 3; ++batch) {
    for (const auto& o : two_triangles::observe<TestType>(f, 0.9, 50, 4)) rule.observe(o);
    CHECK(rule.update() == rule_status::updated);
    CHECK(rule.fractions()[0] == TestType(0.9));
  }
}

TEMPLATE_TEST_CASE("A step that is no number moves nothing and is counted", "", float, double) {
  auto options = phimis::without_floors<TestType, 2>();
  options.prior = 1;
  newton_raphson<phimis::chi_squared, TestType> rule({}, newton_form::safeguarded, options);
  auto state = rule.state();
  const TestType tiny = 2 * std::numeric_limits<TestType>::min();  // squared against it, the prior overflows
  state.fractions = {{tiny, 1}};
  rule.resume(state);
  for (const auto& o : two_triangles::observe<TestType>(f, 0.5, 20, 3)) rule.observe(o);
  CHECK(rule.update() == rule_status::not_converged);
  CHECK(rule.fractions()[0] == tiny);
  CHECK(rule.counters().left == 1);
}
