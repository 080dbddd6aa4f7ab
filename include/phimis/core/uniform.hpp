// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_UNIFORM_HPP
#define PHIMIS_CORE_UNIFORM_HPP

#include <phimis/core/config.hpp>

#include <cstdint>

namespace phimis {

/// Uniform number in [0, 1) from 64 random bits: the upper 53 (double) or 24 (float) of them.
///
///     u = floor(bits / 2^(64-d)) · 2^-d,   d = 53 or 24
///
/// The standard library's distributions differ between vendors and may return 1; this does neither.
template <class Real = double>
PHIMIS_HOST_DEVICE constexpr Real uniform(std::uint64_t bits) noexcept;

template <>
PHIMIS_HOST_DEVICE constexpr double uniform<double>(std::uint64_t bits) noexcept {
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

template <>
PHIMIS_HOST_DEVICE constexpr float uniform<float>(std::uint64_t bits) noexcept {
  return static_cast<float>(bits >> 40) * 0x1p-24f;
}

}  // namespace phimis

#endif  // PHIMIS_CORE_UNIFORM_HPP
