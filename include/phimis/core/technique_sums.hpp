// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_TECHNIQUE_SUMS_HPP
#define PHIMIS_CORE_TECHNIQUE_SUMS_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/limits.hpp>
#include <phimis/core/observation.hpp>

namespace phimis {

/// What the linear heuristic keeps of the samples X_kj of each technique k.
///
///     P_ik = Σ_j p_i(X_kj),   F_k = Σ_j |f(X_kj)|
///
/// Each in a unit near the largest Σp and |f| so far, so that no scale of them overflows.
///
/// Source L Eq. 18.
template <class Real, int M>
class technique_sums {
 public:
  /// Requires what `to_row` admits, and a technique in 0..M−1.
  PHIMIS_HOST_DEVICE void add(const observation<Real, M>& sample) noexcept {
    const int k = sample.technique;
    PHIMIS_EXPECTS(k >= 0 && k < M);
    Real density = 0;
    for (int i = 0; i < M; ++i) density += sample.pdfs[i];
    const Real f = sample.f < 0 ? -sample.f : sample.f;
    if (density * per_density_ > 1) lower(inverse(density), per_f_);
    if (f * per_f_ > 1) lower(per_density_, inverse(f));
    if (density > 0) {
      for (int i = 0; i < M; ++i) p_[i][k] += sample.pdfs[i] * per_density_;
    }
    if (f > 0) f_[k] += f * per_f_;
  }

  PHIMIS_HOST_DEVICE void merge(const technique_sums& other) noexcept {
    technique_sums theirs = other;
    theirs.lower(per_density_, per_f_);
    lower(theirs.per_density_, theirs.per_f_);
    for (int k = 0; k < M; ++k) {
      f_[k] += theirs.f_[k];
      for (int i = 0; i < M; ++i) p_[i][k] += theirs.p_[i][k];
    }
  }

  /// P_ik and F_k, each in a unit of its own.
  PHIMIS_HOST_DEVICE double p(int i, int k) const noexcept { return static_cast<double>(p_[i][k]); }
  PHIMIS_HOST_DEVICE double f(int k) const noexcept { return static_cast<double>(f_[k]); }

 private:
  static constexpr Real most = 1 / (4 * smallest_normal<Real>);

  /// 1/x; of a huge x the smallest number that -ffast-math does not take for 0.
  PHIMIS_HOST_DEVICE static Real inverse(Real x) noexcept {
    return x * smallest_normal<Real> < 1 ? 1 / x : smallest_normal<Real>;
  }

  /// Takes larger units, where these are.
  PHIMIS_HOST_DEVICE void lower(Real per_density, Real per_f) noexcept {
    if (per_density < per_density_) {
      const Real ratio = per_density / per_density_;
      for (int i = 0; i < M; ++i) {
        for (int k = 0; k < M; ++k) p_[i][k] *= ratio;
      }
      per_density_ = per_density;
    }
    if (per_f < per_f_) {
      for (int k = 0; k < M; ++k) f_[k] *= per_f / per_f_;
      per_f_ = per_f;
    }
  }

  Real p_[M][M] = {};
  Real f_[M] = {};
  Real per_density_ = most;  // the inverse of the unit, by which every sample is multiplied
  Real per_f_ = most;
};

}  // namespace phimis

#endif  // PHIMIS_CORE_TECHNIQUE_SUMS_HPP
