// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_PAIR_SUMS_HPP
#define PHIMIS_CORE_PAIR_SUMS_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/divergence.hpp>
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
/// Where s is no power of t, its zero is arbitrary and λ is Σ p/q (|s| + t s').
///
/// Source T Eqs. 27–31, with the density q_j that each sample was drawn from in place of p(α).
struct pair_sums {
  double zeta;
  double slope;
  double lambda;
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
  double mass;  ///< Σ_j 1/q_j: n for samples, 1 for quadrature nodes
};

namespace detail {

/// Rows are summed in independent lanes, which compilers turn into vectors without reordering a sum, and blocks of
/// rows are added in double: rounding grows with the block, not with n.
inline constexpr std::ptrdiff_t lanes = 16;

/// N sums over rows, lane by lane.
template <class Real, int N>
struct lane_sums {
  Real lane[N][lanes] = {};
};

/// add_row(j, lane, sums) adds row j to the lane's own accumulators.
template <int N, class Real, class AddRow>
PHIMIS_HOST_DEVICE void sum_rows(std::ptrdiff_t n, const AddRow& add_row, double (&total)[N]) noexcept {
  constexpr std::ptrdiff_t block = 64 * lanes;
  for (std::ptrdiff_t begin = 0; begin < n; begin += block) {
    const std::ptrdiff_t end = begin + block < n ? begin + block : n;
    lane_sums<Real, N> sums;
    std::ptrdiff_t j = begin;
    for (; j + lanes <= end; j += lanes) {
      for (std::ptrdiff_t l = 0; l < lanes; ++l) add_row(j + l, l, sums);
    }
    for (std::ptrdiff_t l = 0; l < end - j; ++l) add_row(j + l, l, sums);
    for (int i = 0; i < N; ++i) {
      Real* lane = sums.lane[i];
      for (std::ptrdiff_t half = lanes / 2; half > 0; half /= 2) {
        for (std::ptrdiff_t l = 0; l < half; ++l) lane[l] += lane[l + half];
      }
      total[i] += static_cast<double>(lane[0]);
    }
  }
}

/// p s/q of one row in the power family, w x t^β with t = u/x. Where s/t is simple, no power of t is formed.
struct power_half {
  template <class Real>
  PHIMIS_HOST_DEVICE Real operator()(Real w, Real u, Real x, Real) const noexcept {
    return w * std::sqrt(u * x);
  }
};
struct power_one {
  template <class Real>
  PHIMIS_HOST_DEVICE Real operator()(Real w, Real u, Real, Real) const noexcept {
    return w * u;
  }
};
struct power_two {
  template <class Real>
  PHIMIS_HOST_DEVICE Real operator()(Real w, Real u, Real, Real r) const noexcept {
    return w * u * (u * r);
  }
};
template <class Real>
struct power_any {
  Real beta;
  PHIMIS_HOST_DEVICE Real operator()(Real w, Real u, Real x, Real r) const noexcept {
    return w * x * std::pow(u * r, beta);
  }
};

/// One row's mixture and difference of pdfs.
template <class Real>
struct pair_row {
  columns<Real, 2> rows;
  Real b1, b2, k1, k2, unit;

  PHIMIS_HOST_DEVICE pair_row(const columns<Real, 2>& all, const pair_point<Real>& at) noexcept
      : rows(all),
        b1(at.alpha[0] * at.kappa[0]),
        b2(at.alpha[1] * at.kappa[1]),
        k1(at.kappa[0]),
        k2(at.kappa[1]),
        unit(at.unit) {}

  /// p(α)/Σp, kept from 0: where the mixture and f both vanish, f/p is 0.
  PHIMIS_HOST_DEVICE Real x(std::ptrdiff_t j) const noexcept {
    constexpr Real tiny = sizeof(Real) == 8 ? Real(1e-300) : Real(1e-37);
    return b1 * rows.y[0][j] + b2 * rows.y[1][j] + tiny;
  }
  /// (p_1 − p_2)/Σp
  PHIMIS_HOST_DEVICE Real d(std::ptrdiff_t j) const noexcept { return k1 * rows.y[0][j] - k2 * rows.y[1][j]; }
  PHIMIS_HOST_DEVICE Real u(std::ptrdiff_t j) const noexcept { return unit * rows.u[j]; }
  PHIMIS_HOST_DEVICE Real w(std::ptrdiff_t j) const noexcept { return rows.w[j]; }
};

/// One row's terms of pair_sums in the power family, without the factors of s and t s'.
template <class Real, class Power>
struct power_terms : pair_row<Real> {
  Power power;

  PHIMIS_HOST_DEVICE power_terms(const pair_row<Real>& row, const Power& p) noexcept
      : pair_row<Real>(row), power(p) {}

  PHIMIS_HOST_DEVICE void operator()(std::ptrdiff_t j, std::ptrdiff_t l, lane_sums<Real, 3>& sums) const noexcept {
    const Real x = this->x(j);
    const Real r = 1 / x;
    const Real e = this->d(j) * r;
    const Real v = power(this->w(j), this->u(j), x, r);
    sums.lane[0][l] += v * e;
    sums.lane[1][l] += v * e * e;
    sums.lane[2][l] += v;
  }
};

template <class Real, class Power>
PHIMIS_HOST_DEVICE pair_sums sum_powers(const Power& power, double exponent, const columns<Real, 2>& rows,
                                        const pair_point<Real>& at) noexcept {
  double total[3] = {};
  sum_rows<3, Real>(rows.n, power_terms<Real, Power>(pair_row<Real>(rows, at), power), total);
  return {exponent < 0 ? -total[0] : total[0], std::fabs(exponent) * total[1], total[2]};
}

/// One row's terms of pair_sums for any score.
template <class Real, class Divergence>
struct score_terms : pair_row<Real> {
  const Divergence& divergence;

  PHIMIS_HOST_DEVICE score_terms(const pair_row<Real>& row, const Divergence& d) noexcept
      : pair_row<Real>(row), divergence(d) {}

  PHIMIS_HOST_DEVICE void operator()(std::ptrdiff_t j, std::ptrdiff_t l, lane_sums<Real, 3>& sums) const noexcept {
    const Real x = this->x(j);
    const Real e = this->d(j) / x;
    const Real wx = this->w(j) * x;
    const score<Real> s = score_at(divergence, this->u(j) / x);
    sums.lane[0][l] += wx * e * s.value;
    sums.lane[1][l] += wx * e * e * s.slope;
    sums.lane[2][l] += wx * ((s.value < 0 ? -s.value : s.value) + s.slope);
  }
};

/// One row's terms of dV[F]/dα and its derivative.
template <class Real>
struct variance_terms : pair_row<Real> {
  PHIMIS_HOST_DEVICE explicit variance_terms(const pair_row<Real>& row) noexcept : pair_row<Real>(row) {}

  PHIMIS_HOST_DEVICE void operator()(std::ptrdiff_t j, std::ptrdiff_t l, lane_sums<Real, 9>& sums) const noexcept {
    const Real r = 1 / this->x(j);
    const Real e = this->d(j) * r;
    const Real s1 = this->k1 * this->rows.y[0][j] * r;  // p_k/p
    const Real s2 = this->k2 * this->rows.y[1][j] * r;
    const Real v = this->w(j) * this->u(j);  // f/q
    const Real vt = v * (this->u(j) * r);
    sums.lane[0][l] += vt * e;
    sums.lane[1][l] += vt * e * e;
    sums.lane[2][l] += vt;
    sums.lane[3][l] += v * s1;
    sums.lane[4][l] += v * s2;
    sums.lane[5][l] += v * s1 * e;
    sums.lane[6][l] += v * s2 * e;
    sums.lane[7][l] += v * s1 * e * e;
    sums.lane[8][l] += v * s2 * e * e;
  }
};

}  // namespace detail

/// pair_sums of any divergence that has a score. γ = ½, 1, 2 run without a power function.
///
/// Requires α_k κ_k >= 0. At α_k = 0 a sum may be infinite.   Cost one division a row, and one pow for other γ.
template <class Divergence, class Real>
PHIMIS_HOST_DEVICE pair_sums sum_pair(const Divergence& divergence, const columns<Real, 2>& rows,
                                      const pair_point<Real>& at) noexcept {
  if constexpr (has_exponent<Divergence>::value) {
    const double exponent = divergence.exponent();
    if (exponent == 0.5) return detail::sum_powers(detail::power_half{}, exponent, rows, at);
    if (exponent == 1) return detail::sum_powers(detail::power_one{}, exponent, rows, at);
    if (exponent == 2) return detail::sum_powers(detail::power_two{}, exponent, rows, at);
    if (exponent != 0) {
      return detail::sum_powers(detail::power_any<Real>{static_cast<Real>(exponent)}, exponent, rows, at);
    }
  }
  double total[3] = {};
  const detail::score_terms<Real, Divergence> terms(detail::pair_row<Real>(rows, at), divergence);
  detail::sum_rows<3, Real>(rows.n, terms, total);
  return {total[0], total[1], total[2]};
}

/// pair_sums of the multi-sample variance: ζ = −dV[F]/dα_1, slope = d²V[F]/dα_1², λ = Σ p/q t².
///
/// With m_k = μ'_k = Σ f p_k/(p q) / n and S = Σ α_k m_k²,
///
///     ζ = Σ (p_1 − p_2)/q t² + n S',   slope = 2 Σ (p_1 − p_2)²/(q p) t² − n S'',   n = at.mass
template <class Real>
PHIMIS_HOST_DEVICE pair_sums sum_pair(const multi_sample_variance&, const columns<Real, 2>& rows,
                                      const pair_point<Real>& at) noexcept {
  double total[9] = {};
  detail::sum_rows<9, Real>(rows.n, detail::variance_terms<Real>(detail::pair_row<Real>(rows, at)), total);
  const double n = at.mass;
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

}  // namespace phimis

#endif  // PHIMIS_CORE_PAIR_SUMS_HPP
