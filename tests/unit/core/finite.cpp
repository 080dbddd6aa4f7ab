// SPDX-License-Identifier: MIT
// finite.hpp, uniform.hpp, value.hpp
#include "catch.hpp"
#include "colour.hpp"
#include "random.hpp"

#include <phimis/core/finite.hpp>
#include <phimis/core/uniform.hpp>
#include <phimis/core/value.hpp>

#include <cmath>
#include <cstdint>
#include <limits>

TEMPLATE_TEST_CASE("A number is finite unless it is NaN or infinite", "", float, double) {
  using limits = std::numeric_limits<TestType>;
  for (const TestType x : {TestType(0), TestType(1), limits::max(), limits::min(), limits::denorm_min()}) {
    CHECK(phimis::is_finite(x));
    CHECK(phimis::is_finite(-x));
  }
  for (const TestType x : {limits::infinity(), limits::quiet_NaN(), limits::signaling_NaN()}) {
    CHECK_FALSE(phimis::is_finite(x));
    CHECK_FALSE(phimis::is_finite(-x));
  }
}

TEMPLATE_TEST_CASE("A density is finite and not negative", "", float, double) {
  using limits = std::numeric_limits<TestType>;
  CHECK(phimis::is_density(TestType(0)));
  CHECK(phimis::is_density(-TestType(0)));
  CHECK(phimis::is_density(limits::denorm_min()));
  CHECK(phimis::is_density(limits::max()));
  CHECK_FALSE(phimis::is_density(-limits::denorm_min()));
  CHECK_FALSE(phimis::is_density(TestType(-1)));
  CHECK_FALSE(phimis::is_density(limits::infinity()));
  CHECK_FALSE(phimis::is_density(limits::quiet_NaN()));
}

TEMPLATE_TEST_CASE("Uniform numbers lie in [0, 1) for any bits", "", float, double) {
  constexpr int digits = std::numeric_limits<TestType>::digits;
  constexpr std::uint64_t ones = ~std::uint64_t(0);
  static_assert(phimis::uniform<TestType>(0) == 0, "");
  static_assert(phimis::uniform<TestType>(ones) < 1, "");
  CHECK(phimis::uniform<TestType>(ones) == 1 - std::ldexp(TestType(1), -digits));
  CHECK(phimis::uniform<TestType>(std::uint64_t(1) << 63) == TestType(0.5));
  // The lowest bit that counts, and all bits below it.
  CHECK(phimis::uniform<TestType>(std::uint64_t(1) << (64 - digits)) == std::ldexp(TestType(1), -digits));
  CHECK(phimis::uniform<TestType>((std::uint64_t(1) << (64 - digits)) - 1) == 0);
  random_numbers random(1);
  for (int i = 0; i < 1000; ++i) {
    const std::uint64_t bits = random.bits();
    const TestType u = phimis::uniform<TestType>(bits);
    // Exact in long double: u is the bits cut to its precision.
    const long double wanted = std::ldexp(static_cast<long double>(bits >> (64 - digits)), -digits);
    REQUIRE(static_cast<long double>(u) == wanted);
  }
}

TEMPLATE_TEST_CASE("The magnitude of a number is its absolute value", "", float, double) {
  using traits = phimis::value_traits<TestType>;
  CHECK(traits::zero() == 0);
  CHECK(traits::magnitude(TestType(-3)) == 3);
  CHECK(traits::magnitude(TestType(3)) == 3);
  CHECK(traits::root(TestType(9)) == 3);
  CHECK(traits::finite(TestType(1)));
  CHECK_FALSE(traits::finite(std::numeric_limits<TestType>::infinity()));
}

TEMPLATE_TEST_CASE("The magnitude of a colour is its Rec. 709 luminance", "", float, double) {
  using traits = phimis::value_traits<colour<TestType>>;
  const auto luminance = [](double r, double g, double b) {
    return traits::magnitude({{static_cast<TestType>(r), static_cast<TestType>(g), static_cast<TestType>(b)}});
  };
  // The coefficients of white sum to one: 3 roundings.
  CHECK(std::fabs(luminance(1, 1, 1) - 1) <= 2 * std::numeric_limits<TestType>::epsilon());
  CHECK(luminance(1, 0, 0) == TestType(0.2126));
  CHECK(luminance(0, 1, 0) == TestType(0.7152));
  CHECK(luminance(0, 0, 1) == TestType(0.0722));
  CHECK(luminance(0, 0, -1) == TestType(0.0722));
  CHECK(traits::magnitude(traits::zero()) == 0);
  const auto root = traits::root({{4, 9, 16}});
  CHECK(root[0] == 2);
  CHECK(root[1] == 3);
  CHECK(root[2] == 4);
  for (int i = 0; i < 3; ++i) {
    colour<TestType> c{{1, 1, 1}};
    CHECK(traits::finite(c));
    c[i] = std::numeric_limits<TestType>::quiet_NaN();
    CHECK_FALSE(traits::finite(c));
  }
}
