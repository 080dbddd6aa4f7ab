// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_FINITE_HPP
#define PHIMIS_CORE_FINITE_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/limits.hpp>

#include <cstdint>
#include <cstring>

namespace phimis {

/// True unless the value is NaN or infinite, decided on its bits.
///
/// `std::isfinite` is a constant under -ffast-math, which renderers use; the bits are not.
PHIMIS_HOST_DEVICE inline bool is_finite(float value) noexcept {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  return (bits & 0x7f800000u) != 0x7f800000u;
}

/// \copydoc is_finite(float)
PHIMIS_HOST_DEVICE inline bool is_finite(double value) noexcept {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  return (bits & 0x7ff0000000000000u) != 0x7ff0000000000000u;
}

/// True for a value that a probability density can have: finite and not negative.
template <class Real>
PHIMIS_HOST_DEVICE bool is_density(Real value) noexcept {
  return is_finite(value) && value >= Real(0);
}

/// Whether a number is a positive one of Real, too, but for its rounding.
template <class Real>
PHIMIS_HOST_DEVICE bool is_positive_as(double x) noexcept {
  return is_finite(x) && x <= static_cast<double>(largest<Real>) && static_cast<Real>(x) > 0;
}

}  // namespace phimis

#endif  // PHIMIS_CORE_FINITE_HPP
