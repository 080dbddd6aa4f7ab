// SPDX-License-Identifier: MIT
// Powers of several numbers at once: those of std::pow but for rounding, and the right ends.
#include "catch.hpp"
#include "random.hpp"

#include <phimis/core/pack_power.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace {

using phimis::detail::pack;
using phimis::detail::pack_width;
using phimis::detail::power_of_packs;

template <class Real>
Real first_of(const pack<Real>& v) {
  Real lanes[pack_width<Real>];
  phimis::detail::store(lanes, v);
  return lanes[0];
}

template <class Real>
Real power(Real t, Real beta) {
  Real lanes[pack_width<Real>];
  std::fill_n(lanes, pack_width<Real>, t);
  return first_of<Real>(power_of_packs<Real>(beta)(phimis::detail::load<pack<Real>>(lanes)));
}

/// In units of ε. A result has one of its own, and that of log2 m, |log2 m| <= ½, is multiplied by β.
double allowed([[maybe_unused]] double beta, [[maybe_unused]] double t) {
#ifdef __FAST_MATH__  // which adds the two halves of β before they meet the exponent
  return 8 + std::fabs(beta) + std::fabs(beta * std::log2(t)) / 2;
#else
  return 2 + std::fabs(beta);
#endif
}

}  // namespace

TEMPLATE_TEST_CASE("Powers of packs are those of long double, to a few units in the last place", "", float, double) {
  using limits = std::numeric_limits<TestType>;
  random_numbers next(8);
  const double decades = sizeof(TestType) == 8 ? 307 : 37;
  for (int i = 0; i < 200000; ++i) {
    const auto beta = static_cast<TestType>((i % 3 == 0 ? -1 : 1) * next.over_decades(0.01, 20));
    const auto t = static_cast<TestType>(std::pow(10.0, i % 2 == 0 ? next.between(-4, 1) : decades * next.between(-1, 1)));
    const long double exact = std::pow(static_cast<long double>(t), static_cast<long double>(beta));
    if (!(exact > static_cast<long double>(limits::min())) || !(2 * exact < static_cast<long double>(limits::max())))
      continue;
    const auto off = static_cast<double>((static_cast<long double>(power(t, beta)) - exact) / exact);
    INFO(t << "^" << beta);
    REQUIRE(std::fabs(off) <= allowed(static_cast<double>(beta), static_cast<double>(t)) *
                                  static_cast<double>(limits::epsilon()));
  }
}

TEMPLATE_TEST_CASE("Every lane has its own power", "", float, double) {
  TestType lanes[pack_width<TestType>], powers[pack_width<TestType>];
  for (std::ptrdiff_t l = 0; l < pack_width<TestType>; ++l) lanes[l] = static_cast<TestType>(l * l);
  phimis::detail::store(powers, power_of_packs<TestType>(TestType(1.5))(phimis::detail::load<pack<TestType>>(lanes)));
  for (std::ptrdiff_t l = 0; l < pack_width<TestType>; ++l) {
    CHECK(static_cast<double>(powers[l]) == Approx(static_cast<double>(l * l * l)).epsilon(1e-6));
  }
}

TEMPLATE_TEST_CASE("Powers of packs at the ends of the range", "", float, double) {
  using limits = std::numeric_limits<TestType>;
  const TestType infinity = limits::infinity();
  for (const TestType beta : {TestType(0.01), TestType(0.3), TestType(1.5), TestType(40)}) {
    CHECK(power(TestType(1), beta) == 1);
    CHECK(power(TestType(1), -beta) == 1);
    CHECK(power(TestType(0), beta) == 0);
    CHECK(power(TestType(0), -beta) == infinity);
  }
  CHECK(power(limits::min(), TestType(2)) == 0);
  CHECK(power(limits::min(), TestType(-2)) == infinity);
  CHECK(power(limits::max(), TestType(2)) == infinity);
  CHECK(power(limits::max(), TestType(-2)) == 0);
  CHECK(power(TestType(2), TestType(10)) == 1024);
#ifndef __FAST_MATH__  // which may take it for 0
  const TestType least = limits::denorm_min();
  CHECK(static_cast<double>(power(least, TestType(0.1))) ==
        Approx(std::pow(static_cast<double>(least), 0.1)).epsilon(1e-5));
#endif
}
