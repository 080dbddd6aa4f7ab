// SPDX-License-Identifier: MIT
#include "catch.hpp"
#include "colour.hpp"
#include "random.hpp"

#include <phimis/core/moments.hpp>

#include <cmath>
#include <limits>
#include <vector>

namespace {

struct two_pass {
  long double mean = 0;
  long double variance = 0;
};

template <class Real>
two_pass in_two_passes(const std::vector<Real>& data) {
  two_pass result;
  for (const Real x : data) result.mean += static_cast<long double>(x);
  result.mean /= static_cast<long double>(data.size());
  for (const Real x : data) {
    const long double d = static_cast<long double>(x) - result.mean;
    result.variance += d * d;
  }
  result.variance /= static_cast<long double>(data.size() - 1);
  return result;
}

template <class Real>
std::vector<Real> random_values(int n, double offset, std::uint64_t seed) {
  random_numbers random(seed);
  std::vector<Real> data;
  for (int i = 0; i < n; ++i) data.push_back(static_cast<Real>(offset + random.between(-1, 1)));
  return data;
}

template <class Real>
void check(const phimis::moments<Real>& computed, const std::vector<Real>& data) {
  const two_pass wanted = in_two_passes(data);
  const long double epsilon = std::numeric_limits<Real>::epsilon();
  const long double n = static_cast<long double>(data.size());
  // Chan & Lewis 1979: Welford's relative error of the variance is at most about n ε κ, κ² = 1 + mean²/variance.
  const long double kappa = std::sqrt(1 + wanted.mean * wanted.mean / wanted.variance);
  CHECK(computed.count == static_cast<std::int64_t>(data.size()));
  CHECK(std::fabs(static_cast<long double>(computed.mean) - wanted.mean) <=
        n * epsilon * (std::fabs(wanted.mean) + std::sqrt(wanted.variance)));
  CHECK(std::fabs(static_cast<long double>(computed.variance()) - wanted.variance) <=
        n * epsilon * kappa * wanted.variance);
}

}  // namespace

TEMPLATE_TEST_CASE("Moments agree with two passes in long double", "", float, double) {
  for (const double offset : {0.0, 3.0, -50.0}) {
    const auto data = random_values<TestType>(1000, offset, 1);
    phimis::moments<TestType> computed;
    for (const TestType x : data) computed.add(x);
    check(computed, data);
  }
}

TEST_CASE("An offset of 1e9 leaves the variance its digits") {
  // A sum of squares would keep none: κ² ε = 1e18 · 2e-16.
  const auto data = random_values<double>(1000, 1e9, 2);
  phimis::moments<double> computed;
  for (const double x : data) computed.add(x);
  check(computed, data);
  CHECK(computed.variance() == Approx(1.0 / 3).epsilon(0.1));  // of a uniform number on [−1, 1]
}

TEMPLATE_TEST_CASE("Merged in any grouping, moments are those of all values", "", float, double) {
  random_numbers random(3);
  for (int round = 0; round < 20; ++round) {
    const auto data = random_values<TestType>(200, 2, 4 + static_cast<std::uint64_t>(round));
    std::vector<phimis::moments<TestType>> groups(static_cast<std::size_t>(1 + random.below(30)));
    for (const TestType x : data) groups[random.bits() % groups.size()].add(x);
    // Merge random pairs until one is left; some groups are empty.
    while (groups.size() > 1) {
      const std::size_t into = random.bits() % (groups.size() - 1);
      groups[into].merge(groups.back());
      groups.pop_back();
    }
    check(groups.front(), data);
  }
}

TEST_CASE("Merging with nothing changes nothing") {
  phimis::moments<double> some;
  for (const double x : {1.0, 2.0, 4.0}) some.add(x);
  phimis::moments<double> copy = some;
  copy.merge({});
  CHECK(copy.mean == some.mean);
  CHECK(copy.squares == some.squares);
  phimis::moments<double> none;
  none.merge(some);
  CHECK(none.count == 3);
  CHECK(none.mean == some.mean);
  CHECK(none.squares == some.squares);
  none = {};
  none.merge({});
  CHECK(none.count == 0);
  CHECK(none.mean == 0);
}

TEST_CASE("Fewer than two values have no variance") {
  phimis::moments<double> one;
  CHECK(one.variance() == 0);
  one.add(5);
  CHECK(one.mean == 5);
  CHECK(one.variance() == 0);
}

TEMPLATE_TEST_CASE("A colour's moments are those of its components", "", float, double) {
  const auto red = random_values<TestType>(100, 0, 5);
  const auto green = random_values<TestType>(100, 1, 6);
  const auto blue = random_values<TestType>(100, 2, 7);
  phimis::moments<colour<TestType>> first, second;
  for (std::size_t i = 0; i < 100; ++i) (i < 37 ? first : second).add({{red[i], green[i], blue[i]}});
  first.merge(second);
  const auto component = [&first](int i) {
    phimis::moments<TestType> m;
    m.count = first.count;
    m.mean = first.mean[i];
    m.squares = first.squares[i];
    return m;
  };
  check(component(0), red);
  check(component(1), green);
  check(component(2), blue);
  CHECK(first.variance()[1] == component(1).variance());
}
