// SPDX-License-Identifier: MIT
#ifndef PHIMIS_ESTIMATOR_CONTROL_COEFFICIENTS_HPP
#define PHIMIS_ESTIMATOR_CONTROL_COEFFICIENTS_HPP

#include <phimis/core/estimator.hpp>
#include <phimis/core/fractions.hpp>
#include <phimis/core/value.hpp>

namespace phimis {

/// The pdfs as control variates: what is subtracted from f, and its integral.
///
///     f(x) − Σ_k β_k p_k(x),   ∫ Σ_k β_k p_k dx = Σ_k β_k
///
/// β = 0 is no control variate; β = c α, for any number c, is none that an estimate at fractions α would notice.
///
/// Requires pdfs that integrate to one. With a defective pdf, ∫ p_k < 1, the estimate is off by β_k times what is missing.
template <class Value, int M>
struct control_coefficients {
  per_technique<Value, M> beta = zeros();
  int rank = 0;  ///< of the regression that β comes from; 0 where there is none
  Value residual_norm =
      value_traits<Value>::zero();  ///< of that regression: n times its mean square is the square of this

  /// Σ β_k
  Value integral() const {
    Value sum = value_traits<Value>::zero();
    for (int k = 0; k < M; ++k) sum = sum + beta[k];
    return sum;
  }

  static per_technique<Value, M> zeros() {
    per_technique<Value, M> all{};
    for (int k = 0; k < M; ++k) all[k] = value_traits<Value>::zero();
    return all;
  }
};

/// What one sample adds to N times an estimate with control variates.
///
///     y = Σ_k β_k + (f(x) − Σ_k β_k p_k(x)) / q(x)
///
/// Where f = 0 the pdfs are subtracted like anywhere else: leaving them out biases the estimate. An `estimator` of these
/// has the estimate and its standard error. It is unbiased where β does not depend on the samples.
///
/// Source   Owen & Zhou 2000, "Safe and effective importance sampling"; He & Owen 2014.
/// Requires q the density of x: of its batch, or of the aggregate mixture of all batches whose samples are summed;
///          above 0 wherever a pdf with β_k ≠ 0 is.
/// Errors   as `contribution`.
template <class Value, int M>
Value controlled_contribution(const control_coefficients<Value, M>& control, const Value& f,
                              const per_technique<double, M>& pdfs, double q) {
  using real = typename value_traits<Value>::real;
  Value rest = f;
  for (int k = 0; k < M; ++k) rest = rest - control.beta[k] * static_cast<real>(pdfs[k]);
  return control.integral() + detail::per_density(rest, 1.0, q, pdfs);
}

}  // namespace phimis

#endif  // PHIMIS_ESTIMATOR_CONTROL_COEFFICIENTS_HPP
