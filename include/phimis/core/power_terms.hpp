// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_POWER_TERMS_HPP
#define PHIMIS_CORE_POWER_TERMS_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/pack.hpp>

#include <cmath>

namespace phimis::detail {

/// p s/q of one row in the power family, w x t^β with t = u/x, r = 1/x. Where s/t is simple, no power of t is formed.
struct power_half {
  static constexpr bool packed = true;
  template <class Real, class V>
  PHIMIS_HOST_DEVICE V term(const V& w, const V& u, const V& x, const V&) const noexcept {
    return w * square_root<Real>(u * x);
  }
};
struct power_one {
  static constexpr bool packed = true;
  template <class Real, class V>
  PHIMIS_HOST_DEVICE V term(const V& w, const V& u, const V&, const V&) const noexcept {
    return w * u;
  }
};
struct power_two {
  static constexpr bool packed = true;
  template <class Real, class V>
  PHIMIS_HOST_DEVICE V term(const V& w, const V& u, const V&, const V& r) const noexcept {
    return w * u * (u * r);
  }
};
struct power_any {
  static constexpr bool packed = false;
  double beta;
  template <class Real, class V>
  PHIMIS_HOST_DEVICE V term(const V& w, const V& u, const V& x, const V& r) const noexcept {
    return w * x * std::pow(u * r, static_cast<Real>(beta));
  }
};

}  // namespace phimis::detail

#endif  // PHIMIS_CORE_POWER_TERMS_HPP
