// SPDX-License-Identifier: MIT
#ifndef PHIMIS_TESTS_PROPERTY_TECHNIQUES_HPP
#define PHIMIS_TESTS_PROPERTY_TECHNIQUES_HPP

#include "catch.hpp"
#include "random.hpp"

#include <phimis/concepts.hpp>

#include <boost/math/distributions/chi_squared.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

/// sample, pdf and invert, each held against the other two. The range [low, high] is bounded and holds the domain, or
/// as much of it as matters.
template <class Technique>
void check_triad(const Technique& technique, double low, double high) {
  static_assert(phimis::invertible_technique<Technique>);
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  const double length = high - low;

  // invert(sample(u)) = u, up to 1e-14 and to the rounding of x, which moves u by pdf(x) ε |x|.
  std::vector<double> us{0x1p-40, 1e-6, 0.5, 1 - 1e-6, 1 - 0x1p-40};
  for (int i = 1; i < 64; ++i) us.push_back(i / 64.0);
  std::sort(us.begin(), us.end());
  double before = low;
  for (const double u : us) {
    INFO("u " << u);
    const double x = technique.sample([u] { return u; });
    REQUIRE(x >= low);
    REQUIRE(x <= high);
    REQUIRE(x >= before);  // inversion is monotone
    before = x;
    const double pdf = technique.pdf(x);
    CHECK(pdf > 0);
    CHECK(std::fabs(technique.invert(x) - u) <= 2e-14 + 4 * epsilon * std::fabs(x) * pdf);
  }

  // The derivative of invert is pdf: h² of the third derivative, and ε/h.
  for (int i = 1; i < 100; ++i) {
    const double x = technique.sample([i] { return i / 100.0; });
    const double h = 1e-5 * std::min({length, x - low, high - x});
    if (!(h > 1e-9 * length)) continue;
    const double slope = (technique.invert(x + h) - technique.invert(x - h)) / (2 * h);
    INFO("x " << x);
    CHECK(std::fabs(slope - technique.pdf(x)) <= 1e-5 * technique.pdf(x) + 4 * epsilon / h);
  }
  CHECK(technique.invert(low) <= 1e-12);
  CHECK(technique.invert(high) >= 1 - 1e-12);
}

/// Chi-squared goodness of fit of `sample` to `invert` in 32 cells: 31 degrees of freedom, false alarm 1e-6.
template <class Technique>
double goodness_of_fit(const Technique& technique, std::uint64_t seed, int n = 20000) {
  constexpr int cells = 32;
  random_numbers random(seed);
  std::vector<int> count(cells);
  for (int i = 0; i < n; ++i) {
    const double u = technique.invert(technique.sample(random));
    ++count[static_cast<std::size_t>(std::min(cells - 1, static_cast<int>(u * cells)))];
  }
  const double expected = static_cast<double>(n) / cells;
  double statistic = 0;
  for (const int c : count) statistic += (c - expected) * (c - expected) / expected;
  return cdf(complement(boost::math::chi_squared(cells - 1), statistic));
}

#endif  // PHIMIS_TESTS_PROPERTY_TECHNIQUES_HPP
