// SPDX-License-Identifier: MIT
#ifndef PHIMIS_INTERVAL_HPP
#define PHIMIS_INTERVAL_HPP

#include <phimis/error.hpp>

#include <limits>
#include <string>

namespace phimis {

/// A domain [lower, upper] of the real line; either end may be infinite.
///
/// Errors std::invalid_argument where it is empty.
class interval {
 public:
  constexpr interval() = default;
  interval(double lower, double upper) : lower_(lower), upper_(upper) {
    require(lower < upper, "interval.upper", "must be greater than interval.lower, " + std::to_string(lower), upper);
  }

  constexpr double lower() const noexcept { return lower_; }
  constexpr double upper() const noexcept { return upper_; }
  constexpr double length() const noexcept { return upper_ - lower_; }
  constexpr bool contains(double x) const noexcept { return x >= lower_ && x <= upper_; }
  constexpr bool bounded() const noexcept { return length() < std::numeric_limits<double>::infinity(); }

 private:
  double lower_ = -std::numeric_limits<double>::infinity();
  double upper_ = std::numeric_limits<double>::infinity();
};

}  // namespace phimis

#endif  // PHIMIS_INTERVAL_HPP
