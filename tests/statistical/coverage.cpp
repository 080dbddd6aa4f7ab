// SPDX-License-Identifier: MIT
// Do 95 % confidence intervals hold 95 % of the time? With five iterations of 100 samples between 94 and 96 %, whatever the
// growth and the combination; with five of 10 at least 93.5 %, where 1.96 standard errors hold less often. Fixed seeds. What
// is at the edge of its claim fails by chance in 1 of 31 000 comparisons (4 standard deviations); this file makes about 90.
// bench/coverage.cpp has the figures.

#include "catch.hpp"

#include <papers/linear_problems.hpp>

#include <phimis/analysis/confidence_interval.hpp>
#include <phimis/analysis/problem.hpp>
#include <phimis/phimis.hpp>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <random>

namespace {

std::uint64_t seed() {
  const char* given = std::getenv("PHIMIS_SEED");
  return given == nullptr ? 1 : std::strtoull(given, nullptr, 10);
}

/// A share of runs, and whether it agrees with a claim.
struct share {
  double value;
  double runs;
  bool at_least(double claim) const { return value > claim - 4 * std::sqrt(claim * (1 - claim) / runs); }
  bool at_most(double claim) const { return value < claim + 4 * std::sqrt(claim * (1 - claim) / runs); }
};

struct coverage {
  share by_t;
  share by_normal;  ///< of 1.96 standard errors
};

template <class Paper, class Combination>
coverage measure(int runs, const phimis::integrate_options& options, const Combination& combination) {
  constexpr int M = decltype(Paper::techniques())::techniques;
  static const double mu = phimis::analysis::problem<M>{Paper::f, Paper::techniques(), Paper::domain()}.mean().value;
  static const auto techniques = Paper::techniques();
  std::mt19937_64 engine(seed());
  auto next = [&] { return phimis::uniform(engine()); };
  int by_t = 0;
  int by_normal = 0;
  for (int run = 0; run < runs; ++run) {
    const auto result = phimis::integrate(Paper::f, techniques, options, next, combination);
    const auto bounds = phimis::analysis::confidence_interval(result);
    by_t += bounds.lower <= mu && mu <= bounds.upper ? 1 : 0;
    by_normal += std::fabs(result.estimate - mu) <= 1.959963984540054 * result.standard_error ? 1 : 0;
  }
  const double n = runs;
  return {{by_t / n, n}, {by_normal / n, n}};
}

template <class Paper, class Combination>
void check_hundreds(double growth, const Combination& combination, bool bounded_contributions) {
  const coverage found = measure<Paper>(2000, {.budget = 500, .iterations = 5, .growth = growth}, combination);
  INFO(Paper::name << ", growth " << growth << ": t " << found.by_t.value << ", 1.96 " << found.by_normal.value);
  CHECK(found.by_t.at_least(0.94));
  CHECK(found.by_normal.at_least(0.94));
  CHECK(found.by_normal.at_most(0.96));
  // Where one small iteration has the variance, t allows for tails that bounded contributions do not have.
  if (!bounded_contributions) CHECK(found.by_t.at_most(0.96));
}

}  // namespace

TEMPLATE_TEST_CASE("95 % intervals hold in 94 to 96 % of the runs of 5 iterations of 100 samples", "",
                   papers::tsallis_1, papers::tsallis_2, papers::tsallis_3, papers::linear_4, papers::linear_5,
                   papers::linear_6) {
  const bool is_t2 = TestType::f == papers::tsallis_2::f;
  check_hundreds<TestType>(1, phimis::by_count{}, is_t2);
  check_hundreds<TestType>(1, phimis::square_root{}, is_t2);
  check_hundreds<TestType>(16, phimis::square_root{}, is_t2);
}

TEMPLATE_TEST_CASE("95 % intervals hold in at least 93.5 % of the runs of 5 iterations of 10 samples", "",
                   papers::tsallis_1, papers::tsallis_2, papers::tsallis_3, papers::linear_4, papers::linear_5,
                   papers::linear_6) {
  for (const double growth : {1.0, 16.0}) {
    const coverage found =
        measure<TestType>(4000, {.budget = 50, .iterations = 5, .growth = growth}, phimis::square_root{});
    INFO(TestType::name << ", growth " << growth << ": t " << found.by_t.value << ", 1.96 " << found.by_normal.value);
    CHECK(found.by_t.at_least(0.935));
    CHECK(found.by_t.value > found.by_normal.value + 0.005);
  }
}
