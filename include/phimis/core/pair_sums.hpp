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

struct power_half {
  static constexpr bool slope_counts = false;
  template <class Real>
  PHIMIS_HOST_DEVICE score<Real> operator()(Real t) const noexcept {
    const Real root = std::sqrt(t);
    return {root, root / 2};
  }
};
struct power_one {
  static constexpr bool slope_counts = false;
  template <class Real>
  PHIMIS_HOST_DEVICE score<Real> operator()(Real t) const noexcept {
    return {t, t};
  }
};
struct power_two {
  static constexpr bool slope_counts = false;
  template <class Real>
  PHIMIS_HOST_DEVICE score<Real> operator()(Real t) const noexcept {
    return {t * t, 2 * t * t};
  }
};
template <class Divergence>
struct any_score {
  const Divergence& divergence;
  bool slope_counts;
  template <class Real>
  PHIMIS_HOST_DEVICE score<Real> operator()(Real t) const noexcept {
    return score_at(divergence, t);
  }
};

/// Rows are summed in independent lanes, which compilers turn into vectors without reordering a sum, and blocks of
/// rows are added in double: rounding grows with the block, not with n.
inline constexpr int lanes = 16;
inline constexpr std::ptrdiff_t rows_per_block = 64 * lanes;

/// N sums over rows. add(j, lane) adds row j to the lane's own accumulators.
template <class Real, int N>
struct lane_sums {
  Real lane[N][lanes] = {};

  PHIMIS_HOST_DEVICE void flush(double* total) noexcept {
    for (int i = 0; i < N; ++i) {
      double sum = 0;
      for (int l = 0; l < lanes; ++l) {
        sum += static_cast<double>(lane[i][l]);
        lane[i][l] = 0;
      }
      total[i] += sum;
    }
  }
};

template <int N, class Real, class AddRow>
PHIMIS_HOST_DEVICE void sum_rows(std::ptrdiff_t n, const AddRow& add_row, double (&total)[N]) noexcept {
  for (std::ptrdiff_t begin = 0; begin < n; begin += rows_per_block) {
    const std::ptrdiff_t end = begin + rows_per_block < n ? begin + rows_per_block : n;
    lane_sums<Real, N> sums;
    std::ptrdiff_t j = begin;
    for (; j + lanes <= end; j += lanes) {
      for (int l = 0; l < lanes; ++l) add_row(j + l, l, sums);
    }
    for (int l = 0; j < end; ++j, ++l) add_row(j, l, sums);
    sums.flush(total);
  }
}

/// One row's terms of pair_sums.
template <class Real, class Score>
struct score_terms {
  const Real* u;
  const Real* w;
  const Real* y1;
  const Real* y2;
  Real b1, b2, k1, k2, unit;
  const Score& score_of;

  PHIMIS_HOST_DEVICE void operator()(std::ptrdiff_t j, int l, lane_sums<Real, 3>& sums) const noexcept {
    const Real x = b1 * y1[j] + b2 * y2[j];
    const Real d = k1 * y1[j] - k2 * y2[j];
    const Real r = u[j] > 0 ? 1 / x : Real(0);  // f = 0: t = 0 even where the mixture vanishes
    const score<Real> s = score_of(unit * u[j] * r);
    sums.lane[0][l] += w[j] * d * s.value;
    sums.lane[1][l] += w[j] * d * d * r * s.slope;
    sums.lane[2][l] += w[j] * x * ((s.value < 0 ? -s.value : s.value) + (score_of.slope_counts ? s.slope : Real(0)));
  }
};

template <class Real, class Score>
PHIMIS_HOST_DEVICE pair_sums sum_scores(const Score& score_of, const columns<Real, 2>& rows,
                                        const pair_point<Real>& at) noexcept {
  double total[3] = {};
  const score_terms<Real, Score> terms{rows.u,      rows.w,      rows.y[0],
                                       rows.y[1],   at.alpha[0] * at.kappa[0], at.alpha[1] * at.kappa[1],
                                       at.kappa[0], at.kappa[1], at.unit,
                                       score_of};
  sum_rows<3, Real>(rows.n, terms, total);
  return {total[0], total[1], total[2]};
}

/// One row's terms of dV[F]/dα and its derivative.
template <class Real>
struct variance_terms {
  const Real* u;
  const Real* w;
  const Real* y1;
  const Real* y2;
  Real b1, b2, k1, k2, unit;

  PHIMIS_HOST_DEVICE void operator()(std::ptrdiff_t j, int l, lane_sums<Real, 9>& sums) const noexcept {
    const Real x = b1 * y1[j] + b2 * y2[j];
    const Real d = k1 * y1[j] - k2 * y2[j];
    const Real r = u[j] > 0 ? 1 / x : Real(0);
    const Real t = unit * u[j] * r;
    const Real s1 = k1 * y1[j] * r;  // p_k/p
    const Real s2 = k2 * y2[j] * r;
    const Real e = d * r;
    const Real ft = w[j] * x * t;  // f/q
    sums.lane[0][l] += ft * t * e;
    sums.lane[1][l] += ft * t * e * e;
    sums.lane[2][l] += ft * t;
    sums.lane[3][l] += ft * s1;
    sums.lane[4][l] += ft * s2;
    sums.lane[5][l] += ft * s1 * e;
    sums.lane[6][l] += ft * s2 * e;
    sums.lane[7][l] += ft * s1 * e * e;
    sums.lane[8][l] += ft * s2 * e * e;
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
    if (exponent == 0.5) return detail::sum_scores(detail::power_half{}, rows, at);
    if (exponent == 1) return detail::sum_scores(detail::power_one{}, rows, at);
    if (exponent == 2) return detail::sum_scores(detail::power_two{}, rows, at);
    return detail::sum_scores(detail::any_score<Divergence>{divergence, exponent == 0}, rows, at);
  } else {
    return detail::sum_scores(detail::any_score<Divergence>{divergence, true}, rows, at);
  }
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
  const detail::variance_terms<Real> terms{rows.u,      rows.w,
                                           rows.y[0],   rows.y[1],
                                           at.alpha[0] * at.kappa[0], at.alpha[1] * at.kappa[1],
                                           at.kappa[0], at.kappa[1],
                                           at.unit};
  detail::sum_rows<9, Real>(rows.n, terms, total);
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
