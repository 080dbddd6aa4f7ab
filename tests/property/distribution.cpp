// SPDX-License-Identifier: MIT
// distribution.hpp, gaussian.hpp
#include "techniques.hpp"

#include <phimis/core/finite.hpp>
#include <phimis/technique/distribution.hpp>
#include <phimis/technique/gaussian.hpp>

#include <boost/math/distributions/beta.hpp>
#include <boost/math/distributions/cauchy.hpp>
#include <boost/math/distributions/exponential.hpp>
#include <boost/math/distributions/gamma.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/quadrature/gauss_kronrod.hpp>

#include <cmath>
#include <limits>
#include <utility>

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
using phimis::distribution;
using phimis::gaussian;
using phimis::interval;

/// test(name, technique, low, high)
template <class Test>
void for_each_technique(Test&& test) {
  test("gaussian", gaussian(2, 0.5), -3, 7);
  test("gaussian, truncated", gaussian(2, 1, {0.01, 11}), 0.01, 11);
  test("gaussian, right half", gaussian(1, 2, {1, infinity}), 1, 30);
  test("gaussian, left half", gaussian(1, 2, {-infinity, 1}), -30, 1);
  test("gaussian, upper tail", gaussian(0, 1, {8, 9}), 8, 9);
  test("gaussian, lower tail", gaussian(0, 1, {-9, -8}), -9, -8);
  test("gaussian, far upper tail", gaussian(0, 1, {30, infinity}), 30, 36);
  test("gaussian, far lower tail", gaussian(0, 1, {-infinity, -30}), -36, -30);
  test("exponential", distribution(boost::math::exponential(2)), 0, 30);
  test("exponential, truncated", distribution(boost::math::exponential(2), interval(1, 3)), 1, 3);
  test("exponential, upper tail", distribution(boost::math::exponential(2), interval(50, 60)), 50, 60);
  test("beta", distribution(boost::math::beta_distribution<>(2, 5)), 0, 1);
  test("beta, truncated", distribution(boost::math::beta_distribution<>(2, 5), interval(0.25, 0.75)), 0.25, 0.75);
  test("gamma, truncated", distribution(boost::math::gamma_distribution<>(3, 2), interval(0.5, 20)), 0.5, 20);
  test("cauchy, truncated", distribution(boost::math::cauchy(1, 2), interval(-10, 50)), -10, 50);
  test("student, truncated", distribution(boost::math::students_t(3), interval(-4, 9)), -4, 9);
}

}  // namespace

TEST_CASE("sample, pdf and invert of a distribution agree") {
  for_each_technique([](const char* name, const auto& technique, double low, double high) {
    INFO(name);
    check_triad(technique, low, high);
  });
}

TEST_CASE("The pdf of a truncated distribution integrates to one and is 0 outside") {
  for_each_technique([](const char* name, const auto& technique, double low, double high) {
    INFO(name);
    double error = 0;
    const double mass = boost::math::quadrature::gauss_kronrod<double, 61>::integrate(
        [&](double x) { return technique.pdf(x); }, low, high, 15, 1e-13, &error);
    CHECK(std::fabs(mass - 1) <= 1e-12 + error);
    if (technique.domain().bounded()) {
      CHECK(technique.pdf(std::nextafter(low, -infinity)) == 0);
      CHECK(technique.pdf(std::nextafter(high, infinity)) == 0);
      CHECK(technique.invert(low - 1) == 0);
      CHECK(technique.invert(high + 1) == 1);
    }
    CHECK(technique.pdf(std::numeric_limits<double>::quiet_NaN()) == 0);
  });
}

TEST_CASE("Samples of a distribution follow it") {
  for_each_technique([](const char* name, const auto& technique, double, double) {
    INFO(name);
    CHECK(goodness_of_fit(technique, 1) > 1e-6);  // 16 tests: one false alarm in 60000 runs
  });
}

TEST_CASE("The pdf is the untruncated one over the probability of the domain") {
  const gaussian truncated(1, 2, {0, 4});
  const boost::math::normal whole(1, 2);
  const double mass = cdf(whole, 4) - cdf(whole, 0);
  for (const double x : {0.0, 0.7, 4.0}) CHECK(truncated.pdf(x) == Approx(pdf(whole, x) / mass).epsilon(1e-14));
}

TEST_CASE("A domain that reaches beyond the support ends with it") {
  const distribution technique(boost::math::exponential(1), interval(-5, 1));
  CHECK(technique.pdf(-1) == 0);
  CHECK(technique.invert(-1) == 0);
  CHECK(technique.domain().lower() == -5);
  CHECK(technique.pdf(0.5) == Approx(std::exp(-0.5) / (1 - std::exp(-1))).epsilon(1e-14));
  CHECK(technique.sample([] { return 0.0; }) >= 0);
}

TEST_CASE("Any uniform number in [0, 1) gives a finite sample, also on unbounded domains") {
  for (const double u : {0.0, 0x1p-53, 1 - 0x1p-53}) {
    INFO("u " << u);
    for_each_technique([u](const char* name, const auto& technique, double, double) {
      INFO(name);
      const double x = technique.sample([u] { return u; });
      CHECK(phimis::is_finite(x));
      CHECK(technique.domain().contains(x));
    });
    CHECK(phimis::is_finite(gaussian(0, 1, {0, infinity}).sample([u] { return u; })));
    CHECK(phimis::is_finite(gaussian(0, 1, {-0.3, infinity}).sample([u] { return u; })));
    CHECK(phimis::is_finite(distribution(boost::math::cauchy()).sample([u] { return u; })));
    CHECK(phimis::is_finite(distribution(boost::math::students_t(3)).sample([u] { return u; })));
  }
}

TEST_CASE("A density that is infinite at an end is infinite there, not an exception") {
  const distribution technique(boost::math::beta_distribution<>(0.5, 0.5));
  CHECK(technique.pdf(0) == infinity);
  CHECK(technique.pdf(1) == infinity);
  CHECK(technique.sample([] { return 1 - 1e-12; }) == 1);  // 1 − x = 2e-24
}
