// SPDX-License-Identifier: MIT
// observation.hpp, table.hpp
#include "catch.hpp"
#include "random.hpp"

#include <phimis/core/observation.hpp>
#include <phimis/core/table.hpp>

#include <cmath>
#include <limits>
#include <type_traits>

namespace {

template <class Real>
using observation = phimis::observation<Real, 3>;
template <class Real>
using row = phimis::row<Real, 3>;

template <class Real>
observation<Real> sound() {
  return {Real(-6), {{1, 2, 5}}, Real(4), 1};
}

}  // namespace

TEMPLATE_TEST_CASE("A row is |f| / sum p, sum p / q and p / sum p", "", float, double) {
  row<TestType> r{};
  REQUIRE(phimis::to_row(sound<TestType>(), r));
  CHECK(r.u == TestType(0.75));
  CHECK(r.w == 2);
  CHECK(r.y[0] == TestType(0.125));
  CHECK(r.y[1] == TestType(0.25));
  CHECK(r.y[2] == TestType(0.625));
}

TEMPLATE_TEST_CASE("A factor of f multiplies u and nothing else", "", float, double) {
  row<TestType> r{}, scaled{};
  REQUIRE(phimis::to_row(sound<TestType>(), r));
  for (const TestType c : {std::numeric_limits<TestType>::max() / 16, std::numeric_limits<TestType>::min() * 16}) {
    auto o = sound<TestType>();
    o.f *= c;
    REQUIRE(phimis::to_row(o, scaled));
    CHECK(scaled.u == r.u * c);
    CHECK(scaled.w == r.w);
    for (int k = 0; k < 3; ++k) CHECK(scaled.y[k] == r.y[k]);
  }
}

TEMPLATE_TEST_CASE("A change of measure changes nothing", "", float, double) {
  // f, p and q are multiplied by the same Jacobian, a power of two: exact.
  row<TestType> r{}, changed{};
  REQUIRE(phimis::to_row(sound<TestType>(), r));
  for (const int exponent : {-100, -20, 30, 100}) {
    const TestType jacobian = std::ldexp(TestType(1), exponent);
    auto o = sound<TestType>();
    o.f *= jacobian;
    o.q *= jacobian;
    for (int k = 0; k < 3; ++k) o.pdfs[k] *= jacobian;
    REQUIRE(phimis::to_row(o, changed));
    CHECK(changed.u == r.u);
    CHECK(changed.w == r.w);
    for (int k = 0; k < 3; ++k) CHECK(changed.y[k] == r.y[k]);
  }
}

TEMPLATE_TEST_CASE("What is not finite, negative or without density is no observation", "", float, double) {
  using limits = std::numeric_limits<TestType>;
  row<TestType> r{};
  for (const TestType bad : {limits::quiet_NaN(), limits::infinity(), -limits::infinity()}) {
    auto o = sound<TestType>();
    o.f = bad;
    CHECK_FALSE(phimis::to_row(o, r));
    o = sound<TestType>();
    o.q = bad;
    CHECK_FALSE(phimis::to_row(o, r));
    for (int k = 0; k < 3; ++k) {
      o = sound<TestType>();
      o.pdfs[k] = bad;
      CHECK_FALSE(phimis::to_row(o, r));
    }
  }
  for (int k = 0; k < 3; ++k) {
    auto o = sound<TestType>();
    o.pdfs[k] = TestType(-0.001);
    CHECK_FALSE(phimis::to_row(o, r));
  }
  auto o = sound<TestType>();
  o.q = 0;
  CHECK_FALSE(phimis::to_row(o, r));
  o.q = -1;
  CHECK_FALSE(phimis::to_row(o, r));
  o = sound<TestType>();
  o.pdfs = {};
  CHECK_FALSE(phimis::to_row(o, r));
}

TEMPLATE_TEST_CASE("A quotient that overflows is no observation", "", float, double) {
  using limits = std::numeric_limits<TestType>;
  row<TestType> r{};
  auto o = sound<TestType>();
  o.f = limits::max();
  o.pdfs = {{limits::min(), 0, 0}};
  CHECK_FALSE(phimis::to_row(o, r));  // u
  o = sound<TestType>();
  o.q = limits::min();
  o.pdfs[0] = limits::max();
  CHECK_FALSE(phimis::to_row(o, r));  // w
  o = sound<TestType>();
  for (int k = 0; k < 3; ++k) o.pdfs[k] = limits::max();
  CHECK_FALSE(phimis::to_row(o, r));  // Σp
}

TEMPLATE_TEST_CASE("f = 0 and a single pdf of 0 are observations", "", float, double) {
  row<TestType> r{};
  auto o = sound<TestType>();
  o.f = 0;
  REQUIRE(phimis::to_row(o, r));
  CHECK(r.u == 0);
  o.pdfs[1] = 0;
  REQUIRE(phimis::to_row(o, r));
  CHECK(r.y[1] == 0);
}

TEMPLATE_TEST_CASE("A fixed table holds what it has room for and refuses the rest", "", float, double) {
  phimis::fixed_table<TestType, 3, 4> table;
  CHECK(table.size() == 0);
  CHECK(table.view().n == 0);
  for (int j = 0; j < 6; ++j) {
    const TestType x = static_cast<TestType>(j);
    CHECK(table.push({x, 10 + x, {20 + x, 30 + x, 40 + x}}) == (j < 4));
  }
  REQUIRE(table.size() == 4);
  const auto view = table.view();
  REQUIRE(view.n == 4);
  for (int j = 0; j < 4; ++j) {
    const TestType x = static_cast<TestType>(j);
    const auto r = table[j];
    CHECK(r.u == x);
    CHECK(r.w == 10 + x);
    CHECK(view.u[j] == r.u);
    CHECK(view.w[j] == r.w);
    for (int k = 0; k < 3; ++k) {
      CHECK(r.y[k] == static_cast<TestType>(20 + 10 * k) + x);
      CHECK(view.y[k][j] == r.y[k]);
    }
  }
  static_assert(std::is_trivially_copyable<phimis::fixed_table<TestType, 3, 4>>::value, "");
  static_assert(std::is_same<typename decltype(table)::real, TestType>::value && decltype(table)::techniques == 3, "");
}
