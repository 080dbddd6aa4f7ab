// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_MOMENTS_HPP
#define PHIMIS_CORE_MOMENTS_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/value.hpp>

#include <cstdint>

namespace phimis {

/// Running mean and variance of a value: a number, or a colour by component.
///
/// Source Welford 1962; the merge is Chan, Golub & LeVeque 1979. Any grouping gives the same up to rounding.
template <class Value>
struct moments {
  using real = typename value_traits<Value>::real;

  std::int64_t count = 0;
  Value mean = value_traits<Value>::zero();
  Value squares = value_traits<Value>::zero();  ///< Σ (x − mean)²

  PHIMIS_HOST_DEVICE void add(const Value& x) {
    ++count;
    const Value before = x - mean;
    mean = mean + before * (real(1) / static_cast<real>(count));
    squares = squares + before * (x - mean);
  }

  PHIMIS_HOST_DEVICE void merge(const moments& other) {
    if (other.count == 0) return;
    const real total = static_cast<real>(count + other.count);
    const real share = static_cast<real>(other.count) / total;
    const Value difference = other.mean - mean;
    mean = mean + difference * share;
    squares = squares + other.squares + difference * difference * (static_cast<real>(count) * share);
    count += other.count;
  }

  /// Unbiased variance of one value; 0 with fewer than two.
  PHIMIS_HOST_DEVICE Value variance() const {
    return count > 1 ? Value(squares * (real(1) / static_cast<real>(count - 1))) : value_traits<Value>::zero();
  }
};

}  // namespace phimis

#endif  // PHIMIS_CORE_MOMENTS_HPP
