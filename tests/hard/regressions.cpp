// SPDX-License-Identifier: MIT
// Defects that reviews and fuzzers found, each kept as a test of what must hold.
#include "catch.hpp"
#include "subnormals.hpp"

#include <phimis/analysis/optimum.hpp>
#include <phimis/phimis.hpp>
#include <phimis/solver/minimise.hpp>

#include <Eigen/Core>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <type_traits>

namespace {

using phimis::control_variate;
using phimis::observation;
using phimis::rule_options;
using phimis::rule_status;

struct uniform_on {
  double lower, upper;
  double pdf(double x) const { return x >= lower && x <= upper ? 1 / (upper - lower) : 0; }
  template <class Next>
  double sample(Next&& next) const {
    return lower + (upper - lower) * next();
  }
};

/// p = 2x on [0, 1], of which the part above `reach` is lost.
struct rising_to {
  double reach;
  double pdf(double x) const { return x >= 0 && x <= reach ? 2 * x : 0; }
  template <class Next>
  double sample(Next&& next) const {
    const double x = std::sqrt(next());
    return x <= reach ? x : -1;
  }
};

}  // namespace

TEST_CASE("V[F] is minimised downhill of the start, from every start") {
  // Four points, one observation each, that has two local minima: α = 0 and α = .203166.
  const double p1[] = {.004, .444, .518, .034}, p2[] = {.949, .031, .008, .012}, f[] = {1.29, .03, .0064, .07};
  const auto learn = [&](double start) {
    phimis::exact_minimiser<phimis::multi_sample_variance, phimis::fixed_table<double, 2, 4>> rule(
        {}, {.start = {start, 1 - start}, .floors = {}}, control_variate::off);
    for (int i = 0; i < 4; ++i) rule.observe({f[i], {{p1[i], p2[i]}}, 0.25, 0});
    CHECK(rule.update() == rule_status::local);
    return rule.fractions()[0];
  };
  CHECK(learn(0) == 0);
  for (const double start : {0.15, 0.2, 0.25, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.99, 1.0}) {
    INFO("start " << start);
    CHECK(std::fabs(learn(start) - 0.203166) < 1e-6);
  }
}

TEST_CASE("A lost sample counts: f = 0 where every pdf is 0") {
  phimis::estimator<double, 2> estimator;
  const phimis::fractions<double, 2> half{{0.5, 0.5}};
  estimator.add(0, phimis::contribution(phimis::balance{}, 0, 0.0, half, {{0, 0}}));
  estimator.add(0, phimis::contribution(phimis::power{}, 0, 0.0, half, {{0, 0}}));
  CHECK(estimator.zero() == 2);
  CHECK(estimator.nonfinite() == 0);
  // Where f is not 0 it is a defect.
  estimator.add(0, phimis::contribution(phimis::balance{}, 0, 1.0, half, {{0, 0}}));
  CHECK(estimator.nonfinite() == 1);

  phimis::row<double, 2> row;
  CHECK(phimis::to_row(observation<double, 2>{0, {{0, 0}}, 0, 0}, row));
  CHECK(row.u == 0);
  CHECK_FALSE(phimis::to_row(observation<double, 2>{1, {{0, 0}}, 0, 0}, row));
}

TEST_CASE("Lost samples are worth nothing to any divergence") {
  // The same integral with the samples above .7 lost, pdfs 0, or present with f = 0 and their pdfs.
  const auto f = [](double x) { return x > 0 && x <= 0.7 ? 1 + x * x : 0; };
  const phimis::technique_set present(rising_to{1}, uniform_on{0, 1});
  const phimis::technique_set lost(rising_to{0.7}, uniform_on{0, 1});
  const auto learn = [&](const auto& divergence, const auto& techniques) {
    auto rule = phimis::exact_rule(divergence, {}, control_variate::off);
    std::mt19937_64 engine(5);
    auto next = [&] { return phimis::uniform(engine()); };
    phimis::draw_batch(f, techniques, rule.fractions(), {.samples = 40000}, phimis::balance{}, next,
                       [&](const auto& sample) { rule.observe(sample.observed); });
    rule.update();
    return rule.fractions()[0];
  };
  // The oracle on defective pdfs; fractions from 40000 samples have a standard error of about .01.
  const phimis::analysis::problem on(f, lost, phimis::interval(0, 1), {0.7},
                                     phimis::analysis::normalisation::defective);
  const auto check = [&](const auto& divergence) {
    const double exact = phimis::analysis::optimum(divergence, on, {}).alpha[0];
    CHECK(std::fabs(learn(divergence, lost) - exact) < 0.05);
    // Whether the integrand ends or the pdf does is the same to the rule where p is the same on f's support.
    CHECK(std::fabs(learn(divergence, present) - learn(divergence, lost)) < 0.05);
  };
  check(phimis::chi_squared{});
  check(phimis::kullback_leibler{});
  check(phimis::pearson_vajda{2});
  check(phimis::multi_sample_variance{});
}

TEST_CASE("V[F] of an integrand that changes sign is that of f, not of its magnitude") {
  const phimis::technique_set two(rising_to{1}, uniform_on{0, 1});
  const phimis::analysis::problem on([](double x) { return x - 0.35; }, two, phimis::interval(0, 1));
  const auto best = phimis::analysis::optimum(phimis::multi_sample_variance{}, on).alpha;
  const auto variance = [&](double a) { return phimis::analysis::variance(on, {{a, 1 - a}}).multi_sample.value; };
  for (double a = 0.01; a < 1; a += 0.01) CHECK(variance(best[0]) <= variance(a) + 1e-15);
  // The rule learns the same from samples; of |f| the optimum is at .4312 in place of .4050.
  const auto learnt = phimis::integrate([](double x) { return x - 0.35; }, two, {.budget = 400000},
                                        phimis::exact_rule(phimis::multi_sample_variance{}));
  CHECK(std::fabs(learnt.fractions[0] - best[0]) < 0.01);
}

TEST_CASE("By default no technique is given up for good") {
  // Only the first technique reaches x < .01, where half of the integral is.
  const phimis::technique_set two(uniform_on{0, 1}, uniform_on{0.01, 1});
  const auto f = [](double x) { return x < 0.01 ? 100 : x; };
  phimis::moments<double> estimates;
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
    estimates.add(phimis::integrate(f, two, {.seed = seed}, phimis::exact_rule(phimis::chi_squared{})).estimate);
  }
  // |z| < 4.5: a false alarm in 1 of 150 000.
  const double z = (estimates.mean - 1.49995) / std::sqrt(estimates.variance() / 2000);
  CHECK(std::fabs(z) < 4.5);
}

TEST_CASE("Where the pdfs are proportional on the sample, fractions stay") {
  phimis::exact_minimiser<phimis::chi_squared, phimis::fixed_table<double, 2, 64>> rule;
  std::mt19937_64 engine(3);
  for (int j = 0; j < 64; ++j) {
    const double x = phimis::uniform(engine());
    rule.observe({1 + x, {{1, 1 / 0.9}}, 0.5 + 0.5 / 0.9, 0});
  }
  CHECK(rule.update() == rule_status::updated);
  CHECK(rule.fractions()[0] == Approx(0.5).epsilon(1e-14));
}

TEST_CASE("One sample an iteration has the spread of all, not none") {
  const phimis::technique_set two(rising_to{1}, uniform_on{0, 1});
  const auto f = [](double x) { return 1 + x * x; };
  phimis::moments<double> estimates, claimed;
  for (std::uint64_t seed = 1; seed <= 4000; ++seed) {
    const auto run =
        phimis::integrate(f, two, {.budget = 25, .iterations = 25, .seed = seed}, phimis::fixed_rule<2>());
    estimates.add(run.estimate);
    claimed.add(run.standard_error * run.standard_error);
  }
  // Not less than the truth, and of its size: the sample variance of 4000 runs is known to 2 %.
  CHECK(claimed.mean > 0.9 * estimates.variance());
  CHECK(claimed.mean < 1.5 * estimates.variance());
  CHECK(phimis::integrate(f, two, {.budget = 1, .iterations = 1}).standard_error ==
        std::numeric_limits<double>::infinity());
}

TEMPLATE_TEST_CASE("Estimates have no scale", "", float, double) {
  const bool single = std::is_same<TestType, float>::value;
  const phimis::fractions<TestType, 2> half{{TestType(0.5), TestType(0.5)}};
  const auto sum = [&](TestType scale) {
    phimis::estimator<TestType, 2> estimator;
    for (int j = 0; j < 20; ++j) {
      const TestType y = scale * static_cast<TestType>(1 + j % 7);
      estimator.add(j % 2, phimis::contribution(phimis::balance{}, j % 2, y, half, {{1, 1}}));
    }
    return estimator;
  };
  using phimis::sampling_model;
  const auto one = sum(1);
  for (const TestType scale :
       {single ? TestType(1e-30) : TestType(1e-300), single ? TestType(1e30) : TestType(1e300)}) {
    const auto scaled = sum(scale);
    CHECK(scaled.effective_sample_size() == Approx(one.effective_sample_size()).epsilon(1e-5));
    CHECK(scaled.standard_error(sampling_model::multi_sample) / scale ==
          Approx(one.standard_error(sampling_model::multi_sample)).epsilon(1e-5));
    auto merged = one;
    merged.merge(scaled);
    CHECK(phimis::is_finite(merged.estimate()));
  }
}

TEST_CASE("A scale of the integrand changes no combination") {
  const phimis::technique_set two(rising_to{1}, uniform_on{0, 1});
  const auto run = [&](double scale, const auto& combination) {
    return phimis::integrate([scale](double x) { return scale * (1 + x * x); }, two, combination);
  };
  for (const double scale : {1e-250, 1e250}) {
    CHECK(run(scale, phimis::inverse_variance{}).estimate / scale ==
          Approx(run(1, phimis::inverse_variance{}).estimate).epsilon(1e-12));
    CHECK(run(scale, phimis::by_count{}).standard_error / scale ==
          Approx(run(1, phimis::by_count{}).standard_error).epsilon(1e-12));
  }
}

TEST_CASE("What a full table refuses does not make a divergence infinite") {
  using rule_type =
      phimis::exact_minimiser<phimis::reversed<phimis::kullback_leibler>, phimis::fixed_table<double, 2, 10>>;
  rule_type rule;
  for (int j = 0; j < 10; ++j) rule.observe({1.0 + j, {{1, 0.5 + 0.1 * j}}, 1, 0});
  rule.observe({0, {{1, 1}}, 1, 0});
  CHECK(rule.counters().dropped == 1);
  CHECK(rule.update() == rule_status::updated);
}

TEST_CASE("A start without a technique, and a prior, is solved and not a NaN") {
  phimis::exact_minimiser<phimis::kullback_leibler, phimis::fixed_table<double, 2, 20>> exact(
      {}, {.start = {0, 1}, .floors = {}, .prior = 5});
  phimis::newton_raphson<phimis::kullback_leibler> newton({}, phimis::newton_form::safeguarded,
                                                          {.start = {0, 1}, .floors = {}, .prior = 5});
  for (int j = 0; j < 20; ++j) {
    const observation<double, 2> sample{2.0 * j + 1, {{2.0 * j + 1, 20}}, 20, 1};
    exact.observe(sample);
    newton.observe(sample);
  }
  CHECK(exact.update() == rule_status::updated);
  CHECK(exact.fractions()[0] >= 0);
  CHECK(exact.fractions()[0] <= 1);
  CHECK(exact.residual() <= 1e-12);
  CHECK(newton.update() == rule_status::updated);
  CHECK(newton.fractions()[0] > 0);
}

TEST_CASE("A rule merged with itself has its observations twice") {
  auto rule = phimis::exact_rule(phimis::chi_squared{});
  for (int j = 0; j < 10; ++j) rule.observe({1.0 + j, {{1, 0.5 + 0.1 * j}}, 1, 0});
  rule.merge(rule);
  CHECK(rule.table().size() == 20);
}

TEST_CASE("Pdfs that are no densities are counted under every weight heuristic") {
  const phimis::fractions<double, 2> half{{0.5, 0.5}};
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), -1.0}) {
    phimis::estimator<double, 2> estimator;
    estimator.add(0, phimis::contribution(phimis::balance{}, 0, 1.0, half, {{bad, 1}}));
    estimator.add(0, phimis::contribution(phimis::power{}, 0, 1.0, half, {{bad, 1}}));
    estimator.add(0, phimis::contribution(phimis::maximum{}, 0, 1.0, half, {{bad, 1}}));
    estimator.add(1, phimis::contribution(phimis::cutoff{}, 1, 1.0, half, {{1, bad}}));
    CHECK(estimator.nonfinite() == 4);
  }
}

TEST_CASE("Combinations may take their arguments by value, and must return weights") {
  const phimis::technique_set two(rising_to{1}, uniform_on{0, 1});
  const auto f = [](double x) { return 1 + x; };
  const auto equal = [](auto iterations, auto weights) {
    for (std::size_t b = 0; b < iterations.size(); ++b) weights[b] = 1;
  };
  CHECK(phimis::is_finite(phimis::integrate(f, two, equal).estimate));
  const auto nothing = [](auto, auto) {};
  CHECK_THROWS_AS(phimis::integrate(f, two, nothing), std::invalid_argument);
}

// What the fuzzers of tests/fuzz found.

TEMPLATE_TEST_CASE("The unit of costs changes no fraction, with a prior neither", "", float, double) {
  const phimis::per_technique<TestType, 3> costs{{TestType(2.5), 1, 2}};
  const auto learn = [&](auto make, TestType unit) {
    rule_options<TestType, 3> options;
    options.start = {{TestType(0.75), TestType(0.125), TestType(0.125)}};
    options.prior = 2;
    for (int k = 0; k < 3; ++k) options.costs[k] = costs[k] * unit;
    auto rule = make(options);
    for (int j = 0; j < 30; ++j) {
      const TestType x = (static_cast<TestType>(j) + TestType(0.5)) / 30;
      rule.observe({1 + x * x, {{1, 2 * x, 2 - 2 * x}}, 1, j % 3});
    }
    CHECK(rule.update() == rule_status::updated);
    return rule.fractions();
  };
  const auto compare = [&](auto make) {
    const auto one = learn(make, 1);
    // Powers of two, near the ends of the range: no rounding.
    for (const int exponent : {sizeof(TestType) == 4 ? -120 : -1000, sizeof(TestType) == 4 ? 120 : 1000}) {
      const auto other = learn(make, std::ldexp(TestType(1), exponent));
      for (int k = 0; k < 3; ++k) CHECK(other[k] == Approx(one[k]).epsilon(1e-5));
    }
  };
  using options = rule_options<TestType, 3>;
  compare([](const options& given) { return phimis::exact_rule<3>(phimis::hellinger{}, given); });
  compare([](const options& given) { return phimis::exact_rule<3>(phimis::chi_squared{}, given); });
  compare([](const options& given) { return phimis::sigma_rule<3>(given); });
  compare([](const options& given) { return phimis::inverse_variance_rule<3>(given); });
  compare([](const options& given) { return phimis::second_order_rule<3>(given); });
}

TEST_CASE("A prior of 1e300 samples is the start, under any costs") {
  rule_options<double, 3> options;
  options.start = {{0.5, 0.25, 0.25}};
  options.prior = 1e300;
  options.costs = {{1e-6, 1, 1e6}};
  auto rule = phimis::sigma_rule<3>(options);
  for (int j = 0; j < 6; ++j) rule.observe({1.0 + j, {{1, 2, 3}}, 2, j % 3});
  CHECK(rule.update() == rule_status::updated);
  for (int k = 0; k < 3; ++k) CHECK(rule.fractions()[k] == Approx(options.start[k]).epsilon(0.02));
}

TEST_CASE("Where a technique has no scale among the rows the fractions stay, and the status says so") {
  if (subnormals_are_zero()) return;  // the technique has no density then, which is another case
  // The control variate divides by Σ p_k/q, whose inverse is no number.
  const double least = 4 * std::numeric_limits<double>::denorm_min();
  const Eigen::VectorXd f{{1, 2}};
  const Eigen::VectorXd q{{1, 1}};
  const Eigen::MatrixXd two{{1, least}, {2, least}};
  const Eigen::MatrixXd three{{1, 1, least}, {2, 1, least}};
  const auto check = [&](const Eigen::MatrixXd& pdfs) {
    const phimis::minimum found = phimis::minimise(phimis::chi_squared{}, f, pdfs, q);
    CHECK(found.status == rule_status::not_converged);
    for (const double fraction : found.fractions) CHECK(fraction == 1.0 / static_cast<double>(pdfs.cols()));
  };
  check(two);
  check(three);
  phimis::exact_minimiser<phimis::chi_squared, phimis::fixed_table<double, 2, 4>> pair;
  pair.observe({1, {{1, least}}, 1, 0});
  pair.observe({2, {{2, least}}, 1, 0});
  CHECK(pair.update() == rule_status::not_converged);
  CHECK(pair.fractions()[0] == 0.5);
  CHECK(pair.fractions()[1] == 0.5);
}

TEST_CASE("The search for the price of a variance ends, however large the prior") {
  rule_options<double, 2> options;
  options.start = {{1e-280, 1}};
  options.floors = {{2e-78, 0.25}};
  options.prior = 5e303;
  options.costs = {{1, 0.015625}};
  auto rule = phimis::exact_rule(phimis::one_sample_variance{}, options);
  rule.observe({0.078125, {{1e-4, 0.5}}, 0.09375, 1});
  rule.update();
  CHECK(rule.fractions()[0] >= options.floors[0]);
  CHECK(rule.fractions()[0] + rule.fractions()[1] == Approx(1));
}

TEST_CASE("A row exactly at a kink of infinite slope does not hide the prior") {
  // One row, normalised: g/p = 1 at every mixture, and only the prior has a minimum, at the start.
  phimis::exact_minimiser<phimis::reversed<phimis::pearson_vajda>, phimis::fixed_table<double, 2, 4>> rule(
      {{1.5}}, {.start = {{0.9, 0.1}}, .prior = 1});
  rule.observe({0.078125, {{1.25, 2}}, 0.25, 0});
  rule.update();
  CHECK(rule.fractions()[0] == Approx(0.9).epsilon(1e-6));
}

TEMPLATE_TEST_CASE("A score far from its kink is flat, in whatever order a compiler multiplies", "", float, double) {
  // With -ffast-math t² φ'' was ∞ · 0 where a start reaches no row, and total variation then stayed there.
  const auto t = static_cast<TestType>(sizeof(TestType) == 8 ? 1e300 : 1e36);
  const auto far = phimis::score_at(phimis::round_off(phimis::total_variation{}, 1e-3), t);
  CHECK(far.value == TestType(0.5));
  CHECK((far.slope >= 0 && far.slope < TestType(1e-6)));
  const auto order_one = phimis::score_at(phimis::round_off(phimis::pearson_vajda{1}, 1e-3), t);
  CHECK(order_one.value == Approx(1));
  CHECK((order_one.slope >= 0 && order_one.slope < TestType(1e-6)));
}

TEST_CASE("A subnormal floor under a prior is kept by the update after, too") {
  // π/α overflowed there, and the second update ended above where it began.
  if (subnormals_are_zero()) return;
  rule_options<double, 3> options;
  options.start = {{0.3, 0.3, 0.4}};
  options.floors = {{7.5e-310, 0.02, 0}};
  options.prior = 1e-300;
  options.costs = {{1, 0.5, 0.1}};
  auto rule = phimis::exact_rule<3>(phimis::tsallis{0.1}, options);
  rule.observe({0.015625, {{0.015625, 0.015625, 0.015625}}, 0.015625, 2});
  for (int update = 0; update < 2; ++update) {
    CHECK(rule.update() == rule_status::updated);
    CHECK(rule.fractions()[1] == 0.02);
    CHECK(rule.fractions()[2] == Approx(0.98));
  }
}

TEST_CASE("Floors and frozen techniques that sum past one by more than fractions may are refused, whatever the sum's rounding") {
  rule_options<float, 3> options;
  options.start = {{0, 0.010204081423580647F, 0.98979592323303223F}};
  options.frozen = {{false, true, true}};
  // 12 ε and 12.08 ε: summed in float the same.
  options.floors = {{1.425e-06F, 0, 0}};
  CHECK_NOTHROW(phimis::exact_rule<3>(phimis::tsallis{1}, options));
  options.floors = {{1.4354205e-06F, 0, 0}};
  CHECK_THROWS(phimis::exact_rule<3>(phimis::tsallis{1}, options));
}

TEST_CASE("A subnormal floor is kept where pdfs of 1e156 are normalised") {
  // The fraction times κ = 1e-156 vanished.
  if (subnormals_are_zero()) return;
  const auto check = [](const auto& divergence) {
    for (const auto variate : {control_variate::on, control_variate::off}) {
      rule_options<double, 2> options;
      options.start = {{1, 8e-295}};
      options.floors = {{0.25, 1.9e-312}};
      options.prior = 1.0 / 64;
      auto rule = phimis::exact_rule<2>(divergence, options, variate);
      rule.observe({0.140625, {{0.09375, 0.015625}}, 3.5e-158, 1});
      rule.observe({1.5, {{1, 0.015625}}, 0.5, 0});
      rule.observe({0.109375, {{0.015625, 0.015625}}, 0.015625, 0});
      rule.update();
      CHECK(rule.fractions()[0] >= options.floors[0]);
      CHECK(rule.fractions()[1] >= options.floors[1]);
      CHECK(rule.fractions()[0] + rule.fractions()[1] == 1);
    }
  };
  check(phimis::one_sample_variance{});
  check(phimis::multi_sample_variance{});
  check(phimis::total_variation{});
  check(phimis::kullback_leibler{});
  check(phimis::reversed<phimis::kullback_leibler>{});
  check(phimis::pearson_vajda{1.5});
}

TEST_CASE("Of f so small that its mean has no inverse, fractions stay, and the status says so") {
  if (subnormals_are_zero()) return;
  rule_options<double, 2> two;
  two.start = {{0.99, 0.01}};
  two.floors = {{0.01, 0.01}};
  two.prior = 1;
  auto pair = phimis::exact_rule(phimis::pearson_vajda{1.5}, two);
  pair.observe({2.5e-321, {{0.015625, 1}}, 0.015625, 1});
  CHECK(pair.update() == rule_status::not_converged);
  CHECK(pair.fractions()[0] == 0.99);
  auto three = phimis::exact_rule<3>(phimis::pearson_vajda{1.5}, {.prior = 1});
  three.observe({2.5e-321, {{0.015625, 1, 1}}, 0.015625, 1});
  CHECK(three.update() == rule_status::not_converged);
  CHECK(three.fractions()[0] == Approx(1.0 / 3));
}

TEST_CASE("Where the unit of f is no number of the table, fractions stay, and the status says so") {
  if (subnormals_are_zero()) return;
  const auto check = [](auto rule) {
    for (int j = 0; j < 300; ++j) {
      const float x = (static_cast<float>(j) + 0.5f) / 300;
      const float z = (x - 0.77f) / 0.003f;
      observation<float, decltype(rule)::techniques> sample{2e-37f * (std::exp(-z * z) + 1e-4f), {}, 1, 0};
      for (int k = 0; k < decltype(rule)::techniques; ++k) sample.pdfs[k] = k == 0 ? 2 * x : k == 1 ? 2 - 2 * x : 1;
      rule.observe(sample);
    }
    const auto before = rule.fractions();
    CHECK(rule.update() == rule_status::not_converged);
    for (int k = 0; k < decltype(rule)::techniques; ++k) CHECK(rule.fractions()[k] == before[k]);
  };
  const auto with = [&](const auto& divergence) {
    using divergence_type = std::decay_t<decltype(divergence)>;
    check(phimis::exact_minimiser<divergence_type, phimis::fixed_table<float, 2, 300>>(divergence));
    check(phimis::exact_minimiser<divergence_type, phimis::fixed_table<float, 3, 300>>(divergence));
  };
  with(phimis::total_variation{});
  with(phimis::pearson_vajda{3});
}

TEST_CASE("Where one sample weighs 1e281 proportional pdfs stay under a prior: no power of f/p overflows") {
  for (const double q : {3e-282, 1e-200, 1e-100, 1.0, 1e100}) {
    for (const double gamma : {0.5, 2.0, 3.0}) {
      rule_options<double, 2> options{.start = {{0.5, 0.5}}, .floors = {}};
      options.prior = 1.0 / 64;
      phimis::exact_minimiser<phimis::tsallis, phimis::fixed_table<double, 2, 4>> rule({gamma}, options);
      rule.observe({1, {{1.4375, 0.09375}}, q, 0});
      CAPTURE(q, gamma);
      CHECK(rule.update() == rule_status::updated);
      CHECK(std::fabs(rule.fractions()[0] - 0.5) < 1e-13);
    }
  }
}

TEMPLATE_TEST_CASE(
    "Where one sample weighs so much, or so little, that powers overflow for a prior, the prior decides", "", float,
    double) {
  // The row is worth w u²/x, or its like in other powers, beside prior · mean²: 1e-16 of it at most. Compilers that multiply
  // in any order want squares in range, too.
#ifdef __FAST_MATH__
  const double most = std::sqrt(double{std::numeric_limits<TestType>::max()});
#else
  const double most = double{std::numeric_limits<TestType>::max()};
#endif
  const auto with = [most](const auto& divergence, auto techniques) {
    constexpr int M = decltype(techniques)::value;
    using Divergence = std::decay_t<decltype(divergence)>;
    for (const double size : {1e18, 1e30, 1e60, 1e150, 1e303}) {
      if (size > most) continue;
      const double weight = phimis::score_at(divergence, 2.0).value > 0 ? size : 1 / size;  // of f/q, or of q/f
      for (const bool small_q : {false, true}) {
        rule_options<TestType, M> options{};
        options.start = {{TestType(0.75), TestType(0.25)}};
        if constexpr (M == 3) options.start = {{TestType(0.75), TestType(0.1875), TestType(0.0625)}};
        options.floors = {};
        options.prior = TestType(1) / 64;
        phimis::exact_minimiser<Divergence, phimis::fixed_table<TestType, M, 4>> rule(divergence, options,
                                                                                      control_variate::off);
        observation<TestType, M> sample{};
        sample.f = 1;
        sample.q = TestType(small_q ? 1 / weight : 1);
        for (int k = 0; k < M; ++k) sample.pdfs[k] = TestType(small_q ? k + 1 : weight / (k + 1));
        rule.observe(sample);
        CAPTURE(M, size, small_q);
        CHECK(rule.update() == rule_status::updated);
        for (int k = 0; k < M; ++k) {
          CHECK(std::fabs(rule.fractions()[k] - options.start[k]) < 16 * std::numeric_limits<TestType>::epsilon());
        }
      }
    }
  };
  const auto with_each = [&](const auto& divergence) {
    with(divergence, std::integral_constant<int, 2>());
    with(divergence, std::integral_constant<int, 3>());
  };
  with_each(phimis::one_sample_variance{});
  with_each(phimis::tsallis{2});
  with_each(phimis::tsallis{8});
  with_each(phimis::reversed<phimis::tsallis>{{3}});
}

TEST_CASE("A prior of 1.8e308 overflows no sum: it decides as one of 1e300 does") {
  // 7 samples change the fractions by 1e-299 of themselves; cost times variance has its minimum elsewhere than at the start.
  const auto with = [](const auto& divergence, auto techniques, double cost) {
    constexpr int M = decltype(techniques)::value;
    using Divergence = std::decay_t<decltype(divergence)>;
    phimis::fractions<double, M> learnt[2];
    rule_status status[2];
    for (const int huge : {0, 1}) {
      rule_options<double, M> options{};
      for (int k = 0; k < M; ++k) options.start[k] = (k + 1) / (M * (M + 1) / 2.0);
      options.floors = {};
      options.costs[1] = cost;
      options.prior = huge == 1 ? std::numeric_limits<double>::max() : 1e300;
      phimis::exact_minimiser<Divergence, phimis::fixed_table<double, M, 8>> rule(divergence, options,
                                                                                  control_variate::off);
      for (int j = 0; j < 7; ++j) {
        observation<double, M> sample{};
        sample.f = 0.25 + 0.5 * j;
        sample.q = 0.5 + 0.125 * j;
        for (int k = 0; k < M; ++k) sample.pdfs[k] = 1 + (j * (k + 2)) % 5;
        rule.observe(sample);
      }
      status[huge] = rule.update();
      learnt[huge] = rule.fractions();
      for (int k = 0; k < M && cost == 1; ++k) {
        CHECK(std::fabs(rule.fractions()[k] - options.start[k]) < 8 * std::numeric_limits<double>::epsilon());
      }
    }
    CAPTURE(M, cost);
    CHECK(status[0] == status[1]);
    // Sums of other sizes are rounded elsewhere.
    for (int k = 0; k < M; ++k) CHECK(std::fabs(learnt[1][k] - learnt[0][k]) < 1e-12);
  };
  const auto with_each = [&](const auto& divergence, double cost) {
    with(divergence, std::integral_constant<int, 2>(), cost);
    with(divergence, std::integral_constant<int, 3>(), cost);
  };
  with_each(phimis::tsallis{0.01}, 1);
  with_each(phimis::tsallis{0.5}, 1);
  with_each(phimis::tsallis{3}, 1);
  with_each(phimis::pearson_vajda{1.5}, 1);
  with_each(phimis::reversed<phimis::pearson_vajda>{{1.5}}, 1);
  with_each(phimis::one_sample_variance{}, 1);
  with_each(phimis::one_sample_variance{}, 3);
  with_each(phimis::multi_sample_variance{}, 1);
  with_each(phimis::multi_sample_variance{}, 3);
}
