// SPDX-License-Identifier: MIT
// Are the estimates unbiased, and are their variances what the formulas say? Fixed seeds; z-scores against exact values.
// |z| < 4 is exceeded by chance in 1 of 16 000 comparisons; this file makes about 60.

#include "catch.hpp"
#include "statistical/learning.hpp"

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <random>

namespace {

using learning::arena;
using phimis::by_count;
using phimis::sampling_model;

std::uint64_t seed() {
  const char* given = std::getenv("PHIMIS_SEED");
  return given == nullptr ? 1 : std::strtoull(given, nullptr, 10);
}

/// How many standard errors the mean of what was added lies from a value.
double z_score(const phimis::moments<double>& of, double expected) {
  return (of.mean - expected) / std::sqrt(of.variance() / static_cast<double>(of.count));
}

/// Mean, spread and claimed variance of an estimate of N samples over many runs.
template <class Paper, class Heuristic>
void check_fixed_fractions(double alpha, sampling_model model, const Heuristic& heuristic, bool check_variance) {
  const arena<Paper> a;
  const phimis::fractions<double, 2> fractions{{alpha, 1 - alpha}};
  const auto exact = phimis::analysis::variance(a.oracle, fractions);
  const double v = model == sampling_model::multi_sample ? exact.multi_sample.value : exact.one_sample.value;
  const double mu = a.oracle.mean().value;
  constexpr int samples = 10;
  const int runs = check_variance ? 100000 : 10000;
  std::mt19937_64 engine(seed());
  auto next = [&] { return phimis::uniform(engine()); };
  phimis::moments<double> estimates, squares, claimed;
  for (int run = 0; run < runs; ++run) {
    const auto batch = phimis::draw_batch(Paper::f, a.techniques, fractions, {.samples = samples, .model = model},
                                          heuristic, next, [](const auto&) {});
    const double f = batch.estimator.estimate();
    estimates.add(f);
    squares.add((f - mu) * (f - mu));
    claimed.add(batch.estimator.variance(batch.variance));
  }
  INFO(Paper::name << " alpha " << alpha << (model == sampling_model::multi_sample ? " multi" : " one") << "-sample");
  CHECK(std::fabs(z_score(estimates, mu)) < 4);
  if (!check_variance) return;
  CHECK(std::fabs(z_score(squares, v / samples)) < 4);
  CHECK(std::fabs(z_score(claimed, v / samples)) < 4);
}

/// Mean of adaptive runs, of 5 iterations of 20 samples.
template <class Paper, class... Policies>
void check_adaptive(const char* name, sampling_model model, const Policies&... policies) {
  const arena<Paper> a;
  constexpr int runs = 10000;
  std::mt19937_64 engine(seed());
  auto next = [&] { return phimis::uniform(engine()); };
  phimis::moments<double> estimates;
  for (int run = 0; run < runs; ++run) {
    estimates.add(
        phimis::integrate(Paper::f, a.techniques, {.budget = 100, .iterations = 5, .model = model}, next, policies...)
            .estimate);
  }
  INFO(Paper::name << ' ' << name);
  CHECK(std::fabs(z_score(estimates, a.oracle.mean().value)) < 4);
}

template <class Paper>
void check_all_adaptive() {
  constexpr auto multi = sampling_model::multi_sample;
  constexpr auto one = sampling_model::one_sample;
  const phimis::rule_options<double, 2> floors{.floors = {{0.01, 0.01}}};
  check_adaptive<Paper>("default", multi);
  check_adaptive<Paper>("default, one-sample", one);
  check_adaptive<Paper>("square root", multi, phimis::square_root{});
  check_adaptive<Paper>("fixed weights", multi, phimis::fixed_weights({.15, .8, 1}));
  check_adaptive<Paper>("exact, Kullback-Leibler", multi, phimis::exact_rule(phimis::kullback_leibler{}, floors));
  check_adaptive<Paper>("exact, V[F]", multi, phimis::exact_rule(phimis::multi_sample_variance{}, floors));
  check_adaptive<Paper>("Newton-Raphson", multi,
                        phimis::newton_rule(phimis::tsallis{0.5}, phimis::newton_form::paper, floors));
  check_adaptive<Paper>("power heuristic", multi, phimis::power{2});
}

}  // namespace

TEMPLATE_TEST_CASE("Both estimators are unbiased and have the variance that the oracle gives", "", papers::tsallis_1,
                   papers::tsallis_2, papers::tsallis_3) {
  for (const double alpha : {0.3, 0.6}) {
    for (const auto model : {sampling_model::multi_sample, sampling_model::one_sample}) {
      check_fixed_fractions<TestType>(alpha, model, phimis::balance{}, true);
    }
  }
}

TEMPLATE_TEST_CASE("Every weight heuristic is unbiased", "", papers::tsallis_1, papers::tsallis_3) {
  for (const auto model : {sampling_model::multi_sample, sampling_model::one_sample}) {
    check_fixed_fractions<TestType>(0.4, model, phimis::power{2}, false);
    check_fixed_fractions<TestType>(0.4, model, phimis::cutoff{0.1}, false);
    check_fixed_fractions<TestType>(0.4, model, phimis::maximum{}, false);
  }
}

TEMPLATE_TEST_CASE("Adaptive estimates are unbiased", "", papers::tsallis_1, papers::tsallis_2, papers::tsallis_3) {
  check_all_adaptive<TestType>();
}

TEST_CASE("Inverse-variance weights are biased, as they say") {
  const arena<papers::tsallis_1> a;
  std::mt19937_64 engine(seed());
  auto next = [&] { return phimis::uniform(engine()); };
  phimis::moments<double> estimates;
  for (int run = 0; run < 4000; ++run) {
    estimates.add(phimis::integrate(papers::tsallis_1::f, a.techniques, {.budget = 500, .iterations = 25}, next,
                                    phimis::inverse_variance{})
                      .estimate);
  }
  CHECK(std::fabs(z_score(estimates, a.oracle.mean().value)) > 8);
}
