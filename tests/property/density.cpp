// SPDX-License-Identifier: MIT
#include "techniques.hpp"

#include <phimis/technique/density.hpp>

#include <boost/math/constants/constants.hpp>

#include <cmath>
#include <numbers>
#include <vector>

namespace {

using phimis::density;
using phimis::interval;

/// 3 on [0, 1), 0 on [1, 2), 1 on [2, 4]: jumps, and a stretch that no sample reaches.
double stairs(double x) { return x < 1 ? 3 : x < 2 ? 0 : 1; }

/// test(name, technique, its closed cdf)
template <class Test>
void for_each_density(Test&& test) {
  using std::numbers::pi;
  test("linear", density([](double x) { return 2 - x; }, interval(0, 2)), [](double x) { return x - x * x / 4; });
  test("sine squared", density([](double x) { return std::sin(x) * std::sin(x); }, interval(0, pi)),
       [](double x) { return (x - std::sin(x) * std::cos(x)) / pi; });
  test("exponential of 20 decades", density([](double x) { return std::exp(46 * x); }, interval(0, 1)),
       [](double x) { return std::expm1(46 * x) / std::expm1(46.0); });
  test("constant", density([](double) { return 5.0; }, interval(-3, 1)), [](double x) { return (x + 3) / 4; });
  test("kink", density([](double x) { return std::fabs(x - 0.3); }, interval(0, 1), {0.3}), [](double x) {
    const double d = x - 0.3;
    return (0.09 + d * std::fabs(d)) / 0.58;
  });
  test("narrow peak", density([](double x) { return 1e-3 / (1e-6 + (x - 0.4) * (x - 0.4)); }, interval(0, 1)),
       [](double x) {
         const double low = std::atan(-0.4e3);
         return (std::atan((x - 0.4) * 1e3) - low) / (std::atan(0.6e3) - low);
       });
}

}  // namespace

TEST_CASE("sample, pdf and invert of a density agree") {
  for_each_density([](const char* name, const auto& technique, const auto&) {
    INFO(name);
    check_triad(technique, technique.domain().lower(), technique.domain().upper());
  });
}

TEST_CASE("The cdf of a density is that of the closed form") {
  for_each_density([](const char* name, const auto& technique, const auto& cdf) {
    INFO(name);
    const interval domain = technique.domain();
    for (int i = 0; i <= 200; ++i) {
      const double x = domain.lower() + i / 200.0 * domain.length();
      CHECK(std::fabs(technique.invert(x) - cdf(x)) <= 1e-13);
    }
  });
}

TEST_CASE("Samples of a density follow it") {
  for_each_density([](const char* name, const auto& technique, const auto&) {
    INFO(name);
    CHECK(goodness_of_fit(technique, 1, 4000) > 1e-6);  // 6 tests: one false alarm in 160000 runs
  });
}

TEST_CASE("Jumps are met at their breakpoints, and no sample falls where the density is 0") {
  const density technique(stairs, interval(0, 4), {2, 1});
  CHECK(technique.normalisation() == Approx(5).epsilon(1e-15));
  CHECK(technique.pdf(0.5) == Approx(0.6).epsilon(1e-15));
  CHECK(technique.pdf(1.5) == 0);
  CHECK(technique.pdf(3) == Approx(0.2).epsilon(1e-15));
  CHECK(technique.invert(1.5) == Approx(0.6).epsilon(1e-15));
  random_numbers random(2);
  for (int i = 0; i < 3000; ++i) {
    const double u = random();
    const double x = technique.sample([u] { return u; });
    REQUIRE(technique.pdf(x) > 0);
    REQUIRE(std::fabs(x - (u < 0.6 ? u / 0.6 : 2 + (u - 0.6) / 0.2)) <= 1e-13);
    REQUIRE(std::fabs(technique.invert(x) - u) <= 2e-14);
  }
}

TEST_CASE("A density that begins and ends with 0 is sampled between") {
  const density technique([](double x) { return x > 1 && x < 2 ? 1.0 : 0.0; }, interval(0, 4), {1, 2});
  for (const double u : {0.0, 0x1p-53, 0.25, 0.5, 1 - 0x1p-53}) {
    const double x = technique.sample([u] { return u; });
    CHECK(std::fabs(x - (1 + u)) <= 1e-13);
  }
}

TEST_CASE("The unit of a density changes nothing") {
  const auto shape = [](double x) { return 1 + std::sin(3 * x); };
  const density plain(shape, interval(0, 2));
  for (const double unit : {1e-300, 1e300}) {
    const density scaled([&](double x) { return unit * shape(x); }, interval(0, 2));
    CHECK(scaled.normalisation() / unit == Approx(plain.normalisation()).epsilon(1e-14));
    for (const double u : {0.01, 0.3, 0.99}) {
      const double x = scaled.sample([u] { return u; });
      CHECK(std::fabs(x - plain.sample([u] { return u; })) <= 1e-13);
      CHECK(scaled.pdf(x) == Approx(plain.pdf(x)).epsilon(1e-13));
      CHECK(scaled.invert(x) == Approx(u).epsilon(1e-13));
    }
  }
}

TEST_CASE("Any uniform number in [0, 1) gives a sample inside the domain") {
  for (const double u : {0.0, 0x1p-53, 1 - 0x1p-53}) {
    for_each_density([u](const char* name, const auto& technique, const auto&) {
      INFO(name << ", u " << u);
      const double x = technique.sample([u] { return u; });
      CHECK(technique.domain().contains(x));
      CHECK(std::fabs(technique.invert(x) - u) <= 2e-14);
    });
  }
}

TEST_CASE("Outside its domain a density is 0") {
  const density technique([](double) { return 1.0; }, interval(-1, 1));
  CHECK(technique.pdf(-1.0000001) == 0);
  CHECK(technique.pdf(1.0000001) == 0);
  CHECK(technique.invert(-2) == 0);
  CHECK(technique.invert(2) == 1);
}
