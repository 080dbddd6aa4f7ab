// SPDX-License-Identifier: MIT
// iteration_sizes.hpp
#include "catch.hpp"
#include "refuses.hpp"

#include <phimis/phimis.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

using phimis::iteration_sizes;
using sizes = std::vector<std::int64_t>;

TEST_CASE("Without growth iterations are even and the first ones have what is left over") {
  CHECK(iteration_sizes(500, 5, 1, 2) == sizes{100, 100, 100, 100, 100});
  CHECK(iteration_sizes(503, 5, 1, 4) == sizes{101, 101, 101, 100, 100});
  CHECK(iteration_sizes(7, 1, 16, 2) == sizes{7});
}

TEST_CASE("With growth iterations are in equal ratios, above a sample for each technique") {
  CHECK(iteration_sizes(62 + 10, 5, 16, 2) == sizes{4, 6, 10, 18, 34});
  CHECK(iteration_sizes(14 + 6, 3, 0.25, 2) == sizes{10, 6, 4});
}

TEST_CASE("Iterations add up to the budget and none is empty, whatever the growth") {
  for (const double growth : {1e-300, 0.01, 1.0, 3.0, 16.0, 1e6, 1e300}) {
    for (const std::int64_t budget : {25, 26, 100, 12345, 1000000007}) {
      for (const int iterations : {1, 2, 5, 25}) {
        const sizes n = iteration_sizes(budget, iterations, growth, 3);
        CHECK(std::accumulate(n.begin(), n.end(), std::int64_t{0}) == budget);
        for (const std::int64_t each : n) CHECK(each >= std::min<std::int64_t>(3, budget / iterations));
      }
    }
  }
}

TEST_CASE("Iterations that grow stay unbiased, and their trace has the sizes") {
  const phimis::interval domain(0, 3);
  const auto f = [](double x) { return x * x; };
  const phimis::technique_set techniques(phimis::gaussian(1, 1, domain), phimis::gaussian(3, 1, domain));
  phimis::moments<double> estimates;
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
    const auto found = phimis::integrate(f, techniques, {.budget = 60, .growth = 16, .seed = seed});
    estimates.add(found.estimate);
    if (seed > 1) continue;
    const sizes n = iteration_sizes(60, 5, 16, 2);
    REQUIRE(found.trace.size() == n.size());
    for (std::size_t b = 0; b < n.size(); ++b) CHECK(found.trace[b].samples == n[b]);
  }
  CHECK(std::fabs(estimates.mean - 9) < 5 * std::sqrt(estimates.variance() / 2000));
}

TEST_CASE("Growth must be a positive number") {
  const phimis::interval domain(0, 1);
  const phimis::technique_set techniques(phimis::gaussian(0, 1, domain), phimis::gaussian(1, 1, domain));
  const auto run = [&](double growth) {
    phimis::integrate([](double x) { return x; }, techniques, {.growth = growth});
  };
  refuses([&] { run(0); }, "growth", "must be finite and greater than 0", "0");
  refuses([&] { run(-1); }, "growth", "must be finite and greater than 0", "-1");
  refuses([&] { run(std::numeric_limits<double>::infinity()); }, "growth", "must be finite and greater than 0",
          "inf");
}
