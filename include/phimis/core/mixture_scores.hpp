// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_MIXTURE_SCORES_HPP
#define PHIMIS_CORE_MIXTURE_SCORES_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/divergence.hpp>
#include <phimis/core/divergence_at.hpp>
#include <phimis/core/kink.hpp>
#include <phimis/core/power_terms.hpp>
#include <phimis/core/row_parts.hpp>

#include <cmath>

namespace phimis::detail {

/// Scores of a block of rows: a = w s(t), b = w t s'(t)/x, c = w times the size of s, and their part of λ = Σ x c.
template <class Real>
struct score_block {
  Real a[block_rows];
  Real b[block_rows];
  Real c[block_rows];  // only of scores that change sign
};

/// In the power family: one division a row.
template <class Power>
struct power_block {
  static constexpr bool packed = Power::packed;
  static constexpr bool changes_sign = false;
  Power power;
  double exponent;

  template <class V, class Real>
  PHIMIS_HOST_DEVICE V score(const V& w, const V& u, const V& x, V& a, V& b, V& c) const noexcept {
    const V r = inverse_of<Real>(x, u);
    const power_term<V> term = power.template term<Real>(w, u, x, r);
    a = exponent < 0 ? -term.score : term.score;
    c = term.score;
    b = Real(std::fabs(exponent)) * term.score * r;
    return term.part;
  }
};

/// Any score, also one that crosses zero.
template <class Divergence>
struct any_block {
  static constexpr bool packed = false;
  static constexpr bool changes_sign = true;
  const Divergence& divergence;
  double zero;  // s(0), or 0 where constants cancel

  template <class V, class Real>
  PHIMIS_HOST_DEVICE V score(const V& w, const V& u, const V& x, V& a, V& b, V& c) const noexcept {
    const phimis::score<Real> s = score_at(divergence, u / x);
    const Real value = s.value - static_cast<Real>(zero);
    a = w * value;
    b = w * s.slope / x;
    // What cancels in s, and what it changes by; but of a kink, whose slope is no scale.
    const Real slope = is_rounded_off<Divergence>::value && s.slope > 1 ? Real(1) : s.slope;
    c = w * ((value < 0 ? -value : value) + slope + static_cast<Real>(zero < 0 ? -zero : zero));
    return x * c;
  }
};

}  // namespace phimis::detail

#endif  // PHIMIS_CORE_MIXTURE_SCORES_HPP
