// SPDX-License-Identifier: MIT
// integrate.hpp, batch.hpp
#include "catch.hpp"
#include "colour.hpp"
#include "random.hpp"

#include <phimis/phimis.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <vector>

namespace {

using phimis::integrate_options;
using phimis::sampling_model;

struct falling {
  double pdf(double x) const { return x < 0 || x > 1 ? 0 : 2 * (1 - x); }
  template <phimis::uniform_source Next>
  double sample(Next&& next) const {
    return 1 - std::sqrt(1 - next());
  }
};
struct rising {
  double pdf(double x) const { return x < 0 || x > 1 ? 0 : 2 * x; }
  template <phimis::uniform_source Next>
  double sample(Next&& next) const {
    return std::sqrt(next());
  }
};
struct flat {
  double pdf(double x) const { return x < 0 || x > 1 ? 0 : 1; }
  template <phimis::uniform_source Next>
  double sample(Next&& next) const {
    return next();
  }
};
struct part {
  double lower, upper;
  double pdf(double x) const { return x < lower || x >= upper ? 0 : 1 / (upper - lower); }
  template <phimis::uniform_source Next>
  double sample(Next&& next) const {
    return lower + (upper - lower) * next();
  }
};
const phimis::technique_set two(falling{}, rising{});
const phimis::technique_set three(falling{}, rising{}, flat{});

double f(double x) { return 0.5 + x * x; }
constexpr double mu = 0.5 + 1.0 / 3;

auto source(std::uint64_t seed) {
  return [random = random_numbers(seed)]() mutable { return random(); };
}

/// What tells two runs apart.
template <class Run>
std::vector<double> digest(const Run& run) {
  std::vector<double> numbers{run.estimate, run.standard_error, run.effective_sample_size};
  for (const double a : run.fractions) numbers.push_back(a);
  for (const auto& line : run.trace) numbers.push_back(line.combined_estimate);
  return numbers;
}

}  // namespace

TEST_CASE("The defaults integrate, and know how well") {
  const auto run = phimis::integrate(f, two);
  CHECK(run.samples == 500);
  CHECK(run.trace.size() == 5);
  CHECK(run.status == phimis::integration_status::complete);
  CHECK(std::fabs(run.estimate - mu) <= 5 * run.standard_error);
  CHECK(run.standard_error > 0);
  CHECK(run.standard_error < 0.05);
  CHECK(run.effective_sample_size > 250);
  CHECK(run.effective_sample_size <= 500);
  for (const double a : run.fractions) CHECK(a >= 0.01);
}

TEST_CASE("By default iterations grow and later ones count more, where something is learnt") {
  const auto run = phimis::integrate(f, two);
  const auto rule = phimis::exact_rule<2>(phimis::chi_squared{}, {.prior = 1});
  CHECK(digest(run) == digest(phimis::integrate(f, two, {.growth = 16}, rule, phimis::square_root{})));
  CHECK(run.trace.front().samples == 18);
  CHECK(run.trace.back().samples == 254);
  const auto fixed = phimis::fixed_rule<2>();
  CHECK(digest(phimis::integrate(f, two, fixed)) == digest(phimis::integrate(f, two, fixed, phimis::by_count{})));
}

TEST_CASE("Two iterations are two batches, two updates and one mean") {
  // The same by hand, from the same uniform numbers.
  const integrate_options options{.budget = 61, .iterations = 2, .growth = 1};
  auto rule = phimis::newton_rule(phimis::kullback_leibler{});
  auto next = source(1);
  const auto run = phimis::integrate(f, two, options, rule, next, phimis::by_count{});

  random_numbers random(1);
  double alpha = 0.5, sum = 0, total = 0;
  for (const int n : {31, 30}) {
    const auto counts = phimis::split_largest_remainder<double, 2>({{alpha, 1 - alpha}}, n);
    const double first = static_cast<double>(counts[0]) / n;
    double batch = 0;
    for (int k = 0; k < 2; ++k) {
      for (int j = 0; j < counts[k]; ++j) {
        const double x = k == 0 ? 1 - std::sqrt(1 - random()) : std::sqrt(random());
        const double p = first * 2 * (1 - x) + (1 - first) * 2 * x;
        batch += f(x) / p;
        rule.observe({f(x), {{2 * (1 - x), 2 * x}}, p, k});
      }
    }
    CHECK(run.trace[n == 31 ? 0 : 1].estimate == Approx(batch / n).epsilon(1e-13));
    CHECK(run.trace[n == 31 ? 0 : 1].counts[0] == counts[0]);
    sum += batch;
    total += n;
    rule.update();
    alpha = rule.fractions()[0];
  }
  CHECK(run.estimate == Approx(sum / total).epsilon(1e-13));
  CHECK(run.fractions[0] == Approx(alpha).epsilon(1e-13));
  CHECK(alpha != 0.5);
}

TEST_CASE("Policies follow in any order") {
  const integrate_options options{.budget = 200, .iterations = 4};
  const auto rule = phimis::exact_rule(phimis::hellinger{});
  const phimis::power weights{1.5};
  const phimis::inverse_variance combination;
  int calls = 0;
  const auto callback = [&calls](const auto& line) { calls += line.index + 1; };
  auto a = source(2), b = source(2), c = source(2), d = source(2);
  const auto wanted = digest(phimis::integrate(f, two, options, rule, weights, combination, a, callback));
  CHECK(digest(phimis::integrate(f, two, options, callback, b, combination, weights, rule)) == wanted);
  CHECK(digest(phimis::integrate(f, two, options, combination, rule, c, callback, weights)) == wanted);
  // Temporaries and moved values as well.
  CHECK(digest(phimis::integrate(f, two, options, phimis::inverse_variance{}, phimis::power{1.5},
                                 phimis::exact_rule(phimis::hellinger{}), d)) == wanted);
  CHECK(calls == 3 * (1 + 2 + 3 + 4));
  // Each policy matters.
  auto e = source(2), g = source(2), h = source(2);
  CHECK(digest(phimis::integrate(f, two, options, rule, weights, e)) != wanted);
  CHECK(digest(phimis::integrate(f, two, options, rule, combination, g)) != wanted);
  CHECK(digest(phimis::integrate(f, two, options, weights, combination, h)) != wanted);
}

TEST_CASE("A run is the same for the same seed and another for another") {
  for (const auto model : {sampling_model::multi_sample, sampling_model::one_sample}) {
    const integrate_options options{.budget = 100, .iterations = 3, .model = model, .seed = 7};
    auto other = options;
    other.seed = 8;
    CHECK(digest(phimis::integrate(f, two, options)) == digest(phimis::integrate(f, two, options)));
    CHECK(digest(phimis::integrate(f, two, options)) != digest(phimis::integrate(f, two, other)));
  }
}

TEST_CASE("Uniform numbers are taken by reference") {
  struct counting {
    random_numbers random{3};
    int taken = 0;
    double operator()() {
      ++taken;
      return random();
    }
  } next;
  phimis::integrate(f, two, {.budget = 40, .iterations = 2}, next);
  CHECK(next.taken == 40);  // one a sample
  phimis::integrate(f, two, {.budget = 40, .iterations = 2, .model = sampling_model::one_sample}, next);
  CHECK(next.taken == 40 + 80);  // and one for its technique
  phimis::integrate(f, two, {.budget = 40, .iterations = 2, .rounding = phimis::rounding::systematic}, next);
  CHECK(next.taken == 120 + 42);  // and one for the counts of an iteration
}

TEST_CASE("A callback sees every iteration and may stop the run") {
  std::vector<int> seen;
  const auto stop_at = [&seen](int last) {
    return [&seen, last](const auto& line) {
      seen.push_back(line.index);
      return line.index == last ? phimis::progress::stop : phimis::progress::go_on;
    };
  };
  const integrate_options options{.budget = 50, .iterations = 5, .growth = 1};
  const auto stopped = phimis::integrate(f, two, options, stop_at(1));
  CHECK(stopped.status == phimis::integration_status::stopped);
  CHECK(stopped.samples == 20);
  CHECK(stopped.trace.size() == 2);
  CHECK(seen == std::vector<int>{0, 1});
  CHECK(stopped.estimate == stopped.trace.back().combined_estimate);
  const auto complete = phimis::integrate(f, two, options, stop_at(4));
  CHECK(complete.status == phimis::integration_status::complete);
  CHECK(complete.samples == 50);
}

TEST_CASE("The trace adds up, also where the budget does not divide") {
  const auto g = [](double x) { return x < 0.3 ? 0 : x > 0.95 ? std::numeric_limits<double>::quiet_NaN() : f(x); };
  for (const auto model : {sampling_model::multi_sample, sampling_model::one_sample}) {
    const auto run = phimis::integrate(g, three, {.budget = 503, .iterations = 7, .growth = 1, .model = model},
                                       phimis::by_count{});
    REQUIRE(run.trace.size() == 7);
    std::int64_t samples = 0, zero = 0, nonfinite = 0;
    double spent = 0, weighted = 0, variance = 0;
    for (std::size_t b = 0; b < 7; ++b) {
      const auto& line = run.trace[b];
      CHECK(line.index == static_cast<int>(b));
      CHECK(line.samples == (b < 6 ? 72 : 71));
      CHECK(line.counts[0] + line.counts[1] + line.counts[2] == line.samples);
      samples += line.samples;
      zero += line.zero;
      nonfinite += line.nonfinite;
      const double n = static_cast<double>(line.samples);
      spent += n * n / line.effective_sample_size;
      weighted += line.estimate * n;
      variance += line.standard_error * line.standard_error * n * n;
      // What is combined so far.
      CHECK(line.combined_estimate == Approx(weighted / static_cast<double>(samples)).epsilon(1e-13));
      CHECK(line.combined_standard_error == Approx(std::sqrt(variance) / static_cast<double>(samples)).epsilon(1e-13));
    }
    CHECK(run.samples == 503);
    CHECK(samples == 503);
    CHECK(run.zero == zero);
    CHECK(zero > 50);
    CHECK(run.nonfinite == nonfinite);
    CHECK(nonfinite > 5);
    CHECK(run.rule.counters().observations == 503);
    CHECK(run.rule.counters().nonfinite == nonfinite);
    CHECK(run.rule.counters().zero == zero);
    CHECK(run.effective_sample_size == Approx(503.0 * 503.0 / spent).epsilon(1e-13));
    CHECK(run.estimate == run.trace.back().combined_estimate);
    CHECK(run.standard_error == run.trace.back().combined_standard_error);
  }
}

TEST_CASE("An iteration's fractions are those of the rule after the one before") {
  const auto run = phimis::integrate(f, two, {.budget = 200, .iterations = 4}, phimis::exact_rule(phimis::kullback_leibler{}));
  auto rule = phimis::exact_rule(phimis::kullback_leibler{});
  CHECK(run.trace[0].fractions[0] == 0.5);
  for (const auto& line : run.trace) {
    CHECK(line.status == phimis::rule_status::updated);
    CHECK(line.fractions[0] + line.fractions[1] == Approx(1).epsilon(1e-15));
  }
  CHECK(run.trace[1].fractions[0] != 0.5);
  CHECK(run.fractions[0] == run.rule.fractions()[0]);
  CHECK(run.rule.table().size() == 200);
}

TEST_CASE("A run continues from the rule of another") {
  const integrate_options options{.budget = 100, .iterations = 2};
  const auto first = phimis::integrate(f, two, options, phimis::exact_rule(phimis::kullback_leibler{}));
  const auto second = phimis::integrate(f, two, options, first.rule);
  CHECK(second.trace[0].fractions[0] == first.fractions[0]);
  CHECK(second.rule.counters().observations == 200);
}

TEST_CASE("NaN values of the integrand are counted and enter as zero") {
  const auto broken = [](double x) { return x < 0.1 ? std::numeric_limits<double>::quiet_NaN() : f(x); };
  const auto infinite = [](double x) { return x < 0.1 ? std::numeric_limits<double>::infinity() : f(x); };
  const auto zero = [](double x) { return x < 0.1 ? 0.0 : f(x); };
  const integrate_options options{.budget = 300, .iterations = 3};
  const auto wanted = phimis::integrate(zero, two, options, phimis::fixed_rule<2>());
  for (const auto& run : {phimis::integrate(broken, two, options, phimis::fixed_rule<2>()),
                          phimis::integrate(infinite, two, options, phimis::fixed_rule<2>())}) {
    CHECK(run.estimate == wanted.estimate);
    CHECK(run.standard_error == wanted.standard_error);
    CHECK(run.nonfinite == wanted.zero);
    CHECK(run.nonfinite > 0);
    CHECK(run.zero == 0);
  }
}

TEST_CASE("A run of zeros says that it has seen nothing") {
  const auto zero = [](double) { return 0.0; };
  const auto run = phimis::integrate(zero, two, {.budget = 100, .iterations = 4}, phimis::inverse_variance{});
  CHECK(run.status == phimis::integration_status::all_zero);
  CHECK(run.estimate == 0);
  CHECK(run.standard_error == std::numeric_limits<double>::infinity());
  CHECK(run.effective_sample_size == 0);
  CHECK(run.zero == 100);
  for (const double a : run.fractions) CHECK(a == 0.5);
  for (const auto& line : run.trace) CHECK(line.status == phimis::rule_status::no_information);
  const auto all_nan = [](double) { return std::numeric_limits<double>::quiet_NaN(); };
  CHECK(phimis::integrate(all_nan, two).status == phimis::integration_status::all_zero);
}

TEST_CASE("Techniques without a fraction need no sample: counts are decided where those with one have theirs") {
  auto next = source(3);
  const auto draw = [&](std::int64_t samples) {
    return phimis::draw_batch(f, three, phimis::fractions<double, 3>{{0.5, 0.5, 0}}, {.samples = samples},
                              phimis::balance{}, next, [](const auto&) {});
  };
  const auto two_samples = draw(2);
  CHECK(two_samples.variance == sampling_model::multi_sample);
  CHECK(two_samples.counts[0] == 1);
  CHECK(two_samples.counts[1] == 1);
  CHECK(two_samples.counts[2] == 0);
  CHECK(draw(1).variance == sampling_model::one_sample);
}

TEST_CASE("An integrand that changes sign is learnt by its magnitude and estimated with its sign") {
  const auto plus = phimis::integrate(f, two);
  const auto minus = phimis::integrate([](double x) { return -f(x); }, two);
  CHECK(minus.estimate == -plus.estimate);
  CHECK(minus.standard_error == plus.standard_error);
  CHECK(minus.fractions[0] == plus.fractions[0]);
  // ∫ (x − ½)³ dx = 0, by 20000 samples: |z| < 5, false alarm 6e-7.
  const auto odd = phimis::integrate([](double x) { return (x - 0.5) * (x - 0.5) * (x - 0.5); }, two, {.budget = 20000});
  CHECK(std::fabs(odd.estimate) <= 5 * odd.standard_error);
  CHECK(odd.fractions[0] == Approx(0.5).epsilon(0.2));  // |f| is symmetric
}

TEST_CASE("A mixture without variance is learnt from one batch and integrated exactly from then on") {
  const auto mix = [](double x) { return 3 * (0.25 * 2 * (1 - x) + 0.75 * 2 * x); };
  const auto run = phimis::integrate(mix, two, {.budget = 100, .iterations = 5, .rounding = phimis::rounding::systematic},
                                     phimis::exact_rule(phimis::chi_squared{}), phimis::inverse_variance{});
  CHECK(run.trace[1].fractions[0] == Approx(0.25).epsilon(1e-12));
  CHECK(run.trace[4].estimate == Approx(3).epsilon(1e-12));
  CHECK(run.trace[4].standard_error <= 1e-11);
  CHECK(run.estimate == Approx(3).epsilon(1e-12));
}

TEST_CASE("A colour is integrated by component and learnt by its luminance") {
  const auto tint = [](double x) { return colour<double>{{f(x), 2 * x, 1 - x}}; };
  const integrate_options options{.budget = 400, .iterations = 4};
  const auto run = phimis::integrate(tint, two, options);
  const double wanted[3] = {mu, 1, 0.5};
  for (int i = 0; i < 3; ++i) {
    CHECK(run.standard_error[i] > 0);
    CHECK(std::fabs(run.estimate[i] - wanted[i]) <= 5 * run.standard_error[i]);
  }
  const auto grey = phimis::integrate([&](double x) { return phimis::value_traits<colour<double>>::magnitude(tint(x)); }, two,
                                      options);
  CHECK(run.fractions[0] == Approx(grey.fractions[0]).epsilon(1e-12));
  CHECK(run.effective_sample_size == Approx(grey.effective_sample_size).epsilon(1e-12));
  // With fixed fractions each component is its own integral.
  const auto red = phimis::integrate(f, two, options, phimis::fixed_rule<2>());
  const auto fixed = phimis::integrate(tint, two, options, phimis::fixed_rule<2>());
  CHECK(fixed.estimate[0] == Approx(red.estimate).epsilon(1e-14));
  CHECK(fixed.standard_error[0] == Approx(red.standard_error).epsilon(1e-12));
}

TEST_CASE("Pooled is one batch of the aggregate mixture") {
  const integrate_options options{.budget = 90, .iterations = 3};
  auto next = source(4);
  const auto run = phimis::integrate(f, two, options, phimis::pooled{}, next);
  random_numbers random(4);
  std::vector<double> xs;
  double share = 0;
  for (const auto& line : run.trace) {
    share += static_cast<double>(line.counts[0]) / 90;
    for (int k = 0; k < 2; ++k) {
      for (int j = 0; j < line.counts[k]; ++j) xs.push_back(k == 0 ? 1 - std::sqrt(1 - random()) : std::sqrt(random()));
    }
  }
  REQUIRE(xs.size() == 90);
  double sum = 0, squares = 0;
  for (const double x : xs) {
    const double y = f(x) / (share * 2 * (1 - x) + (1 - share) * 2 * x);
    sum += y;
    squares += y * y;
  }
  CHECK(run.estimate == Approx(sum / 90).epsilon(1e-13));
  CHECK(run.effective_sample_size == Approx(sum * sum / squares).epsilon(1e-12));
  CHECK(run.standard_error > 0);
}

namespace {

/// z-score of the mean of many runs against the exact integral, and the mean of their variances over the variance of
/// their estimates.
struct verdict {
  double z, honesty;
};
template <class Techniques, class... Policies>
verdict repeat(const Techniques& techniques, integrate_options options, int runs, Policies... policies) {
  phimis::moments<double> estimates, variances;
  random_numbers random(options.seed);
  const auto next = [&random] { return random(); };
  for (int i = 0; i < runs; ++i) {
    const auto run = phimis::integrate(f, techniques, options, next, policies...);
    estimates.add(run.estimate);
    variances.add(run.standard_error * run.standard_error);
  }
  return {(estimates.mean - mu) / std::sqrt(estimates.variance() / runs), variances.mean / estimates.variance()};
}

}  // namespace

TEST_CASE("Estimates are unbiased however counts are made, and standard errors honest") {
  // |z| < 5: false alarm 6e-7 each. The variance of 4000 estimates is known to √(2/4000) = 2.2 %: 5 of them.
  const integrate_options plain{.budget = 24, .iterations = 2, .growth = 1, .seed = 1};
  auto one_sample = plain;
  one_sample.model = sampling_model::one_sample;
  auto systematic = plain;
  systematic.rounding = phimis::rounding::systematic;
  const auto uneven = phimis::fixed_rule<3>({.start = {{0.55, 0.31, 0.14}}});
  for (const auto& options : {plain, one_sample}) {
    const verdict fixed = repeat(three, options, 4000, uneven);
    CHECK(std::fabs(fixed.z) < 5);
    CHECK(std::fabs(fixed.honesty - 1) < 0.11);
    CHECK(std::fabs(repeat(three, options, 4000, uneven, phimis::power{}).z) < 5);
    CHECK(std::fabs(repeat(three, options, 4000, uneven, phimis::maximum{}).z) < 5);
    CHECK(std::fabs(repeat(three, options, 4000, uneven, phimis::cutoff{0.4}).z) < 5);
    CHECK(std::fabs(repeat(two, options, 4000).z) < 5);
    CHECK(std::fabs(repeat(two, options, 4000, phimis::square_root{}).z) < 5);
    CHECK(std::fabs(repeat(two, options, 4000, phimis::newton_rule(phimis::kullback_leibler{}, phimis::newton_form::safeguarded,
                                                                   {.floors = {{0.05, 0.05}}})).z) < 5);
  }
  const verdict rounded = repeat(three, systematic, 4000, uneven);
  CHECK(std::fabs(rounded.z) < 5);
  CHECK(rounded.honesty > 0.89);  // reported as of one-sample counts: not less than it is
}

TEST_CASE("A budget smaller than the number of techniques is unbiased") {
  // One or two samples an iteration for three techniques. |z| < 5: false alarm 6e-7 each.
  // Each technique alone reaches its part of f: none may be left out for good.
  const phimis::technique_set parts(part{0, 0.2}, part{0.2, 0.6}, part{0.6, 1});
  const auto uneven = phimis::fixed_rule<3>({.start = {{0.55, 0.31, 0.14}}});
  for (const std::int64_t budget : {4, 8}) {
    const integrate_options few{.budget = budget, .iterations = 4, .seed = 2};
    CHECK(std::fabs(repeat(three, few, 8000, uneven).z) < 5);
    CHECK(std::fabs(repeat(parts, few, 8000, uneven).z) < 5);
  }
}

TEST_CASE("One technique, or a fraction of 0, is plain importance sampling") {
  const phimis::technique_set alone(rising{});
  const auto run = phimis::integrate([](double x) { return 6 * x; }, alone, {.budget = 10, .iterations = 2});
  CHECK(run.estimate == Approx(3).epsilon(1e-14));
  CHECK(run.standard_error <= 1e-14);
  const auto second = phimis::integrate([](double x) { return 6 * x; }, two, {.budget = 10, .iterations = 2},
                                        phimis::fixed_rule<2>({.start = {{0, 1}}}));
  CHECK(second.estimate == Approx(3).epsilon(1e-14));
  CHECK(second.trace[0].counts[0] == 0);
}

TEST_CASE("Balance by its weights and balance by its shortcut are one heuristic") {
  const auto by_weights = [](int k, const auto& alpha, const auto& pdfs) { return phimis::balance{}(k, alpha, pdfs); };
  static_assert(phimis::weight_heuristic<decltype(by_weights)>);
  const integrate_options options{.budget = 90, .iterations = 3};
  const auto rule = phimis::fixed_rule<2>();
  CHECK(phimis::integrate(f, two, options, rule, by_weights).estimate ==
        Approx(phimis::integrate(f, two, options, rule).estimate).epsilon(1e-14));
}

TEST_CASE("An integrand in single precision is integrated in single precision") {
  const auto run = phimis::integrate([](double x) { return static_cast<float>(f(x)); }, two, {.budget = 1000});
  static_assert(std::is_same_v<decltype(run.estimate), float>);
  CHECK(std::fabs(static_cast<double>(run.estimate) - mu) <= 5 * static_cast<double>(run.standard_error));
  const auto tint = [](double x) { return colour<float>{{static_cast<float>(f(x)), 1, static_cast<float>(x)}}; };
  const auto coloured = phimis::integrate(tint, two, {.budget = 1000}, phimis::power{});
  static_assert(std::is_same_v<decltype(coloured.estimate), colour<float>>);
  CHECK(std::fabs(static_cast<double>(coloured.estimate[0]) - mu) <= 5 * static_cast<double>(coloured.standard_error[0]));
}

TEST_CASE("A batch draws each technique as often as it counts and hands over every sample") {
  std::vector<phimis::drawn_sample<double, 3>> samples;
  auto next = source(5);
  const auto batch = phimis::draw_batch(f, three, phimis::fractions<double, 3>{{0.5, 0.3, 0.2}}, {.samples = 20}, phimis::balance{}, next,
                                        [&](const auto& sample) { samples.push_back(sample); });
  CHECK(batch.counts[0] == 10);
  CHECK(batch.counts[1] == 6);
  CHECK(batch.counts[2] == 4);
  CHECK(batch.fractions[1] == 0.3);
  CHECK(batch.variance == sampling_model::multi_sample);
  REQUIRE(samples.size() == 20);
  int drawn[3] = {};
  double sum = 0;
  for (const auto& sample : samples) {
    ++drawn[sample.observed.technique];
    sum += sample.contribution;
    const auto& p = sample.observed.pdfs;
    CHECK(sample.observed.q == Approx(0.5 * p[0] + 0.3 * p[1] + 0.2 * p[2]).epsilon(1e-15));
    CHECK(sample.contribution == Approx(sample.value / sample.observed.q).epsilon(1e-15));
    CHECK(sample.observed.f == sample.value);
  }
  for (int k = 0; k < 3; ++k) CHECK(drawn[k] == batch.counts[k]);
  CHECK(batch.estimator.estimate() == Approx(sum / 20).epsilon(1e-14));
}

TEST_CASE("Cost counts every sample at its price, efficiency is 1/(cost × variance)") {
  const auto plain = phimis::integrate(f, three, {.budget = 90, .iterations = 3, .growth = 1}, phimis::fixed_rule<3>());
  CHECK(plain.cost == 90);
  CHECK(plain.efficiency == Approx(1 / (90 * plain.standard_error * plain.standard_error)));
  const auto priced = phimis::integrate(f, three, {.budget = 90, .iterations = 3, .growth = 1},
                                        phimis::fixed_rule<3>({.costs = {{1, 2, 6}}}));
  CHECK(priced.cost == 30 * (1 + 2 + 6));
  CHECK(priced.estimate == plain.estimate);
  CHECK(priced.efficiency == Approx(plain.efficiency / 3));
  const auto zero = phimis::integrate([](double) { return 0.0; }, three, {.budget = 9, .iterations = 3});
  CHECK(zero.efficiency == 0);  // nothing is known of the variance
  const auto learnt = phimis::integrate(f, three, {.budget = 90, .iterations = 3},
                                        phimis::exact_rule<3>(phimis::one_sample_variance{}, {.costs = {{1, 2, 6}}}));
  double cost = 0;
  for (const auto& it : learnt.trace) {
    cost += static_cast<double>(it.counts[0] + 2 * it.counts[1] + 6 * it.counts[2]);
  }
  CHECK(learnt.cost == cost);
}

TEST_CASE("integrate() learns by a streaming rule nearly what the exact one learns") {
  const integrate_options options{.budget = 40000, .iterations = 20};
  const auto exact = phimis::integrate(f, three, options, phimis::exact_rule<3>(phimis::kullback_leibler{}));
  const auto streaming = phimis::integrate(f, three, options, phimis::streaming_rule<3>(phimis::kullback_leibler{}));
  CHECK(std::fabs(streaming.estimate - mu) < 5 * streaming.standard_error);
  // The flat pdf is the mean of the others: only the slope of the mixture is determined.
  const auto slope = [](const auto& result) { return result.fractions[1] - result.fractions[0]; };
  CHECK(std::fabs(slope(streaming) - slope(exact)) < 0.1);
}
