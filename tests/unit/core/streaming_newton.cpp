// SPDX-License-Identifier: MIT
// streaming_newton.hpp, and what every rule's state is.
#include "catch.hpp"
#include "random.hpp"
#include "three_powers.hpp"
#include "two_triangles.hpp"

#include <phimis/core/exact_minimiser.hpp>
#include <phimis/core/linear_heuristic.hpp>
#include <phimis/core/newton_raphson.hpp>
#include <phimis/core/streaming_newton.hpp>

#include <cmath>
#include <functional>
#include <limits>
#include <type_traits>
#include <vector>

namespace {

using phimis::rule_status;
using phimis::tsallis;

template <class Real, int M = 3>
using streaming = phimis::streaming_newton<tsallis, Real, M>;
template <class Real>
using streaming_variance = phimis::streaming_newton<phimis::multi_sample_variance, Real, 3>;
template <class Real>
using observations = std::vector<phimis::observation<Real, 3>>;

double in_the_span(double x) { return 0.2 + 1.0 * x + 0.9 * x * x; }  // fractions .2, .5, .3
double falling(double x) { return std::exp(-3 * x); }                 // wants the first alone, and the floors
double wave(double x) { return 1.2 + std::sin(7 * x); }

template <class Rule>
Rule learnt(Rule rule, const observations<typename Rule::real>& all) {
  for (const auto& o : all) rule.observe(o);
  rule.update();
  return rule;
}

template <class Real>
double distance(const phimis::fractions<Real, 3>& a, const phimis::fractions<Real, 3>& b) {
  double most = 0;
  for (int k = 0; k < 3; ++k) most = std::fmax(most, std::fabs(static_cast<double>(a[k] - b[k])));
  return most;
}

template <class Real>
constexpr double rounding = static_cast<double>(std::numeric_limits<Real>::epsilon());

}  // namespace

TEMPLATE_TEST_CASE("For two techniques and one batch it is the step of Newton–Raphson", "", float, double) {
  for (const double gamma : {0.3, 0.5, 1.0, 2.0}) {
    auto options = phimis::without_floors<TestType, 2>();
    options.start = {{TestType(0.4), TestType(0.6)}};
    phimis::newton_raphson<tsallis, TestType> paper(tsallis{gamma}, phimis::newton_form::paper, options);
    streaming<TestType, 2> ours(tsallis{gamma}, options);
    for (const auto& o : two_triangles::observe<TestType>([](double x) { return 3 - 2 * x; }, 0.4, 60, 7)) {
      paper.observe(o);
      ours.observe(o);
    }
    CHECK(paper.update() == rule_status::updated);
    CHECK(ours.update() == rule_status::updated);
    CHECK(paper.fractions()[0] != TestType(0.4));
    // q is given to rounding, and with it Σ_l H_kl α_l = G_k.
    CHECK(std::fabs(static_cast<double>(ours.fractions()[0] - paper.fractions()[0])) <= 100 * rounding<TestType>);
  }
}

TEMPLATE_TEST_CASE("Updates on the same observations, with nothing retained, walk to the exact minimum", "", float,
                   double) {
  using exact = phimis::exact_minimiser<tsallis, phimis::fixed_table<TestType, 3, 96>>;
  for (const double gamma : {0.5, 1.0, 2.0}) {
    for (const auto f : {in_the_span, falling, wave}) {
      const auto all = three_powers::observe<TestType>(f, {{20, 40, 30}}, 3);
      const exact best = learnt(exact(tsallis{gamma}, {}, phimis::control_variate::off), all);
      REQUIRE(best.status() == rule_status::updated);
      streaming<TestType> rule(tsallis{gamma}, {}, 0);
      for (int step = 0; step < 12; ++step) rule = learnt(rule, all);
      // The minimum is flat: half of the digits are in the fractions of float.
      CHECK(distance(rule.fractions(), best.fractions()) <= (std::is_same_v<TestType, float> ? 2e-3 : 1e-9));
    }
  }
}

TEMPLATE_TEST_CASE("Older sums are retained with their weight", "", float, double) {
  const auto before = three_powers::observe<TestType>(falling, {{20, 40, 30}}, 3);
  const auto after = three_powers::observe<TestType>(wave, {{30, 30, 30}}, 4);
  phimis::rule_options<TestType, 3> options;
  options.prior = 5;
  const auto check = [&](const auto& divergence, TestType retention) {
    using rule_type = phimis::streaming_newton<std::decay_t<decltype(divergence)>, TestType, 3>;
    rule_type retaining(divergence, options, retention);
    for (const auto& o : before) retaining.observe(o);
    retaining.update();
    // The same by hand: all is forgotten, and pooled again.
    rule_type forgetting(divergence, options, 0);
    for (const auto& o : before) forgetting.observe(o);
    const auto older = forgetting.state();
    forgetting.update();
    CHECK(distance(retaining.fractions(), forgetting.fractions()) == 0);
    for (const auto& o : after) retaining.observe(o);
    for (const auto& o : after) forgetting.observe(o);
    forgetting.pool(older, retention);
    retaining.update();
    forgetting.update();
    CHECK(distance(retaining.fractions(), forgetting.fractions()) <= 100 * rounding<TestType>);
  };
  for (const TestType retention : {TestType(0.25), TestType(0.9)}) {
    check(tsallis{0.5}, retention);
    check(tsallis{2}, retention);
    check(phimis::multi_sample_variance{}, retention);
  }
}

TEMPLATE_TEST_CASE("Updates for V[F] walk to the fractions where it is least", "", float, double) {
  using exact = phimis::exact_minimiser<phimis::multi_sample_variance, phimis::fixed_table<TestType, 3, 96>>;
  const auto rough = [](double x) { return in_the_span(x) * (1.2 + 0.8 * std::sin(4 * x)); };
  const auto signed_f = [](double x) { return in_the_span(x) + 1.5 * std::sin(7 * x); };  // means have signs
  double apart = 0;
  for (const auto& f : {std::function<double(double)>(falling), {rough}, {signed_f}}) {
    const auto all = three_powers::observe<TestType>(f, {{20, 40, 30}}, 3);
    streaming_variance<TestType> rule({}, {}, 0);
    for (int step = 0; step < 200; ++step) rule = learnt(rule, all);
    // From there, since there may be another local minimum.
    phimis::rule_options<TestType, 3> options;
    options.start = rule.fractions();
    const exact best = learnt(exact({}, options, phimis::control_variate::off), all);
    REQUIRE(best.status() == rule_status::local);
    CHECK(distance(rule.fractions(), best.fractions()) <= (std::is_same_v<TestType, float> ? 2e-3 : 1e-9));
    streaming<TestType> one_sample(tsallis{2}, {}, 0);
    for (int step = 0; step < 12; ++step) one_sample = learnt(one_sample, all);
    apart = std::fmax(apart, distance(one_sample.fractions(), best.fractions()));
  }
  CHECK(apart > 0.003);  // the optimum of V[ℱ] is another
}

TEMPLATE_TEST_CASE("The rule for V[F] merges, scales and keeps within its options as the others do", "", float,
                   double) {
  const auto all = three_powers::observe<TestType>(wave, {{20, 40, 30}}, 5);
  auto options = phimis::without_floors<TestType, 3>();
  options.prior = 3;
  options.floors = {{TestType(0.05), TestType(0.1), 0}};
  const streaming_variance<TestType> fresh({}, options, TestType(0.5));
  const auto one = learnt(learnt(fresh, all), all);
  CHECK(one.fractions()[0] >= TestType(0.05));
  CHECK(one.fractions()[1] >= TestType(0.1));
  streaming_variance<TestType> left = fresh, right = fresh;
  for (std::size_t j = 0; j < all.size(); ++j) (j % 3 == 0 ? left : right).observe(all[j]);
  left.merge(right);
  left.update();
  CHECK(distance(left.fractions(), learnt(fresh, all).fractions()) <= 1000 * rounding<TestType>);
  CHECK(distance(learnt(left, all).fractions(), one.fractions()) <= 1000 * rounding<TestType>);
  // What was merged matters: a third of the observations alone teaches something else.
  auto third = fresh;
  for (std::size_t j = 0; j < all.size(); j += 3) third.observe(all[j]);
  third.update();
  CHECK(distance(third.fractions(), left.fractions()) > 1e-3);
  auto scaled = all;
  for (auto& o : scaled) o.f *= -TestType(1e20);
  CHECK(distance(learnt(learnt(fresh, scaled), scaled).fractions(), one.fractions()) <= 1000 * rounding<TestType>);
  options.frozen[1] = true;
  options.start = {{TestType(0.25), TestType(0.25), TestType(0.5)}};
  const auto held = learnt(streaming_variance<TestType>({}, options), all);
  CHECK(held.fractions()[1] == TestType(0.25));
  CHECK(held.fractions()[0] != TestType(0.25));
}

TEMPLATE_TEST_CASE("Where nothing is retained the unit is forgotten, too", "", float, double) {
  const auto all = three_powers::observe<TestType>(wave, {{20, 40, 30}}, 5);
  auto faint = all;
  for (auto& o : faint) o.f *= TestType(std::is_same_v<TestType, float> ? 1e-25 : 1e-200);
  const auto once = learnt(streaming<TestType>(tsallis{2}, {}, 0), all);
  CHECK(distance(learnt(once, faint).fractions(), learnt(once, all).fractions()) <= 1000 * rounding<TestType>);
}

TEMPLATE_TEST_CASE("Merged in any grouping, states learn the same; pooled with weight 2, as if seen twice", "", float,
                   double) {
  const auto all = three_powers::observe<TestType>(wave, {{20, 40, 30}}, 5);
  const auto one = learnt(streaming<TestType>(tsallis{0.7}), all);
  random_numbers random(4);
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<streaming<TestType>> groups(5, streaming<TestType>(tsallis{0.7}));
    for (const auto& o : all) groups[static_cast<std::size_t>(random.below(5))].observe(o);
    while (groups.size() > 1) {
      groups[static_cast<std::size_t>(random.below(static_cast<int>(groups.size()) - 1))].merge(groups.back());
      groups.pop_back();
    }
    CHECK(groups[0].counters().observations == 90);
    CHECK(groups[0].update() == rule_status::updated);
    CHECK(distance(groups[0].fractions(), one.fractions()) <= 1000 * rounding<TestType>);
  }
  const auto others = three_powers::observe<TestType>(falling, {{30, 30, 30}}, 6);
  streaming<TestType> neighbour(tsallis{0.7});
  for (const auto& o : others) neighbour.observe(o);
  streaming<TestType> pooled(tsallis{0.7});
  streaming<TestType> twice(tsallis{0.7});
  for (const auto& o : all) {
    pooled.observe(o);
    twice.observe(o);
  }
  pooled.pool(neighbour.state(), 2);
  for (int time = 0; time < 2; ++time) {
    for (const auto& o : others) twice.observe(o);
  }
  pooled.update();
  twice.update();
  CHECK(distance(pooled.fractions(), twice.fractions()) <= 1000 * rounding<TestType>);
  CHECK(distance(pooled.fractions(), one.fractions()) > 0.01);
  CHECK(pooled.counters().observations == 90);
}

TEMPLATE_TEST_CASE("No scale of f, nor of the measure, changes what is learnt from sums", "", float, double) {
  const auto all = three_powers::observe<TestType>(wave, {{20, 40, 30}}, 5);
  const auto plain = learnt(streaming<TestType>(tsallis{2}), all);
  const bool single = std::is_same_v<TestType, float>;
  for (const double unit : {single ? 1e-30 : 1e-300, -1.0, single ? 1e30 : 1e300}) {
    auto scaled = all;
    for (auto& o : scaled) o.f *= static_cast<TestType>(unit);
    CHECK(distance(learnt(streaming<TestType>(tsallis{2}), scaled).fractions(), plain.fractions()) <=
          100 * rounding<TestType>);
    if (unit < 0) continue;
    scaled = all;
    for (auto& o : scaled) {
      o.q *= static_cast<TestType>(unit);
      for (TestType& pdf : o.pdfs.value) pdf *= static_cast<TestType>(unit);
    }
    CHECK(distance(learnt(streaming<TestType>(tsallis{2}), scaled).fractions(), plain.fractions()) <=
          100 * rounding<TestType>);
  }
}

TEMPLATE_TEST_CASE("Floors of a streaming rule hold, and are reached", "", float, double) {
  auto options = phimis::without_floors<TestType, 3>();
  options.floors = {{0, TestType(0.01), TestType(0.02)}};
  streaming<TestType> rule(tsallis{1}, options, 0);
  for (int batch = 0; batch < 8; ++batch) {
    rule = learnt(rule, three_powers::observe<TestType>(falling, {{40, 40, 40}}, 2));
    CHECK(rule.fractions()[1] >= TestType(0.01));
    CHECK(rule.fractions()[2] >= TestType(0.02));
  }
  CHECK(rule.fractions()[1] == TestType(0.01));
  CHECK(rule.fractions()[2] == TestType(0.02));
}

TEMPLATE_TEST_CASE("A streaming rule keeps frozen techniques, and its prior keeps the start", "", float, double) {
  auto options = phimis::without_floors<TestType, 3>();
  options.start = {{TestType(0.5), TestType(0.25), TestType(0.25)}};
  const auto all = three_powers::observe<TestType>(wave, {{40, 40, 40}}, 8);
  const auto free = learnt(streaming<TestType>(tsallis{1}, options), all);
  CHECK(distance(free.fractions(), options.start) > 0.05);
  auto held = options;
  held.frozen[2] = true;
  const auto frozen = learnt(streaming<TestType>(tsallis{1}, held), all);
  CHECK(frozen.fractions()[2] == TestType(0.25));
  CHECK(frozen.fractions()[0] != TestType(0.5));
  auto trusting = options;
  trusting.prior = TestType(1e6);
  CHECK(distance(learnt(streaming<TestType>(tsallis{1}, trusting), all).fractions(), options.start) < 1e-3);
}

TEMPLATE_TEST_CASE("Without information a streaming rule stays; what is not finite is counted", "", float, double) {
  using limits = std::numeric_limits<TestType>;
  streaming<TestType> rule(tsallis{2}, {}, 0);
  CHECK(rule.update() == rule_status::no_information);
  for (const auto& o : three_powers::observe<TestType>([](double) { return 0.0; }, {{5, 5, 5}}, 1)) rule.observe(o);
  CHECK(rule.update() == rule_status::no_information);
  for (const TestType bad : {limits::quiet_NaN(), limits::infinity(), -limits::infinity()}) {
    rule.observe({bad, {{1, 1, 1}}, 1, 0});
    rule.observe({1, {{1, bad, 1}}, 1, 0});
    rule.observe({1, {{1, 1, 1}}, bad, 0});
  }
  rule.observe({1, {{1, -1, 1}}, 1, 0});
  rule.observe({1, {{0, 0, 0}}, 1, 0});
  rule.observe({1, {{1, 1, 1}}, 0, 0});
  CHECK(rule.counters().observations == 27);
  CHECK(rule.counters().zero == 15);
  CHECK(rule.counters().nonfinite == 12);
  CHECK(rule.update() == rule_status::no_information);
  CHECK(distance(rule.fractions(), phimis::equal_fractions<TestType, 3>()) == 0);

  // p/q that overflows a sum: all is forgotten, and said.
  const TestType tiny = limits::min();
  for (int i = 0; i < 20; ++i) rule.observe({1, {{1, 2, 1}}, tiny, 0});
  CHECK(rule.update() == rule_status::not_converged);
  CHECK(distance(rule.fractions(), phimis::equal_fractions<TestType, 3>()) == 0);
  CHECK(learnt(rule, three_powers::observe<TestType>(wave, {{20, 40, 30}}, 5)).status() == rule_status::updated);
}

TEMPLATE_TEST_CASE("A rule goes on from the state of another with its options", "", float, double) {
  const auto all = three_powers::observe<TestType>(wave, {{20, 40, 30}}, 5);
  streaming<TestType> without_pause(tsallis{1}, {}, TestType(0.5));
  streaming<TestType> host(tsallis{1}, {}, TestType(0.5));
  typename streaming<TestType>::state_type kept = host.state();
  static_assert(std::is_trivially_copyable_v<decltype(kept)>);
  for (std::size_t i = 0; i < all.size(); ++i) {
    host.resume(kept);
    host.observe(all[i]);
    without_pause.observe(all[i]);
    if (i % 30 == 29) {
      host.update();
      without_pause.update();
    }
    kept = host.state();
    host.observe(all[0]);  // of another cell
  }
  CHECK(distance(kept.fractions, without_pause.fractions()) == 0);
  CHECK(kept.counters.observations == 90);
}

TEST_CASE("A pixel's state of two techniques in float takes 64 bytes") {
  using phimis::negative_fractions;
  CHECK(sizeof(phimis::fixed_fractions<float, 2>::state_type) <= 64);
  CHECK(sizeof(phimis::newton_raphson<tsallis, float>::state_type) <= 64);
  CHECK(sizeof(phimis::linear_heuristic<float, 2, negative_fractions::drop_most_negative>::state_type) <= 64);
  CHECK(sizeof(phimis::streaming_newton<tsallis, float, 2>::state_type) <= 64);
}
