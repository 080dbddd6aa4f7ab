// SPDX-License-Identifier: MIT
#ifndef PHIMIS_TESTS_SUBNORMALS_HPP
#define PHIMIS_TESTS_SUBNORMALS_HPP

#include <limits>

/// Whether the processor takes numbers below the smallest normal one for 0, as -ffast-math makes it. A test that is made of
/// them is then a test of zeros.
inline bool subnormals_are_zero() {
  volatile double least = std::numeric_limits<double>::min();
  volatile double half = least / 2;
  return !(half > 0);
}

#endif  // PHIMIS_TESTS_SUBNORMALS_HPP
