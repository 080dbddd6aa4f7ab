// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_PROJECTION_SUMS_HPP
#define PHIMIS_CORE_PROJECTION_SUMS_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/finite.hpp>
#include <phimis/core/fractions.hpp>
#include <phimis/core/limits.hpp>
#include <phimis/core/movable_techniques.hpp>
#include <phimis/core/observation.hpp>
#include <phimis/core/solve_nonnegative.hpp>

namespace phimis {

/// The normal equations of M weighted least-squares fits of f by Σ_k a_k p_k, one for each anchor mixture p_c.
///
///     min_a ∫ (f − Σ_k a_k p_k)²/p_c dx,   p_c = Σ_k A_ck p_k,   A_ck = ⅕/M + ⅘ [c = k]
///
///     G^c_ik = Σ_j p_i p_k/(q p_c),   b^c_i = Σ_j f p_i/(q p_c)        over all observations, each with its own q
///
/// 1/p(α) is the weight with which the best fit is the mixture of least Kullback–Leibler divergence; the anchors, mixtures
/// in which one technique has four fifths, bound it: 1/p(α) ≤ Σ_c λ_c/p_c where α = Σ_c λ_c A_c. A weighted sum of the
/// anchors' equations is therefore nearly the weight of any mixture, and the sums stay sums: fixed size, mergeable in any
/// grouping, free of the unit and the parametrisation of x. f in units of the largest f/Σp so far.
///
/// Source   ours.
/// Cost     M (M+1)(M/2 + 1) multiplications an observation; M²(M+3)/2 numbers.
template <class Real, int M>
class projection_sums {
 public:
  /// A_ck
  PHIMIS_HOST_DEVICE static constexpr double anchor(int c, int k) noexcept {
    return (1 - dominance) / M + (c == k ? dominance : 0);
  }

  PHIMIS_HOST_DEVICE void add(const row<Real, M>& row) noexcept {
    if (!(row.w > 0)) return;
    refer_to(row.u);
    const Real u = row.u > 0 ? row.u / unit_ : Real(0);
    for (int c = 0; c < M; ++c) {
      const Real y = Real((1 - dominance) / M) + Real(dominance) * row.y[c];  // p_c/Σp
      Real* g = g_[c];
      for (int i = 0; i < M; ++i) {
        const Real weighted = row.w / y * row.y[i];
        b_[c][i] += weighted * u;
        for (int k = 0; k <= i; ++k) *g++ += weighted * row.y[k];
      }
    }
  }

  PHIMIS_HOST_DEVICE void merge(const projection_sums& other) noexcept {
    projection_sums theirs = other;
    theirs.refer_to(unit_);
    refer_to(theirs.unit_);
    for (int c = 0; c < M; ++c) {
      for (int i = 0; i < M; ++i) b_[c][i] += theirs.b_[c][i];
      for (int i = 0; i < pairs; ++i) g_[c][i] += theirs.g_[c][i];
    }
  }

  /// The equations whose weight is that of the mixture α, or near it:  Σ_c λ_c G^c,  Σ_c λ_c b^c,  for all M.
  ///
  /// Outside the anchors, where a λ_c would be negative, the sum without it. The prior is M more rows of that weight, in
  /// each of which one technique alone has density and f = μ̂ π_k; n is the number of observations.
  PHIMIS_HOST_DEVICE void equations(const fractions<double, M>& alpha, const fractions<Real, M>& start, double prior,
                                    double n, double (&g)[M][M], double (&b)[M]) const noexcept {
    double lambda[M];
    double sum = 0;
    for (int c = 0; c < M; ++c) {
      const double inside = alpha[c] - (1 - dominance) / M;
      lambda[c] = inside > 0 ? inside : 0;
      sum += lambda[c];
    }
    for (int i = 0; i < M; ++i) {
      b[i] = 0;
      for (int k = 0; k < M; ++k) g[i][k] = 0;
    }
    for (int c = 0; c < M; ++c) {
      const double share = lambda[c] / sum;
      double total = 0;  // n μ̂ = Σ_k A_ck b^c_k
      for (int i = 0; i < M; ++i) {
        total += anchor(c, i) * static_cast<double>(b_[c][i]);
        b[i] += share * static_cast<double>(b_[c][i]);
        for (int k = 0; k <= i; ++k) g[i][k] += share * static_cast<double>(g_[c][i * (i + 1) / 2 + k]);
      }
      for (int i = 0; i < M; ++i) {
        const double weight = share * prior / anchor(c, i);
        g[i][i] += weight;
        b[i] += weight * static_cast<double>(start[i]) * total / n;
      }
    }
    for (int i = 0; i < M; ++i) {
      for (int k = i + 1; k < M; ++k) g[i][k] = g[k][i];
    }
  }

  /// The nonnegative fit whose weight is nearly 1/p(α) at its own α: τ[size], summing to one. False where every f is 0, a
  /// pdf that can move was 0 everywhere, or a sum is not finite.
  PHIMIS_HOST_DEVICE bool fit(const movable_techniques<M>& on, const fractions<Real, M>& start, Real prior, double n,
                              double (&tau)[M]) const noexcept {
    constexpr int steps = 8;  // each brings the weight nearer to 1/p(α) by a factor of 2 to 50
    fractions<double, M> alpha = equal_fractions<double, M>();
    for (int step = 0; step <= steps; ++step) {
      double g[M][M];
      double b[M];
      equations(alpha, start, static_cast<double>(prior), n, g, b);
      for (int i = 0; i < on.size; ++i) {
        if (!(g[on.technique[i]][on.technique[i]] > 0)) return false;
      }
      on.to_corners(g, b);
      solve_nonnegative<M>(g, b, on.size, tau, static_cast<double>(epsilon<Real>));
      double sum = 0;
      for (int i = 0; i < on.size; ++i) sum += tau[i];
      if (!(sum > 0) || !is_finite(sum)) return false;
      for (int i = 0; i < on.size; ++i) tau[i] /= sum;
      alpha = on.at(tau);
    }
    return true;
  }

 private:
  static constexpr double dominance = 0.8;
  static constexpr int pairs = M * (M + 1) / 2;

  PHIMIS_HOST_DEVICE void refer_to(Real u) noexcept {
    if (!(u > unit_)) return;
    for (int c = 0; c < M; ++c) {
      for (int i = 0; i < M; ++i) b_[c][i] *= unit_ / u;
    }
    unit_ = u;
  }

  Real unit_ = 0;
  Real g_[M][pairs] = {};
  Real b_[M][M] = {};
};

}  // namespace phimis

#endif  // PHIMIS_CORE_PROJECTION_SUMS_HPP
