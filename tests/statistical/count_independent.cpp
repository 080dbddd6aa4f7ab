// SPDX-License-Identifier: MIT
// Is the estimator whose weights do not depend on the counts unbiased, and is its variance that of Eq. 29 of Sbert, Havran
// & Szirmay-Kalos 2016? And are estimates unbiased while the rules of that paper learn? Fixed seeds; z-scores against exact
// values. |z| < 4 is exceeded by chance in 1 of 16 000 comparisons; this file makes about 80.

#include "catch.hpp"

#include <papers/variance_problems.hpp>

#include <phimis/analysis/allocation.hpp>
#include <phimis/analysis/problem.hpp>
#include <phimis/phimis.hpp>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <random>

namespace {

using namespace phimis::analysis;

std::uint64_t seed() {
  const char* given = std::getenv("PHIMIS_SEED");
  return given == nullptr ? 1 : std::strtoull(given, nullptr, 10);
}

/// How many standard errors the mean of what was added lies from a value.
double z_score(const phimis::moments<double>& of, double expected) {
  return (of.mean - expected) / std::sqrt(of.variance() / static_cast<double>(of.count));
}

template <class Paper, class Heuristic>
void check_fixed_counts(const Heuristic& heuristic, const phimis::counts<3>& counts, int runs) {
  const auto techniques = Paper::techniques();
  const problem<3> on(Paper::f, techniques, Paper::domain());
  const auto parts = moments_of_parts(heuristic, on);
  const double mu = on.mean().value;
  const std::int64_t samples = counts[0] + counts[1] + counts[2];
  phimis::fractions<double, 3> alpha{};
  double wanted = 0;  // Σ σ_i²/n_i, Eq. 29
  for (int k = 0; k < 3; ++k) {
    alpha[k] = static_cast<double>(counts[k]) / static_cast<double>(samples);
    wanted += parts.variance[k].value / static_cast<double>(counts[k]);
  }
  CHECK(variance_of_parts(parts.variance, alpha).value / static_cast<double>(samples) ==
        Approx(wanted).epsilon(1e-13));

  std::mt19937_64 engine(seed());
  auto next = [&] { return phimis::uniform(engine()); };
  phimis::moments<double> estimates, squares, claimed;
  for (int run = 0; run < runs; ++run) {
    const auto batch = phimis::draw_batch(Paper::f, techniques, alpha, {.samples = samples},
                                          phimis::count_independent{heuristic}, next, [](const auto&) {});
    for (int k = 0; k < 3; ++k) REQUIRE(batch.counts[k] == counts[k]);
    const double f = batch.estimator.estimate();
    estimates.add(f);
    squares.add((f - mu) * (f - mu));
    claimed.add(batch.estimator.variance(batch.variance));
  }
  INFO(Paper::name << ", counts " << counts[0] << ' ' << counts[1] << ' ' << counts[2]);
  CHECK(std::fabs(z_score(estimates, mu)) < 4);
  CHECK(std::fabs(z_score(squares, wanted)) < 4);
  CHECK(std::fabs(z_score(claimed, wanted)) < 4);
}

template <class Paper, class Rule, class Heuristic>
void check_adaptive(const char* name, const Rule& rule, const Heuristic& heuristic) {
  const auto techniques = Paper::techniques();
  const problem<3> on(Paper::f, techniques, Paper::domain());
  std::mt19937_64 engine(seed());
  auto next = [&] { return phimis::uniform(engine()); };
  phimis::moments<double> estimates;
  for (int run = 0; run < 4000; ++run) {
    estimates.add(
        phimis::integrate(Paper::f, techniques, {.budget = 100, .iterations = 5}, next, rule, heuristic).estimate);
  }
  INFO(Paper::name << ' ' << name);
  CHECK(std::fabs(z_score(estimates, on.mean().value)) < 4);
}

}  // namespace

TEMPLATE_TEST_CASE("Count-independent weights are unbiased and have the variance of Eq. 29, whatever the counts", "",
                   papers::variance_1, papers::variance_2, papers::variance_3) {
  check_fixed_counts<TestType>(phimis::balance{}, {{5, 3, 2}}, 20000);
  check_fixed_counts<TestType>(phimis::balance{}, {{2, 2, 12}}, 20000);
}

TEMPLATE_TEST_CASE("Every count-independent heuristic is unbiased and has the variance of its parts", "",
                   papers::variance_1, papers::variance_3) {
  check_fixed_counts<TestType>(phimis::power{2}, {{5, 3, 2}}, 20000);
  check_fixed_counts<TestType>(phimis::cutoff{0.1}, {{5, 3, 2}}, 20000);
  check_fixed_counts<TestType>(phimis::maximum{}, {{3, 5, 2}}, 20000);
}

TEMPLATE_TEST_CASE("Estimates are unbiased while the rules of the variance paper learn", "", papers::variance_1,
                   papers::variance_2, papers::variance_3) {
  const phimis::rule_options<double, 3> priced{.costs = papers::variance_setting::costs};
  check_adaptive<TestType>("sigma", phimis::sigma_rule<3>(), phimis::count_independent{});
  check_adaptive<TestType>("sigma, costs", phimis::sigma_rule<3>(priced), phimis::count_independent{});
  check_adaptive<TestType>("sigma, power", phimis::sigma_rule<3>(priced, phimis::power{2}),
                           phimis::count_independent{phimis::power{2}});
  check_adaptive<TestType>("inverse variance", phimis::inverse_variance_rule<3>(priced), phimis::balance{});
  check_adaptive<TestType>("second order", phimis::second_order_rule<3>(priced), phimis::balance{});
}

TEST_CASE("The sigma rule learns the optimal fractions") {
  using Paper = papers::variance_3;
  const auto techniques = Paper::techniques();
  const problem<3> on(Paper::f, techniques, Paper::domain());
  const auto best = best_fractions(moments_of_parts(phimis::balance{}, on).variance, Paper::costs);
  auto options = phimis::without_floors<double, 3>();
  options.costs = Paper::costs;
  std::mt19937_64 engine(seed());
  auto next = [&] { return phimis::uniform(engine()); };
  phimis::moments<double> learnt[3];
  for (int run = 0; run < 200; ++run) {
    const auto result = phimis::integrate(Paper::f, techniques, {.budget = 4000, .iterations = 8}, next,
                                          phimis::sigma_rule<3>(options), phimis::count_independent{});
    for (int k = 0; k < 3; ++k) learnt[k].add(result.fractions[k]);
  }
  for (int k = 0; k < 3; ++k) {
    // The bias of an estimated σ is of the order of its variance, 1/n: 1e-3 of 1/3 at most.
    CHECK(std::fabs(learnt[k].mean - best[k]) <= 4 * std::sqrt(learnt[k].variance() / 200) + 3e-4);
    CHECK(std::sqrt(learnt[k].variance()) <= 0.02);
  }
}

TEST_CASE("The sigma rule keeps what the inverse-variance rule loses where f is the sum of the pdfs") {
  // Example 4: no variance at equal counts. The sigma rule sees that; one that looks at each technique alone does not.
  using Paper = papers::variance_4;
  const auto techniques = Paper::techniques();
  const phimis::integrate_options options{.budget = 500, .iterations = 5};
  const auto sigma =
      phimis::integrate(Paper::f, techniques, options, phimis::sigma_rule<3>(), phimis::count_independent{});
  CHECK(sigma.fractions[0] == 1.0 / 3);
  CHECK(std::fabs(sigma.estimate - 3) <= 1e-13);
  const auto inverse = phimis::integrate(Paper::f, techniques, options, phimis::inverse_variance_rule<3>());
  CHECK(inverse.fractions[0] > 0.8);
  CHECK(std::fabs(inverse.estimate - 3) > 1e-6);
}
