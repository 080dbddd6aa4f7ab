// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_PACK_POWER_HPP
#define PHIMIS_CORE_PACK_POWER_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/limits.hpp>
#include <phimis/core/pack.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace phimis::detail {

/// IEEE 754 numbers as integers, and polynomials that interpolate at Chebyshev's points.
///
///     log2((1+s)/(1−s)) = s L(s²),  √½ <= m < √2, s = (m−1)/(m+1);    2^x = E(x),  |x| <= ½
///
/// Their relative errors are 7e-10 and 2e-9 for float, 1e-18 and 3e-18 for double: below rounding.
template <class Real>
struct binary;
template <>
struct binary<double> {
  using bits = std::uint64_t;
  static constexpr int mantissa = 52, bias = 1023, counter = 2048;
  static constexpr bits one = 0x3ff0000000000000, root_of_half = 0x3fe6a09e667f3bcd, two_to_mantissa = 0x4330000000000000;
  static constexpr double smallest = 2.2250738585072014e-308;
  static constexpr double log2_terms[] = {2.8853900817779268115,  0.96179669392598972877, 0.5770780163455202295,
                                          0.41219858584090053448, 0.32059853491395986095, 0.26233435250418301904,
                                          0.22091308423117679618, 0.21365895694319269427};
  static constexpr double exp2_terms[] = {0.99999999999999999693,   0.69314718055994530925,   0.24022650695910159567,
                                          0.055504108664821627039,  0.0096181291075872566681, 0.0013333558146406470697,
                                          0.00015403530463724354209, 0.000015252733841556772589, 1.3215432535912376166e-6,
                                          1.0178057087733941105e-7, 7.0741942972885210056e-9, 4.455817908336064493e-10};
};
template <>
struct binary<float> {
  using bits = std::uint32_t;
  static constexpr int mantissa = 23, bias = 127, counter = 256;
  static constexpr bits one = 0x3f800000, root_of_half = 0x3f3504f3, two_to_mantissa = 0x4b000000;
  static constexpr float smallest = 1.17549435e-38f;
  static constexpr float log2_terms[] = {2.88539008f, 0.961798839f, 0.576715186f, 0.431717697f};
  static constexpr float exp2_terms[] = {1.0f,           0.693147207f,   0.240226509f,  0.0555032723f,
                                         0.00961805666f, 0.00134004282f, 0.000154614447f};
};

template <class To, class From>
PHIMIS_HOST_DEVICE To same_bits(const From& from) noexcept {
  static_assert(sizeof(To) == sizeof(From), "one is not the bits of the other");
  To to;
  std::memcpy(&to, &from, sizeof to);
  return to;
}

/// Σ c_i x^i, i >= From, less x^From: in pairs, of pairs, …, so that much can be done at once.   Source Estrin 1960.
template <std::size_t From, std::size_t Count, class V, class Real, std::size_t N>
PHIMIS_HOST_DEVICE V part_of_polynomial(const Real (&c)[N], const V* powers) noexcept {
  if constexpr (Count == 1) {
    return V{} + c[From];
  } else {
    constexpr std::size_t level = Count > 8 ? 3 : Count > 4 ? 2 : Count > 2 ? 1 : 0;
    constexpr std::size_t low = std::size_t(1) << level;
    return part_of_polynomial<From, low>(c, powers) +
           part_of_polynomial<From + low, Count - low>(c, powers) * powers[level];
  }
}

/// Σ c_i x^i.   Requires at most 16 terms.
template <class V, class Real, std::size_t N>
PHIMIS_HOST_DEVICE V polynomial(const Real (&c)[N], const V& x) noexcept {
  static_assert(N <= 16, "one more power is needed");
  V powers[4] = {x, x * x};
  powers[2] = powers[1] * powers[1];
  powers[3] = powers[2] * powers[2];
  return part_of_polynomial<0, N>(c, powers);
}

/// t^β of every lane: one exponent for all, in one pass without branches.
///
///     t = 2^e m,   t^β = 2^n 2^(β e + β log2 m − n)
///
/// Requires t >= 0 and finite, β ≠ 0.
/// Errors   (2 + |β|) ε; where -ffast-math is on and adds β's halves again, (8 + |β| + |β log2 t|/2) ε. 0 or infinite past
///          the range of normal numbers, less a factor of 2 at its upper end, and at t = 0. A single number has std::pow.
template <class Real>
class power_of_packs {
  using numbers = binary<Real>;
  using bits = typename numbers::bits;

 public:
  PHIMIS_HOST_DEVICE explicit power_of_packs(Real beta) noexcept : beta_(beta) {
    // Half of the bits of β, so that their product with an exponent is exact.
    const bits half = (bits(1) << (numbers::mantissa / 2)) - 1;
    high_ = same_bits<Real>(static_cast<bits>(same_bits<bits>(beta) & ~half));
    low_ = beta - high_;
  }

  template <class V>
  PHIMIS_HOST_DEVICE V operator()(const V& t) const noexcept {
    if constexpr (std::is_same<V, Real>::value) {
      return std::pow(t, beta_);
    } else {
      return of_pack(t);
    }
  }

 private:
#if defined(__GNUC__) && !defined(__CUDACC__) && !defined(__HIPCC__)
  /// Lanes of integers.
  template <class V>
  struct integers {
    typedef bits type __attribute__((vector_size(sizeof(V))));
  };

  template <class V>
  V of_pack(const V& t) const noexcept {
    using B = typename integers<V>::type;
    constexpr int mantissa = numbers::mantissa;
    // What is below the normal numbers is scaled into them.
    const B small = same_bits<B>(t < V{} + numbers::smallest);
    const B whole = either<V, B>(small, t * static_cast<Real>(bits(4) << mantissa), t);
    const V shift = same_bits<V>(small & same_bits<B>(V{} + Real(mantissa + 2)));

    const B biased = (whole + (numbers::one - numbers::root_of_half)) >> mantissa;
    const V m = same_bits<V>(whole - (biased << mantissa) + numbers::one);
    V e = as_number<V>(biased) - shift - Real(numbers::bias);
    hold(e);
    const V s = (m - Real(1)) / (m + Real(1));
    const V log2_m = s * polynomial(numbers::log2_terms, s * s);

    const V y = clamp<B>(beta_ * (e + log2_m), V{} - Real(numbers::bias), V{} + Real(numbers::bias + 1));
    // The nearest integer is in the last bits of y + 1.5 · 2^mantissa.
    V rounded = y + (Real(3) * static_cast<Real>(bits(1) << (mantissa - 1)) + Real(numbers::counter));
    hold(rounded);
    const B counted = same_bits<B>(rounded) & (2 * bits(numbers::counter) - 1);
    V n = as_number<V>(counted) - Real(numbers::counter);
    hold(n);
    const V x = (high_ * e - n) + (low_ * e + beta_ * log2_m);
    const V half = V{} + Real(0.5);
    const B power_of_two = (counted + (bits(numbers::bias) - bits(numbers::counter))) << mantissa;
    const V result = polynomial(numbers::exp2_terms, clamp<B>(x, -half, half)) * same_bits<V>(power_of_two);
    const V at_zero = V{} + (beta_ > 0 ? Real(0) : infinity<Real>);
    return same_bits<V>(either<V, B>(same_bits<B>(t > V{}), result, at_zero));
  }

  template <class V, class B>
  static B either(const B& mask, const V& yes, const V& no) noexcept {
    return (mask & same_bits<B>(yes)) | (~mask & same_bits<B>(no));
  }
  template <class B, class V>
  static V clamp(const V& x, const V& least, const V& most) noexcept {
    const V above = same_bits<V>(either<V, B>(same_bits<B>(x < least), least, x));
    return same_bits<V>(either<V, B>(same_bits<B>(above > most), most, above));
  }

  /// Integers below 2^mantissa as numbers.
  template <class V, class B>
  static V as_number(const B& integers) noexcept {
    V v = same_bits<V>(integers | numbers::two_to_mantissa) - static_cast<Real>(bits(1) << numbers::mantissa);
    hold(v);
    return v;
  }

  /// Keeps -ffast-math from adding in another order, across what is large and cancels.
  template <class V>
  static void hold(V& v) noexcept {
#if defined(__x86_64__)
    __asm__("" : "+x"(v));
#elif defined(__aarch64__)
    __asm__("" : "+w"(v));
#else
    __asm__("" : "+m"(v));
#endif
  }
#endif

  Real beta_, high_, low_;
};

}  // namespace phimis::detail

#endif  // PHIMIS_CORE_PACK_POWER_HPP
