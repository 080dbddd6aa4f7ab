// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_WEIGHT_HEURISTIC_HPP
#define PHIMIS_CORE_WEIGHT_HEURISTIC_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/fractions.hpp>

#include <cmath>

namespace phimis {

namespace detail {

/// The largest α_k p_k, and the first technique that has it.
template <class Real, int M>
PHIMIS_HOST_DEVICE int largest_share(const fractions<Real, M>& alpha, const per_technique<Real, M>& pdfs) noexcept {
  int largest = 0;
  for (int k = 1; k < M; ++k) {
    if (alpha[k] * pdfs[k] > alpha[largest] * pdfs[largest]) largest = k;
  }
  return largest;
}

}  // namespace detail

/// Balance heuristic: every technique counts by its share of the density.
///
///     w_i(x) = α_i p_i(x) / Σ_k α_k p_k(x)
///
/// Source   Veach & Guibas 1995; T Eq. 4.
/// Shapes   alpha[M], pdfs[M].   Units  pdfs in 1/measure; result in [0, 1], summing to one over i.
/// Requires pdfs[k] >= 0.        Errors none; 0 where every α_k p_k is 0.
struct balance {
  template <class Real, int M>
  PHIMIS_HOST_DEVICE Real operator()(int i, const fractions<Real, M>& alpha,
                                     const per_technique<Real, M>& pdfs) const noexcept {
    const Real p = mixture(alpha, pdfs);
    return p > 0 ? alpha[i] * pdfs[i] / p : Real(0);
  }
};

/// Power heuristic of exponent β ≥ 0.  w_i = (α_i p_i)^β / Σ_k (α_k p_k)^β
///
/// Source Veach & Guibas 1995, who recommend β = 2. Shapes and errors as balance.
struct power {
  double beta = 2;
  template <class Real, int M>
  PHIMIS_HOST_DEVICE Real operator()(int i, const fractions<Real, M>& alpha,
                                     const per_technique<Real, M>& pdfs) const noexcept {
    const int largest = detail::largest_share(alpha, pdfs);
    const Real scale = alpha[largest] * pdfs[largest];
    if (!(scale > 0)) return 0;
    Real sum = 0;
    Real mine = 0;
    for (int k = 0; k < M; ++k) {
      const Real share = alpha[k] * pdfs[k] / scale;  // at most 1: no power overflows
      const Real term = !(share > 0) ? Real(0) : beta == 2 ? share * share : std::pow(share, static_cast<Real>(beta));
      sum += term;
      if (k == i) mine = term;
    }
    return mine / sum;
  }
};

/// Cutoff heuristic of threshold a in [0, 1]: the balance heuristic among those techniques that have at least the
/// share a of the largest α_k p_k; 0 for the others.
///
/// Source Veach & Guibas 1995. Shapes and errors as balance.
struct cutoff {
  double threshold = 0.1;
  template <class Real, int M>
  PHIMIS_HOST_DEVICE Real operator()(int i, const fractions<Real, M>& alpha,
                                     const per_technique<Real, M>& pdfs) const noexcept {
    const int largest = detail::largest_share(alpha, pdfs);
    const Real least = static_cast<Real>(threshold) * (alpha[largest] * pdfs[largest]);
    if (!(alpha[i] * pdfs[i] > 0) || alpha[i] * pdfs[i] < least) return 0;
    Real sum = 0;
    for (int k = 0; k < M; ++k) {
      const Real share = alpha[k] * pdfs[k];
      if (share >= least) sum += share;
    }
    return alpha[i] * pdfs[i] / sum;
  }
};

/// Maximum heuristic: 1 for the technique with the largest α_k p_k, the first of equals; 0 for the others.
///
/// Source Veach & Guibas 1995. Shapes and errors as balance.
struct maximum {
  template <class Real, int M>
  PHIMIS_HOST_DEVICE Real operator()(int i, const fractions<Real, M>& alpha,
                                     const per_technique<Real, M>& pdfs) const noexcept {
    const int largest = detail::largest_share(alpha, pdfs);
    return i == largest && alpha[i] * pdfs[i] > 0 ? Real(1) : Real(0);
  }
};

/// Weights that do not depend on the counts: a heuristic evaluated at equal fractions, whatever the fractions are.
///
///     w_i(x) = p_i(x) / Σ_k p_k(x)                        (balance)
///     F = Σ_i (1/n_i) Σ_j f(X_ij) / Σ_k p_k(X_ij)
///     V[F] = Σ_i σ_i² / n_i                               with σ_i² free of the counts
///
/// so that n_i ∝ σ_i, or σ_i/√c_i with costs, is optimal: `sigma_proportional`. At equal counts it is the heuristic itself.
///
/// Source   V Eqs. 25–29; the inner heuristic may be any, V after Eq. 30.   (V: Sbert, Havran & Szirmay-Kalos 2016)
/// Requires every technique is sampled that has a weight: with n_i = 0 its part of f is lost, and the estimate is biased.
/// Shapes and errors as the inner heuristic.
template <class Heuristic = balance>
struct count_independent {
  Heuristic inner{};
  template <class Real, int M>
  PHIMIS_HOST_DEVICE Real operator()(int i, const fractions<Real, M>&, const per_technique<Real, M>& pdfs) const {
    return inner(i, equal_fractions<Real, M>(), pdfs);
  }
};
template <class Heuristic>
count_independent(Heuristic) -> count_independent<Heuristic>;

}  // namespace phimis

#endif  // PHIMIS_CORE_WEIGHT_HEURISTIC_HPP
