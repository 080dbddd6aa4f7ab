// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_OBSERVATION_HPP
#define PHIMIS_CORE_OBSERVATION_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/finite.hpp>
#include <phimis/core/fractions.hpp>

namespace phimis {

/// One sample as numbers: all that a rule ever learns of it.
///
/// Units f in the integrand's unit, pdfs and q in 1/measure. A colour enters by one scalar, its luminance.
template <class Real, int M>
struct observation {
  Real f;                       ///< f(x), the integrand; may be negative, rules use |f|
  per_technique<Real, M> pdfs;  ///< p_1(x)..p_M(x)
  Real q;                       ///< the density that x was drawn from, the mixture of its batch
  int technique;                ///< which technique drew x
};

/// An observation without units: what a rule stores.
///
///     u = |f| / Σp,   w = Σp / q,   y_k = p_k / Σp
///
/// so that f/p(α) = u / Σ α_k y_k and p_k/q = w y_k. Multiplying f by a constant multiplies every u; a change of
/// measure changes nothing else.
template <class Real, int M>
struct row {
  Real u;
  Real w;
  Real y[M];
};

/// Writes the row u, w, y[m] of an observation and says whether it is one: false where a number in it, or their quotient,
/// is not finite, where a pdf is negative, or where f ≠ 0 but q or all pdfs are 0. Such an observation is counted, never
/// summed. A lost sample, f = 0 where every pdf is 0, is a row of zeros.
template <class Real>
PHIMIS_HOST_DEVICE bool to_row(Real f, const Real* pdfs, int m, Real q, Real& u, Real& w, Real* y) noexcept {
  Real sum = 0;
  for (int k = 0; k < m; ++k) {
    if (!is_density(pdfs[k])) return false;
    sum += pdfs[k];
  }
  if (!is_finite(f) || !is_density(q) || !is_finite(sum)) return false;
  if (f == 0 && !(sum > 0)) {
    u = w = 0;
    for (int k = 0; k < m; ++k) y[k] = 0;
    return true;
  }
  if (!(sum > 0) || !(q > 0)) return false;
  u = (f < 0 ? -f : f) / sum;
  w = sum / q;
  for (int k = 0; k < m; ++k) y[k] = pdfs[k] / sum;
  return is_finite(u) && is_finite(w);
}
template <class Real, int M>
PHIMIS_HOST_DEVICE bool to_row(const observation<Real, M>& sample, row<Real, M>& out) noexcept {
  return to_row(sample.f, sample.pdfs.value, M, sample.q, out.u, out.w, out.y);
}

}  // namespace phimis

#endif  // PHIMIS_CORE_OBSERVATION_HPP
