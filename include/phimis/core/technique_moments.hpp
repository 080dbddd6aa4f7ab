// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_TECHNIQUE_MOMENTS_HPP
#define PHIMIS_CORE_TECHNIQUE_MOMENTS_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/limits.hpp>
#include <phimis/core/moments.hpp>
#include <phimis/core/rule.hpp>

#include <cmath>
#include <cstdint>

namespace phimis {

/// Running mean and variance of one number for each technique, of that technique's own samples.
///
/// Kept in units of a power of two that follows the largest number, so that no scale of f overflows a square and a factor
/// of two changes no digit.
template <class Real, int M>
class technique_moments {
 public:
  PHIMIS_HOST_DEVICE void add(int technique, Real value) noexcept {
    PHIMIS_EXPECTS(technique >= 0 && technique < M);
    const Real size = value < 0 ? -value : value;
    if (size > 0 && !(size <= unit_ * far)) change_unit(unit_near(size));
    of_[technique].add(unit_ > 0 ? value / unit_ : Real(0));
    if (size > 0) any_ = true;
  }

  PHIMIS_HOST_DEVICE void merge(const technique_moments& other) noexcept {
    technique_moments theirs = other;
    if (theirs.unit_ > unit_) change_unit(theirs.unit_);
    if (theirs.unit_ > 0) theirs.change_unit(unit_);
    for (int k = 0; k < M; ++k) of_[k].merge(theirs.of_[k]);
    any_ = any_ || theirs.any_;
  }

  PHIMIS_HOST_DEVICE std::int64_t count(int technique) const noexcept { return of_[technique].count; }

  /// Samples of all techniques.
  PHIMIS_HOST_DEVICE std::int64_t count() const noexcept {
    std::int64_t n = 0;
    for (int k = 0; k < M; ++k) n += of_[k].count;
    return n;
  }

  /// Whether any number was not 0.
  PHIMIS_HOST_DEVICE bool any() const noexcept { return any_; }

  /// Whether any number of a technique was not 0.
  PHIMIS_HOST_DEVICE bool any(int technique) const noexcept {
    return of_[technique].mean != 0 || of_[technique].squares > 0;
  }

  /// Whether a technique has a spread: two samples.
  PHIMIS_HOST_DEVICE bool known(int technique) const noexcept { return of_[technique].count > 1; }

  /// Standard deviation of one number, in a unit that all techniques share; 0 where it is not known, and where it is no
  /// more than the rounding of equal numbers.
  PHIMIS_HOST_DEVICE Real deviation(int technique) const noexcept {
    const moments<Real>& own = of_[technique];
    const Real sigma = std::sqrt(own.variance());
    return sigma > 32 * epsilon<Real> * (own.mean < 0 ? -own.mean : own.mean) ? sigma : Real(0);
  }

 private:
  static constexpr Real far = Real(1 << 30);  // its square, times any count, is still a float

  PHIMIS_HOST_DEVICE void change_unit(Real unit) noexcept {
    const Real ratio = unit_ / unit;
    for (int k = 0; k < M; ++k) {
      of_[k].mean *= ratio;
      of_[k].squares *= ratio * ratio;
    }
    unit_ = unit;
  }

  /// A power of two within a factor of 2, whose inverse is a number too.
  PHIMIS_HOST_DEVICE static Real unit_near(Real size) noexcept {
    int exponent = 0;
    (void)std::frexp(size, &exponent);
    constexpr int least = sizeof(Real) == 8 ? -1000 : -120;
    return std::ldexp(Real(1), exponent > least ? exponent - 1 : least);
  }

  moments<Real> of_[M]{};
  Real unit_ = 0;  // 0 before the first number that is not 0
  bool any_ = false;
};

}  // namespace phimis

#endif  // PHIMIS_CORE_TECHNIQUE_MOMENTS_HPP
