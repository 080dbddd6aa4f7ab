// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_TECHNIQUE_SUMS_HPP
#define PHIMIS_CORE_TECHNIQUE_SUMS_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/observation.hpp>

namespace phimis {

/// What the linear heuristic keeps of the samples X_kj of each technique k.
///
///     P_ik = Σ_j p_i(X_kj),   F_k = Σ_j |f(X_kj)|
///
/// Both in units of the largest Σp and |f| so far, so that no scale of them overflows.
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
    refer_to(density, f);
    if (density > 0) {
      for (int i = 0; i < M; ++i) p_[i][k] += sample.pdfs[i] / density_unit_;
    }
    if (f > 0) f_[k] += f / f_unit_;
  }

  PHIMIS_HOST_DEVICE void merge(const technique_sums& other) noexcept {
    technique_sums theirs = other;
    theirs.refer_to(density_unit_, f_unit_);
    refer_to(theirs.density_unit_, theirs.f_unit_);
    for (int k = 0; k < M; ++k) {
      f_[k] += theirs.f_[k];
      for (int i = 0; i < M; ++i) p_[i][k] += theirs.p_[i][k];
    }
  }

  /// P_ik and F_k, each in a unit of its own.
  PHIMIS_HOST_DEVICE double p(int i, int k) const noexcept { return static_cast<double>(p_[i][k]); }
  PHIMIS_HOST_DEVICE double f(int k) const noexcept { return static_cast<double>(f_[k]); }

 private:
  PHIMIS_HOST_DEVICE void refer_to(Real density, Real f) noexcept {
    if (density > density_unit_) {
      for (int i = 0; i < M; ++i) {
        for (int k = 0; k < M; ++k) p_[i][k] *= density_unit_ / density;
      }
      density_unit_ = density;
    }
    if (f > f_unit_) {
      for (int k = 0; k < M; ++k) f_[k] *= f_unit_ / f;
      f_unit_ = f;
    }
  }

  Real p_[M][M] = {};
  Real f_[M] = {};
  Real density_unit_ = 0;
  Real f_unit_ = 0;
};

}  // namespace phimis

#endif  // PHIMIS_CORE_TECHNIQUE_SUMS_HPP
