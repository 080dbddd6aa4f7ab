// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_MOVABLE_TECHNIQUES_HPP
#define PHIMIS_CORE_MOVABLE_TECHNIQUES_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/fractions.hpp>
#include <phimis/core/rule.hpp>

namespace phimis {

/// The techniques that can move, and where the others are.  α = fixed + free · τ, τ on the simplex of the first `size`
///
/// fixed_k is the floor of a technique, or the start of a frozen one: no solver has to know of either.
template <int M>
struct movable_techniques {
  double fixed[M];
  double free;
  int technique[M];  ///< increasing
  int size;

  template <class Real>
  PHIMIS_HOST_DEVICE explicit movable_techniques(const rule_options<Real, M>& options) noexcept
      : fixed{}, free(1), technique{}, size(0) {
    for (int k = 0; k < M; ++k) {
      fixed[k] = static_cast<double>(options.frozen[k] ? options.start[k] : options.floors[k]);
      free -= fixed[k];
      if (!options.frozen[k]) technique[size++] = k;
    }
  }

  PHIMIS_HOST_DEVICE bool any() const noexcept { return size > 1 && free > 0; }

  PHIMIS_HOST_DEVICE fractions<double, M> at(const double (&tau)[M]) const noexcept {
    fractions<double, M> alpha{};
    for (int k = 0; k < M; ++k) alpha[k] = fixed[k];
    for (int i = 0; i < size; ++i) alpha[technique[i]] += free * tau[i];
    return alpha;
  }

  /// Whether no fraction is below what is fixed.
  PHIMIS_HOST_DEVICE bool feasible(const double (&tau)[M]) const noexcept {
    for (int i = 0; i < size; ++i) {
      if (!(tau[i] >= 0)) return false;
    }
    return true;
  }

  /// Makes the normal equations of fits by the pdfs those by the mixtures at the corners fixed + free e_i: fits in which
  /// these are nonnegative respect what is fixed. In place, since techniques increase.
  ///
  /// Shapes   g[M][M], b[M]; then the first `size` of each.
  PHIMIS_HOST_DEVICE void to_corners(double (&g)[M][M], double (&b)[M]) const noexcept {
    double row[M] = {};  // G fixed
    double base = 0;
    double right = 0;
    for (int i = 0; i < M; ++i) {
      for (int k = 0; k < M; ++k) row[i] += g[i][k] * fixed[k];
      base += fixed[i] * row[i];
      right += fixed[i] * b[i];
    }
    for (int i = 0; i < size; ++i) {
      const int t = technique[i];
      b[i] = right + free * b[t];
      for (int k = 0; k < size; ++k) {
        const int s = technique[k];
        g[i][k] = base + free * (row[t] + row[s] + free * g[t][s]);
      }
    }
  }

  /// The face of the simplex on which every technique moves; bit i is the technique of τ_i.
  PHIMIS_HOST_DEVICE unsigned all() const noexcept { return (1u << size) - 1u; }
};

}  // namespace phimis

#endif  // PHIMIS_CORE_MOVABLE_TECHNIQUES_HPP
