// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_LIMITS_HPP
#define PHIMIS_CORE_LIMITS_HPP

#include <limits>

namespace phimis {

// std::numeric_limits as constants: device code may not call its functions.

/// The distance from 1 to the next number.
template <class Real>
inline constexpr Real epsilon = std::numeric_limits<Real>::epsilon();

/// The smallest positive number with all its digits.
template <class Real>
inline constexpr Real smallest_normal = std::numeric_limits<Real>::min();

template <class Real>
inline constexpr Real largest = std::numeric_limits<Real>::max();

template <class Real>
inline constexpr Real infinity = std::numeric_limits<Real>::infinity();

}  // namespace phimis

#endif  // PHIMIS_CORE_LIMITS_HPP
