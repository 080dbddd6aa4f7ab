// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_PAIR_SUMS_HPP
#define PHIMIS_CORE_PAIR_SUMS_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/divergence.hpp>
#include <phimis/core/divergence_at.hpp>
#include <phimis/core/finite.hpp>
#include <phimis/core/pack.hpp>
#include <phimis/core/power_terms.hpp>
#include <phimis/core/row_parts.hpp>
#include <phimis/core/table.hpp>

#include <cmath>
#include <cstddef>

namespace phimis {

/// The optimality condition of two techniques at one pair of fractions, summed over rows.
///
///     ζ  = Σ_j (p_1j − p_2j)/q_j s(t_j)              positive: technique 1 deserves more
///     −ζ' = Σ_j (p_1j − p_2j)²/(q_j p_j) t_j s'(t_j)  minus the derivative of ζ in α_1
///     λ  = Σ_j p_j/q_j |s(t_j)|                       the scale that a residual is relative to
///
/// Unless pdfs are normalised, s is taken with s(0) = 0 where that is finite. Where s is no power of t, λ is Σ p/q (|s| + t s').
///
/// Source T Eqs. 27–31, with the density q_j that each sample was drawn from in place of p(α).
struct pair_sums {
  double zeta;
  double slope;
  double lambda;
  double exponent = 0;  ///< of the power s = ±t^exponent; 0 where s is none
};

/// Where the sums are taken: the mixture Σ α_k κ_k p_k of pdfs that were multiplied by κ_k, and the unit of f.
///
///     t_j = unit · u_j / Σ_k α_k κ_k y_kj
///
/// κ = 1, or mass/Σ_j(p_kj/q_j), which makes each pdf integrate to one on the sample.
template <class Real>
struct pair_point {
  Real alpha[2];
  Real kappa[2];
  Real unit;
  double mass;              ///< what sums are divided by to be means: n for samples, 1 for quadrature nodes
  bool normalised = false;  ///< Σ p_k κ_k/q is the same for both: a constant of s cancels, and is better not added
};

namespace detail {

/// A row, or a pack of rows, at a point.
template <class Real>
struct pair_rows {
  const Real* u;
  const Real* w;
  const Real* y1;
  const Real* y2;
  Real b1, b2, k1, k2, unit;

  PHIMIS_HOST_DEVICE pair_rows(const column_pointers<Real>& rows, const pair_point<Real>& at) noexcept
      : u(rows.u),
        w(rows.w),
        y1(rows.y[0]),
        y2(rows.y[1]),
        b1(at.alpha[0] * at.kappa[0]),
        b2(at.alpha[1] * at.kappa[1]),
        k1(at.kappa[0]),
        k2(at.kappa[1]),
        unit(at.unit) {}

  template <class V>
  struct row {
    V y1, y2;
    V x;  // p(α)/Σp, kept from 0: where the mixture and f both vanish, f/p is 0
    V d;  // (p_1 − p_2)/Σp
    V u, w;
  };

  template <class V>
  PHIMIS_HOST_DEVICE row<V> at(std::ptrdiff_t j) const noexcept {
    constexpr Real tiny = sizeof(Real) == 8 ? Real(1e-300) : Real(1e-37);
    const V first = load<V>(y1 + j);
    const V second = load<V>(y2 + j);
    return {first, second, b1 * first + b2 * second + tiny, k1 * first - k2 * second, unit * load<V>(u + j),
            load<V>(w + j)};
  }
};

/// Sums over all rows, or of one block in `every`: of so few that no threads are asked.
template <int N, class Real, class Terms>
PHIMIS_HOST_DEVICE void sum_blocks(const column_pointers<Real>& rows, int every, const Terms& terms,
                                   double (&total)[N]) noexcept {
  if (every > 1) {
    for (std::ptrdiff_t j = 0; j < rows.n; j += static_cast<std::ptrdiff_t>(every) * block_rows) {
      sum_rows<N, Real>(j, rows.n - j < block_rows ? rows.n : j + block_rows, terms, total);
    }
    return;
  }
  if (rows.parts == nullptr) return sum_rows<N, Real>(0, rows.n, terms, total);  // ten rows, too, are fast
  sum_parts(rows, N, total, [&](std::ptrdiff_t first, std::ptrdiff_t last, double* own) {
    double sums[N] = {};
    sum_rows<N, Real>(first, last, terms, sums);
    for (int i = 0; i < N; ++i) own[i] = sums[i];
  });
}

/// Terms of pair_sums in the power family, without the factors of s and t s'.
template <class Real, class Power>
struct power_terms {
  static constexpr bool packed = Power::packed;
  pair_rows<Real> rows;
  Power power;

  template <class V>
  PHIMIS_HOST_DEVICE void add(std::ptrdiff_t j, V (&sums)[3]) const noexcept {
    const auto row = rows.template at<V>(j);
    const V r = inverse_of<Real>(row.x, row.u);
    const V e = row.d * r;
    const power_term<V> term = power.template term<Real>(row.w, row.u, row.x, r);
    const V tilt = row.d * term.score;
    sums[0] += tilt;
    sums[1] += tilt * e;
    sums[2] += term.part;
  }
};

template <class Real, class Power>
PHIMIS_HOST_DEVICE pair_sums sum_powers(const Power& power, double exponent, const column_pointers<Real>& rows,
                                        const pair_point<Real>& at, int every) noexcept {
  double total[3] = {};
  sum_blocks<3, Real>(rows, every, power_terms<Real, Power>{pair_rows<Real>(rows, at), power}, total);
  return {exponent < 0 ? -total[0] : total[0], std::fabs(exponent) * total[1], total[2], exponent};
}

/// Terms of pair_sums for any score.
template <class Real, class Divergence>
struct score_terms {
  static constexpr bool packed = false;
  pair_rows<Real> rows;
  const Divergence& divergence;
  Real zero;  // s(0), or 0 where constants cancel

  template <class V>
  PHIMIS_HOST_DEVICE void add(std::ptrdiff_t j, V (&sums)[3]) const noexcept {
    const auto row = rows.template at<V>(j);
    const V e = row.d / row.x;
    const V wd = row.w * row.d;  // w x e, where w x may vanish
    const score<Real> s = score_at(divergence, row.u / row.x);
    const V value = s.value - zero;
    const V slope = is_finite(s.slope) ? s.slope : V(0);  // infinite at a kink of order below 2: no scale, no step
    sums[0] += wd * value;
    sums[1] += wd * e * slope;
    sums[2] += row.w * row.x * ((value < 0 ? -value : value) + slope);
  }
};

/// Terms of dV[F]/dα and its derivative.
template <class Real>
struct variance_terms {
  static constexpr bool packed = true;
  pair_rows<Real> rows;

  template <class V>
  PHIMIS_HOST_DEVICE void add(std::ptrdiff_t j, V (&sums)[9]) const noexcept {
    const auto row = rows.template at<V>(j);
    const V r = inverse_of<Real>(row.x, row.u);
    const V e = row.d * r;
    const V s1 = rows.k1 * row.y1 * r;  // p_k/p
    const V s2 = rows.k2 * row.y2 * r;
    const V v = row.w * row.u;  // f/q
    const V vt = v * (row.u * r);
    sums[0] += vt * e;
    sums[1] += vt * e * e;
    sums[2] += vt;
    sums[3] += v * s1;
    sums[4] += v * s2;
    sums[5] += v * s1 * e;
    sums[6] += v * s2 * e;
    sums[7] += v * s1 * e * e;
    sums[8] += v * s2 * e * e;
  }
};

}  // namespace detail

/// pair_sums of any divergence that has a score. γ = ½, 1, 2 run without a power function.
///
/// every: 1, or that only one block of rows in so many is read.
///
/// Requires α_k κ_k >= 0. At α_k = 0 a sum may be infinite.   Cost one division a row, two and two polynomials for other γ.
template <class Divergence, class Real>
PHIMIS_HOST_DEVICE pair_sums sum_pair(const Divergence& divergence, const column_pointers<Real>& rows,
                                      const pair_point<Real>& at, int every = 1) noexcept {
  pair_sums sums{};
  const bool is_power = detail::with_power(divergence, [&](const auto& power, double exponent) {
    sums = detail::sum_powers(power, exponent, rows, at, every);
  });
  if (is_power) return sums;
  if constexpr (detail::needs_any_score<Divergence>::value) {
    double total[3] = {};
    const detail::score_terms<Real, Divergence> terms{
        detail::pair_rows<Real>(rows, at), divergence,
        at.normalised ? Real(0) : static_cast<Real>(score_at_zero(divergence))};
    detail::sum_blocks<3, Real>(rows, every, terms, total);
    sums = {total[0], total[1], total[2]};
  }
  return sums;
}

/// pair_sums of the multi-sample variance: ζ = −dV[F]/dα_1, slope = d²V[F]/dα_1², λ = Σ p/q t².
///
/// With m_k = μ'_k = Σ f p_k/(p q) / n and S = Σ α_k m_k²,
///
///     ζ = Σ (p_1 − p_2)/q t² + n S',   slope = 2 Σ (p_1 − p_2)²/(q p) t² − n S'',   n = at.mass/every
template <class Real>
PHIMIS_HOST_DEVICE pair_sums sum_pair(const multi_sample_variance&, const column_pointers<Real>& rows,
                                      const pair_point<Real>& at, int every = 1) noexcept {
  double total[9] = {};
  detail::sum_blocks<9, Real>(rows, every, detail::variance_terms<Real>{detail::pair_rows<Real>(rows, at)}, total);
  const double n = at.mass / every;
  double s1 = 0;
  double s2 = 0;
  double m[2] = {};
  double dm[2] = {};
  for (int k = 0; k < 2; ++k) {
    const double alpha = static_cast<double>(at.alpha[k]);
    m[k] = total[3 + k] / n;
    dm[k] = -total[5 + k] / n;
    const double ddm = 2 * total[7 + k] / n;
    s1 += 2 * alpha * m[k] * dm[k];
    s2 += 2 * alpha * (dm[k] * dm[k] + m[k] * ddm);
  }
  s1 += m[0] * m[0] - m[1] * m[1];
  s2 += 4 * (m[0] * dm[0] - m[1] * dm[1]);
  return {total[0] + n * s1, 2 * total[1] - n * s2, total[2]};
}

/// pair_sums of rows by column.
template <class Divergence, class Real>
PHIMIS_HOST_DEVICE pair_sums sum_pair(const Divergence& divergence, const columns<Real, 2>& rows,
                                      const pair_point<Real>& at) noexcept {
  return sum_pair(divergence, column_pointers<Real>{rows.u, rows.w, rows.y, rows.n, 2}, at);
}

}  // namespace phimis

#endif  // PHIMIS_CORE_PAIR_SUMS_HPP
