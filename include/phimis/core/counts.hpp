// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_COUNTS_HPP
#define PHIMIS_CORE_COUNTS_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/fractions.hpp>

#include <cstdint>

namespace phimis {

/// Sample counts n_1..n_M of a batch.
template <int M>
using counts = per_technique<std::int64_t, M>;

/// Counts by largest remainder: n_k = ⌊Nα_k⌋, and what is left goes to the largest fractional parts.
///
/// Where N allows, a technique with α_k > 0 gets at least one sample, taken from the largest count: with n_k/N as
/// fractions, an estimate stays unbiased only if every technique that alone reaches a region is sampled.
///
/// Requires alpha on the simplex, budget >= 0.   Cost M² comparisons.
template <class Real, int M>
PHIMIS_HOST_DEVICE counts<M> split_largest_remainder(const fractions<Real, M>& alpha, std::int64_t budget) noexcept {
  PHIMIS_EXPECTS(budget >= 0);
  counts<M> n{};
  double remainder[M] = {};
  std::int64_t left = budget;
  int positive = 0;
  for (int k = 0; k < M; ++k) {
    const double share = static_cast<double>(alpha[k]) * static_cast<double>(budget);
    n[k] = static_cast<std::int64_t>(share);
    if (n[k] > left) n[k] = left;
    // Where Σα rounds to less than one, what is left must not go to a technique without a fraction.
    remainder[k] = alpha[k] > 0 ? share - static_cast<double>(n[k]) : -1e300;
    left -= n[k];
    if (alpha[k] > 0) ++positive;
  }
  for (; left > 0; --left) {
    int next = 0;
    for (int k = 1; k < M; ++k) {
      if (remainder[k] > remainder[next]) next = k;
    }
    ++n[next];
    remainder[next] -= 1;
  }
  if (budget < positive) return n;
  for (int k = 0; k < M; ++k) {
    if (!(alpha[k] > 0) || n[k] > 0) continue;
    int richest = 0;
    for (int l = 1; l < M; ++l) {
      if (n[l] > n[richest]) richest = l;
    }
    --n[richest];
    ++n[k];
  }
  return n;
}

/// Counts by systematic rounding of the running sums: one uniform number rounds all, and E[n_k] = Nα_k exactly.
///
///     n_k = ⌊N A_k + u⌋ − ⌊N A_{k−1} + u⌋,   A_k = α_1 + … + α_k
///
/// Each n_k is Nα_k rounded up or down, and they sum to N.
///
/// Requires alpha on the simplex, budget >= 0, u in [0, 1).
template <class Real, int M>
PHIMIS_HOST_DEVICE counts<M> split_systematic(const fractions<Real, M>& alpha, std::int64_t budget,
                                              double u) noexcept {
  PHIMIS_EXPECTS(budget >= 0 && u >= 0 && u < 1);
  counts<M> n{};
  double total = 0;
  for (int k = 0; k < M; ++k) total += static_cast<double>(alpha[k]);
  double sum = 0;
  std::int64_t before = 0;
  int last = 0;
  for (int k = 0; k < M; ++k) {
    sum += static_cast<double>(alpha[k]) / total * static_cast<double>(budget);
    std::int64_t upto = static_cast<std::int64_t>(sum + u);
    if (upto > budget) upto = budget;
    n[k] = upto - before;
    before = upto;
    if (alpha[k] > 0) last = k;
  }
  n[last] += budget - before;  // rounding of Σ α_k
  return n;
}

/// The technique that a uniform number picks with probabilities α: the one-sample model.
///
/// Requires u in [0, 1).   Errors none; never a technique with α_k = 0.
template <class Real, int M>
PHIMIS_HOST_DEVICE int pick_technique(const fractions<Real, M>& alpha, double u) noexcept {
  double sum = 0;
  int last = 0;
  for (int k = 0; k < M; ++k) {
    if (!(alpha[k] > 0)) continue;
    last = k;
    sum += static_cast<double>(alpha[k]);
    if (u < sum) return k;
  }
  return last;
}

}  // namespace phimis

#endif  // PHIMIS_CORE_COUNTS_HPP
