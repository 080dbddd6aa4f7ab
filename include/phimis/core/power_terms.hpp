// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_POWER_TERMS_HPP
#define PHIMIS_CORE_POWER_TERMS_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/divergence.hpp>
#include <phimis/core/pack.hpp>
#include <phimis/core/pack_power.hpp>

#include <type_traits>

namespace phimis::detail {

/// A row's s/q = w t^β and p s/q = w x t^β.
///
/// The first is not the second over x: where no fraction reaches the row, x is near the smallest number, and w x is none.
template <class V>
struct power_term {
  V score;
  V part;
};

/// 1/x of a row whose terms are all multiples of f = u. A row that no fraction reaches has x near the smallest
/// number, and compilers that multiply in any order take (u r)² for u² r², 0 · ∞ where u is 0.
template <class Real, class V>
PHIMIS_HOST_DEVICE V inverse_of(const V& x, [[maybe_unused]] const V& u) noexcept {
#ifdef __FAST_MATH__
  return u == V{} ? V{} : Real(1) / x;
#else
  return Real(1) / x;
#endif
}

/// The terms of one row in the power family, t = u/x, r = 1/x. Where s/t is simple, no power of t is formed.
struct power_half {
  static constexpr bool packed = true;
  template <class Real, class V>
  PHIMIS_HOST_DEVICE power_term<V> term(const V& w, const V& u, const V& x, const V& r) const noexcept {
    const V score = w * square_root<Real>(u * r);  // u x may vanish where u/x does not
    return {score, x * score};
  }
};
struct power_one {
  static constexpr bool packed = true;
  template <class Real, class V>
  PHIMIS_HOST_DEVICE power_term<V> term(const V& w, const V& u, const V&, const V& r) const noexcept {
    const V part = w * u;
    return {part * r, part};
  }
};
struct power_two {
  static constexpr bool packed = true;
  template <class Real, class V>
  PHIMIS_HOST_DEVICE power_term<V> term(const V& w, const V& u, const V&, const V& r) const noexcept {
    const V part = w * u * (u * r);
    return {part * r, part};
  }
};
struct power_any {
  static constexpr bool packed = true;
  double beta;
  template <class Real, class V>
  PHIMIS_HOST_DEVICE power_term<V> term(const V& w, const V& u, const V& x, const V& r) const noexcept {
    const V score = w * power_of_packs<Real>(static_cast<Real>(beta))(u * r);
    return {score, x * score};
  }
};

/// Whether the exponent of a divergence is known from its type.
template <class Divergence>
struct exponent_is_constant : std::is_empty<Divergence> {};
template <class Divergence>
struct exponent_is_constant<reversed<Divergence>> : exponent_is_constant<Divergence> {};

/// Whether the score may be other than a power of t.
template <class Divergence, class = void>
struct needs_any_score : std::true_type {};
template <class Divergence>
struct needs_any_score<Divergence,
                       std::enable_if_t<has_exponent<Divergence>::value && exponent_is_constant<Divergence>::value>>
    : std::bool_constant<Divergence{}.exponent() == 0> {};

/// Calls use(power, exponent) with the power that fits. False, and no call, where the score is no power of t.
template <class Divergence, class Use>
PHIMIS_HOST_DEVICE bool with_power(const Divergence& divergence, const Use& use) noexcept {
  if constexpr (!has_exponent<Divergence>::value) {
    return false;
  } else if constexpr (exponent_is_constant<Divergence>::value) {
    constexpr double exponent = Divergence{}.exponent();
    if constexpr (exponent == 0.5) use(power_half{}, exponent);
    if constexpr (exponent == 1) use(power_one{}, exponent);
    if constexpr (exponent == 2) use(power_two{}, exponent);
    if constexpr (exponent != 0.5 && exponent != 1 && exponent != 2 && exponent != 0)
      use(power_any{exponent}, exponent);
    return exponent != 0;
  } else {
    const double exponent = divergence.exponent();
    if (exponent == 0.5) {
      use(power_half{}, exponent);
    } else if (exponent == 1) {
      use(power_one{}, exponent);
    } else if (exponent == 2) {
      use(power_two{}, exponent);
    } else if (exponent != 0) {
      use(power_any{exponent}, exponent);
    }
    return exponent != 0;
  }
}

}  // namespace phimis::detail

#endif  // PHIMIS_CORE_POWER_TERMS_HPP
