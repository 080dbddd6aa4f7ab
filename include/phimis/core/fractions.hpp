// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_FRACTIONS_HPP
#define PHIMIS_CORE_FRACTIONS_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/finite.hpp>

#include <type_traits>

namespace phimis {

/// One number for each of M techniques: fractions, floors, pdfs, costs. An aggregate for host and device.
template <class Real, int M>
struct per_technique {
  static_assert(M >= 1, "at least one technique is needed");
  Real value[M];

  PHIMIS_HOST_DEVICE constexpr Real& operator[](int k) noexcept { return value[k]; }
  PHIMIS_HOST_DEVICE constexpr const Real& operator[](int k) const noexcept { return value[k]; }
  PHIMIS_HOST_DEVICE static constexpr int size() noexcept { return M; }
  PHIMIS_HOST_DEVICE constexpr const Real* begin() const noexcept { return value; }
  PHIMIS_HOST_DEVICE constexpr const Real* end() const noexcept { return value + M; }
};

/// Shares α_1..α_M of the sample budget, on the simplex: α_k ≥ 0, Σ α_k = 1.
template <class Real, int M>
using fractions = per_technique<Real, M>;

/// The fractions α_k = 1/M.
template <class Real, int M>
PHIMIS_HOST_DEVICE constexpr fractions<Real, M> equal_fractions() noexcept {
  fractions<Real, M> equal{};
  for (int k = 0; k < M; ++k) equal[k] = Real(1) / Real(M);
  return equal;
}

/// Fractions proportional to the given shares, none below its defensive floor.
///
///     α_k = max(floor_k, shares_k · c),   c such that Σ α_k = 1
///
/// Shapes   shares[M], floors[M].
/// Requires shares_k >= 0, floors_k >= 0, Σ floors <= 1. Where every share is 0, the free budget is shared equally.
/// Cost     at most M passes over M numbers.
template <class Real, int M>
PHIMIS_HOST_DEVICE fractions<Real, M> with_floors(const per_technique<Real, M>& shares,
                                                  const per_technique<Real, M>& floors) noexcept {
  bool at_floor[M] = {};
  fractions<Real, M> result{};
  Real sum = 0;
  for (const Real share : shares) sum += share;
  const Real unit = is_finite(sum) ? Real(1) : Real(1) / Real(2 * M);  // the sum of large shares may overflow
  for (int pass = 0; pass <= M; ++pass) {
    Real budget = 1;
    Real total = 0;
    int unbound = 0;
    for (int k = 0; k < M; ++k) {
      PHIMIS_EXPECTS(is_density(shares[k]) && is_density(floors[k]));
      if (at_floor[k]) {
        budget -= floors[k];
      } else {
        total += unit * shares[k];
        ++unbound;
      }
    }
    if (unbound == 0) return floors;
    bool changed = false;
    for (int k = 0; k < M; ++k) {
      if (at_floor[k]) {
        result[k] = floors[k];
        continue;
      }
      result[k] = total > 0 ? budget * (unit * shares[k] / total) : budget / Real(unbound);
      if (result[k] < floors[k]) at_floor[k] = changed = true;
    }
    if (!changed) break;
  }
  return result;
}

/// The density of the mixture.  p(α, x) = Σ_k α_k p_k(x)
///
/// Source T Eq. 5.
template <class Real, int M>
PHIMIS_HOST_DEVICE constexpr Real mixture(const fractions<Real, M>& alpha,
                                          const per_technique<Real, M>& pdfs) noexcept {
  Real p = 0;
  for (int k = 0; k < M; ++k) p += alpha[k] * pdfs[k];
  return p;
}

}  // namespace phimis

#endif  // PHIMIS_CORE_FRACTIONS_HPP
