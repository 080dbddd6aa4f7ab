// SPDX-License-Identifier: MIT
#ifndef PHIMIS_TESTS_COLOUR_HPP
#define PHIMIS_TESTS_COLOUR_HPP

/// A colour of three components, as a renderer has one: what value_traits asks of a value type and no more.
template <class Real>
struct colour {
  using value_type = Real;
  Real c[3] = {};

  constexpr Real& operator[](int i) { return c[i]; }
  constexpr const Real& operator[](int i) const { return c[i]; }
  friend constexpr colour operator+(colour a, const colour& b) {
    for (int i = 0; i < 3; ++i) a[i] += b[i];
    return a;
  }
  friend constexpr colour operator-(colour a, const colour& b) {
    for (int i = 0; i < 3; ++i) a[i] -= b[i];
    return a;
  }
  friend constexpr colour operator*(colour a, const colour& b) {
    for (int i = 0; i < 3; ++i) a[i] *= b[i];
    return a;
  }
  friend constexpr colour operator*(colour a, Real s) {
    for (int i = 0; i < 3; ++i) a[i] *= s;
    return a;
  }
};

#endif  // PHIMIS_TESTS_COLOUR_HPP
