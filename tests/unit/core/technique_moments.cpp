// SPDX-License-Identifier: MIT
#include "catch.hpp"
#include "random.hpp"

#include <phimis/core/technique_moments.hpp>

#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>
#include <vector>

namespace {

template <class Real>
struct drawn {
  int technique;
  Real value;
};

template <class Real>
std::vector<drawn<Real>> draw(int n, std::uint64_t seed) {
  random_numbers random(seed);
  std::vector<drawn<Real>> all;
  for (int i = 0; i < n; ++i) {
    const int k = random.below(2);
    all.push_back({k, static_cast<Real>(random.between(-1, k == 0 ? 2 : 5))});
  }
  return all;
}

template <class Real>
phimis::technique_moments<Real, 2> of(const std::vector<drawn<Real>>& all, Real scale = 1) {
  phimis::technique_moments<Real, 2> moments;
  for (const auto& one : all) moments.add(one.technique, one.value * scale);
  return moments;
}

template <class Real>
Real ratio(const phimis::technique_moments<Real, 2>& moments) {
  return moments.deviation(0) / moments.deviation(1);
}

}  // namespace

TEMPLATE_TEST_CASE("Deviations of techniques are those of two passes over their samples", "", float, double) {
  const auto all = draw<TestType>(500, 1);
  const auto moments = of(all);
  double sigma[2];
  for (int k = 0; k < 2; ++k) {
    double n = 0, mean = 0, squares = 0;
    for (const auto& one : all) {
      if (one.technique == k) n += 1, mean += static_cast<double>(one.value);
    }
    mean /= n;
    for (const auto& one : all) {
      if (one.technique == k) squares += std::pow(static_cast<double>(one.value) - mean, 2);
    }
    sigma[k] = std::sqrt(squares / (n - 1));
    CHECK(static_cast<double>(moments.count(k)) == n);
    CHECK(moments.known(k));
    CHECK(moments.any(k));
  }
  CHECK(moments.count() == 500);
  CHECK(static_cast<double>(ratio(moments)) ==
        Approx(sigma[0] / sigma[1]).epsilon(64 * static_cast<double>(std::numeric_limits<TestType>::epsilon())));
}

TEMPLATE_TEST_CASE("No power of two of the numbers changes a digit of their ratio, and none overflows", "", float,
                   double) {
  const auto all = draw<TestType>(200, 2);
  const TestType plain = ratio(of(all));
  constexpr int range = std::is_same_v<TestType, float> ? 100 : 900;
  for (const int exponent : {-range, -1, 1, range}) {
    CHECK(ratio(of(all, std::ldexp(TestType(1), exponent))) == plain);
  }
}

TEMPLATE_TEST_CASE("Numbers of any size may follow each other", "", float, double) {
  // The small ones vanish beside the large one, whose square is no float.
  phimis::technique_moments<TestType, 2> moments;
  const TestType large = std::numeric_limits<TestType>::max() / 4;
  moments.add(0, std::numeric_limits<TestType>::min());
  moments.add(0, large);
  moments.add(0, TestType(0));
  moments.add(0, TestType(0));
  moments.add(1, -large);
  moments.add(1, large);
  CHECK(static_cast<double>(ratio(moments)) == Approx(0.5 / std::sqrt(2.0)).epsilon(1e-6));  // ½ and √2 of `large`
}

TEMPLATE_TEST_CASE("Moments of techniques merge in any grouping", "", float, double) {
  const auto all = draw<TestType>(300, 3);
  const auto whole = of(all);
  const TestType unit = std::ldexp(TestType(1), 40);
  for (const std::ptrdiff_t first : {0, 1, 17, 150, 299, 300}) {
    const std::vector<drawn<TestType>> head(all.begin(), all.begin() + first);
    const std::vector<drawn<TestType>> tail(all.begin() + first, all.end());
    auto merged = of(head);
    merged.merge(of(tail));
    auto turned = of(tail);
    turned.merge(of(head));
    CHECK(merged.count() == 300);
    const auto wanted = Approx(static_cast<double>(ratio(whole)))
                            .epsilon(64 * static_cast<double>(std::numeric_limits<TestType>::epsilon()));
    CHECK(static_cast<double>(ratio(merged)) == wanted);
    CHECK(static_cast<double>(ratio(turned)) == wanted);
  }
  // States whose numbers are 2^40 apart: the smaller are zeros beside the larger.
  auto small = of(draw<TestType>(100, 4));
  const auto large = of(draw<TestType>(100, 5), unit);
  auto other = large;
  small.merge(large);
  other.merge(of(draw<TestType>(100, 4)));
  CHECK(static_cast<double>(ratio(small)) == Approx(static_cast<double>(ratio(other))).epsilon(1e-5));
}

TEMPLATE_TEST_CASE("Equal numbers have no deviation, however they are rounded", "", float, double) {
  phimis::technique_moments<TestType, 2> moments;
  for (int i = 0; i < 1000; ++i) {
    const TestType third = TestType(1) / 3;
    moments.add(0, i % 2 == 0 ? third : std::nextafter(third, TestType(1)));
    moments.add(1, i % 2 == 0 ? third : third * TestType(1.01));
  }
  CHECK(moments.deviation(0) == 0);
  CHECK(moments.deviation(1) > 0);
}

TEMPLATE_TEST_CASE("One sample has no spread, and zeros are samples", "", float, double) {
  phimis::technique_moments<TestType, 2> moments;
  CHECK_FALSE(moments.any());
  moments.add(0, TestType(0));
  moments.add(0, TestType(0));
  CHECK_FALSE(moments.any());
  CHECK(moments.known(0));
  moments.add(1, TestType(3));
  CHECK(moments.any());
  CHECK_FALSE(moments.any(0));
  CHECK(moments.any(1));
  CHECK_FALSE(moments.known(1));
  CHECK(moments.deviation(1) == 0);
  CHECK(moments.count() == 3);
  static_assert(std::is_trivially_copyable<phimis::technique_moments<TestType, 2>>::value, "a pixel's state");
}

TEMPLATE_TEST_CASE("Shares leave frozen techniques where they are", "", float, double) {
  phimis::rule_options<TestType, 3> options;
  options.start = {{TestType(0.25), TestType(0.5), TestType(0.25)}};
  options.floors = {{TestType(0.125), 0, 0}};
  using shares = phimis::per_technique<TestType, 3>;
  const auto check = [](const shares& found, double a, double b, double c) {
    const double digits = 4 * static_cast<double>(std::numeric_limits<TestType>::epsilon());
    CHECK(std::fabs(static_cast<double>(found[0]) - a) <= digits);
    CHECK(std::fabs(static_cast<double>(found[1]) - b) <= digits);
    CHECK(std::fabs(static_cast<double>(found[2]) - c) <= digits);
  };
  check(phimis::share_budget(shares{{1, 2, 1}}, options), 0.25, 0.5, 0.25);
  check(phimis::share_budget(shares{{0, 3, 1}}, options), 0.125, 0.65625, 0.21875);
  options.frozen = {{false, true, false}};
  check(phimis::share_budget(shares{{3, 100, 1}}, options), 0.375, 0.5, 0.125);
  check(phimis::share_budget(shares{{0, 100, 1}}, options), 0.125, 0.5, 0.375);
  check(phimis::share_budget(shares{{0, 1, 0}}, options), 0.25, 0.5, 0.25);
  options.frozen = {{true, true, true}};
  check(phimis::share_budget(shares{{3, 100, 1}}, options), 0.25, 0.5, 0.25);
  options.frozen = {{true, false, false}};
  options.start = {{1, 0, 0}};
  check(phimis::share_budget(shares{{0, 1, 1}}, options), 1, 0, 0);
}
