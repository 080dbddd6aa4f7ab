// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_VARIANCE_ON_SIMPLEX_HPP
#define PHIMIS_CORE_VARIANCE_ON_SIMPLEX_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/estimator.hpp>
#include <phimis/core/row_parts.hpp>
#include <phimis/core/simplex_problem.hpp>

#include <cmath>
#include <cstddef>

namespace phimis {

/// Cost times variance on rows in which u has the sign of f: a problem of `simplex_newton` that is not convex.
///
///     J = C V,   C = Σ_k c_k a_k,   a_k = β_k/κ_k
///     V[ℱ] = ∫ f²/p − μ²,   V[F] = ∫ f²/p − Σ_k a_k μ'_k²,   μ'_k = ∫ f P_k/p,   P_k = κ_k p_k
///
/// A prior adds prior · Σ_k π_k²/a_k to V.
///
///
/// With r_k = ∫ f p_k/p and h = Σ_k β_k κ_k r_k p_k the derivatives of T = Σ a_k μ'_k² = Σ β_k κ_k r_k² are
///
///     T_j  = κ_j r_j² − 2 ∫ f h p_j/p²
///     T_ij = 4 ∫ f h p_i p_j/p³ − 2 (κ_i r_i + κ_j r_j) A_ij + 2 Σ_k β_k κ_k A_ki A_kj,   A_ij = ∫ f p_i p_j/p²
///
/// Source V Eqs. 21, 35; the gradient of V[F] is that of the right condition, not of the one printed as Eqs. 43, 67, 68.
/// Cost   a Hessian reads all techniques: n m².
template <class Real>
class variance_on_simplex {
 public:
  static constexpr bool convex = false;
  static constexpr bool may_vanish = false;
  PHIMIS_HOST_DEVICE static constexpr int doubles(int m) noexcept { return 3 * m + 2 + 2 * (m + 1) * (m + 1); }

  /// costs[m] or null where all are equal; mass: what sums are divided by to be means; π[m] in the coordinates a.
  PHIMIS_HOST_DEVICE variance_on_simplex(sampling_model model, const column_pointers<Real>& rows, floored_simplex& on,
                                         const double* kappa, const Real* costs, double unit, double mass,
                                         double prior, const double* prior_shares, double* memory) noexcept
      : model_(model),
        rows_(rows),
        on_(on),
        kappa_(kappa),
        costs_(costs),
        unit_(unit),
        mass_(mass),
        prior_(prior),
        prior_shares_(prior_shares),
        slope_(memory),
        r_(memory + rows.m),
        shares_(r_ + rows.m + 2),
        gram_(shares_ + rows.m),
        pairs_(gram_ + (rows.m + 1) * (rows.m + 1)) {}

  PHIMIS_HOST_DEVICE static double power() noexcept { return 0; }
  PHIMIS_HOST_DEVICE double value() const noexcept { return cost_ * variance_; }
  PHIMIS_HOST_DEVICE double variance() const noexcept { return variance_; }
  PHIMIS_HOST_DEVICE double second_moment() const noexcept { return second_; }
  PHIMIS_HOST_DEVICE double cost() const noexcept { return cost_; }

  PHIMIS_HOST_DEVICE double gradient(const double* theta, double* gradient, double* sizes) noexcept {
    const int m = rows_.m;
    on_.at(theta);
    const double* const beta = on_.beta();
    cost_ = 0;
    for (int k = 0; k < m; ++k) cost_ += cost(k) * beta[k];
    // slope, r, ∫ f²/p and ∫ f, one behind the other
    sum_parts(rows_, 2 * m + 2, slope_, [&](std::ptrdiff_t from, std::ptrdiff_t to, double* sums) {
      for (std::ptrdiff_t j = from; j < to; ++j) {
        const point at = point_at(j);
        if (at.f == 0) continue;
        for (int k = 0; k < m; ++k) {
          const double y = static_cast<double>(rows_.y[k][j]);
          sums[k] -= y / at.x * at.f * at.t;  // of ∫ f²/p
          sums[m + k] += y / at.x * at.f;
        }
        sums[2 * m] += at.f * at.t;
        sums[2 * m + 1] += at.f;
      }
    });
    second_ = r_[m];
    const double mean = r_[m + 1];
    for (int k = 0; k < m; ++k) {
      if (!has_prior(k)) continue;
      const double t = prior_shares_[k] * kappa_[k] / beta[k];
      second_ += prior_ * prior_shares_[k] * t;
      slope_[k] -= prior_ * t * t / kappa_[k];
    }
    double squares = mean * mean;
    if (multi()) {
      squares = 0;
      for (int k = 0; k < m; ++k) {
        shares_[k] = beta[k] * kappa_[k] * r_[k];
        squares += shares_[k] * r_[k];
      }
      sum_parts(rows_, m, pairs_, [&](std::ptrdiff_t from, std::ptrdiff_t to, double* sums) {
        for (std::ptrdiff_t j = from; j < to; ++j) {
          const point at = point_at(j);
          const double fh = at.f * mixed(shares_, j) / at.x / at.x;
          for (int k = 0; k < m && fh != 0; ++k) sums[k] += 2 * fh * static_cast<double>(rows_.y[k][j]);
        }
      });
      for (int k = 0; k < m; ++k) slope_[k] += pairs_[k] - kappa_[k] * r_[k] * r_[k];
    }
    variance_ = second_ - squares;
    for (int k = 0; k < m; ++k) pairs_[k] = -(cost_ * slope_[k] + variance_ * cost(k));
    on_.pull_back(pairs_, gradient);
    for (int i = 0; i < on_.size(); ++i) sizes[i] = std::fabs(gradient[i]);
    return cost_ * second_;
  }

  PHIMIS_HOST_DEVICE void hessian(const int* support, int size, double* hessian) noexcept {
    const int m = rows_.m;
    const double* const beta = on_.beta();
    double* const a = gram_ + m * m;  // read before `pairs_` is written
    sum_parts(rows_, 2 * m * m, gram_, [&](std::ptrdiff_t from, std::ptrdiff_t to, double* sums) {
      for (std::ptrdiff_t j = from; j < to; ++j) {
        const point at = point_at(j);
        if (at.f == 0) continue;
        const double h = multi() ? mixed(shares_, j) / at.x : 0;
        const double second = (2 * at.f * at.t - 4 * at.f * h) / at.x / at.x;
        const double first = at.f / at.x / at.x;
        for (int k = 0; k < m; ++k) {
          const double y = static_cast<double>(rows_.y[k][j]);
          for (int l = k; l < m && y != 0; ++l) {
            const double yy = y * static_cast<double>(rows_.y[l][j]);
            sums[k * m + l] += second * yy;
            sums[(m + k) * m + l] += first * yy;
          }
        }
      }
    });
    for (int k = 0; k < m; ++k) {
      for (int l = 0; l < k; ++l) a[k * m + l] = a[l * m + k];
      if (!has_prior(k)) continue;
      const double t = prior_shares_[k] * kappa_[k] / beta[k];
      gram_[k * m + k] += 2 * prior_ * t * t / (kappa_[k] * beta[k]);
    }
    for (int k = 0; k < m; ++k) {
      for (int l = k; l < m; ++l) {
        double value = gram_[k * m + l];
        if (multi()) {
          value += 2 * (kappa_[k] * r_[k] + kappa_[l] * r_[l]) * a[k * m + l];
          for (int i = 0; i < m; ++i) value -= 2 * beta[i] * kappa_[i] * a[i * m + k] * a[i * m + l];
        }
        gram_[k * m + l] = gram_[l * m + k] = cost_ * value + cost(k) * slope_[l] + cost(l) * slope_[k];
      }
    }
    // Over the support, and over `fixed` as the last coordinate.
    const double* const fixed = on_.fixed();
    const int order = size + (fixed != nullptr ? 1 : 0);
    for (int i = 0; i < order; ++i) {
      for (int l = 0; l < order; ++l) {
        double value = 0;
        for (int k = 0; k < m; ++k) {
          const double left = i < size ? (on_.technique(support[i]) == k ? 1 : 0) : fixed[k];
          if (left == 0) continue;
          if (l < size) {
            value += left * gram_[k * m + on_.technique(support[l])];
          } else {
            for (int o = 0; o < m; ++o) value += left * fixed[o] * gram_[k * m + o];
          }
        }
        pairs_[i * order + l] = value;
      }
    }
    on_.pull_back(pairs_, support, size, hessian);
  }

 private:
  struct point {
    double x;
    double f;  // f/q over the mass
    double t;  // f/p
  };
  PHIMIS_HOST_DEVICE point point_at(std::ptrdiff_t j) const noexcept {
    const double u = unit_ * static_cast<double>(rows_.u[j]);
    const double x = mixed(on_.beta(), j) + 1e-300;
    return {x, static_cast<double>(rows_.w[j]) * u / mass_, u / x};
  }
  PHIMIS_HOST_DEVICE double mixed(const double* weights, std::ptrdiff_t j) const noexcept {
    double sum = 0;
    for (int k = 0; k < rows_.m; ++k) sum += weights[k] * static_cast<double>(rows_.y[k][j]);
    return sum;
  }
  PHIMIS_HOST_DEVICE double cost(int k) const noexcept {
    return (costs_ != nullptr ? static_cast<double>(costs_[k]) : 1) / kappa_[k];
  }
  PHIMIS_HOST_DEVICE bool has_prior(int k) const noexcept { return prior_ > 0 && prior_shares_[k] > 0; }
  PHIMIS_HOST_DEVICE bool multi() const noexcept { return model_ == sampling_model::multi_sample; }

  sampling_model model_;
  const column_pointers<Real>& rows_;
  floored_simplex& on_;
  const double* kappa_;
  const Real* costs_;
  double unit_;
  double mass_;
  double prior_;
  const double* prior_shares_;
  double* slope_;   // of V in β
  double* r_;       // ∫ f p_k/p
  double* shares_;  // β_k κ_k r_k
  double* gram_;
  double* pairs_;
  double cost_ = 1;
  double variance_ = 0;
  double second_ = 0;
};

}  // namespace phimis

#endif  // PHIMIS_CORE_VARIANCE_ON_SIMPLEX_HPP
