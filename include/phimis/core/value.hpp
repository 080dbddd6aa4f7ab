// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_VALUE_HPP
#define PHIMIS_CORE_VALUE_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/finite.hpp>
#include <phimis/core/limits.hpp>

#include <cmath>
#include <type_traits>

namespace phimis {

/// What the library must know of an integrand's value type. Estimates are of that type; fractions are learnt from one
/// scalar, the magnitude.
///
/// This template serves colours of three components: a type with `value_type`, `operator[]`, component-wise `+ - *`
/// and a product with a scalar, zero when value-initialised; magnitude is the Rec. 709 luminance. Specialise it for
/// any other type. `unknown` is the variance of what has none yet.
template <class Value, class = void>
struct value_traits {
  using real = typename Value::value_type;

  PHIMIS_HOST_DEVICE static Value zero() { return Value{}; }
  PHIMIS_HOST_DEVICE static Value unknown() {
    Value all{};
    for (int i = 0; i < 3; ++i) all[i] = infinity<real>;
    return all;
  }
  PHIMIS_HOST_DEVICE static real magnitude(const Value& v) {
    const real luminance = real(0.2126) * v[0] + real(0.7152) * v[1] + real(0.0722) * v[2];
    return luminance < 0 ? -luminance : luminance;
  }
  PHIMIS_HOST_DEVICE static Value root(const Value& v) {
    Value roots = v;
    for (int i = 0; i < 3; ++i) roots[i] = std::sqrt(v[i]);
    return roots;
  }
  PHIMIS_HOST_DEVICE static bool finite(const Value& v) {
    return is_finite(v[0]) && is_finite(v[1]) && is_finite(v[2]);
  }
};

/// Numbers: the magnitude is the absolute value.
template <class Value>
struct value_traits<Value, std::enable_if_t<std::is_floating_point<Value>::value>> {
  using real = Value;

  PHIMIS_HOST_DEVICE static constexpr Value zero() noexcept { return 0; }
  PHIMIS_HOST_DEVICE static constexpr Value unknown() noexcept { return infinity<Value>; }
  PHIMIS_HOST_DEVICE static constexpr real magnitude(Value v) noexcept { return v < 0 ? -v : v; }
  PHIMIS_HOST_DEVICE static Value root(Value v) noexcept { return std::sqrt(v); }
  PHIMIS_HOST_DEVICE static bool finite(Value v) noexcept { return is_finite(v); }
};

}  // namespace phimis

#endif  // PHIMIS_CORE_VALUE_HPP
