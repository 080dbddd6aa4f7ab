// SPDX-License-Identifier: MIT
#ifndef PHIMIS_ANALYSIS_VARIANCE_HPP
#define PHIMIS_ANALYSIS_VARIANCE_HPP

#include <phimis/analysis/problem.hpp>
#include <phimis/core/divergence.hpp>
#include <phimis/core/divergence_at.hpp>
#include <phimis/core/limits.hpp>

#include <cmath>

namespace phimis::analysis {

/// The γ-moments.  M_{γ,k} = ∫ (|f|/p(α))^γ p_k dx
///
/// Source T Eq. 25.
template <int M>
per_technique<measured, M> gamma_moments(const problem<M>& on, double gamma, const fractions<double, M>& alpha) {
  per_technique<measured, M> moments{};
  for (int k = 0; k < M; ++k) {
    moments[k] = on.integral([&](double f, const per_technique<double, M>& p, double) {
      return f == 0 || p[k] == 0 ? 0 : p[k] * std::pow(std::fabs(f) / mixture(alpha, p), gamma);
    });
  }
  return moments;
}

/// Variances for N = 1 at given fractions.
struct variances {
  measured multi_sample;  ///< V[F]
  measured one_sample;    ///< V[ℱ]
  measured difference;    ///< V[ℱ] − V[F] = Σ α_k (μ'_k − μ)² ≥ 0
};

/// Exact variances of the balance heuristic.
///
///     V[ℱ] = ∫ (f/p(α) − μ)² p(α) dx
///     V[F] = V[ℱ] − Σ_k α_k (μ'_k − μ)²,   μ'_k = ∫ f p_k/p(α) dx
///
/// Source T Eqs. 7, 9, written as sums of squares: ∫f²/p − μ² loses all digits where the variance vanishes. What a
///        defective pdf misses counts as samples of value 0.
/// Errors infinite where p(α) = 0 < |f|.
template <int M>
variances variance(const problem<M>& on, const fractions<double, M>& alpha) {
  using pdfs = per_technique<double, M>;
  const double mu = on.mean().value;
  variances result{};
  result.one_sample = on.integral([&](double f, const pdfs& p, double) {
    const double q = mixture(alpha, p);
    if (q == 0) return f == 0 ? 0.0 : infinity<double>;
    return (f / q - mu) * (f / q - mu) * q;
  });
  // The rounding of f/p and μ, which is all that is left where the variance vanishes.
  constexpr double rounding = 1e-15;
  result.one_sample.error += on.integral([&](double f, const pdfs& p, double) {
                                 const double q = mixture(alpha, p);
                                 if (q == 0) return 0.0;
                                 const double error = rounding * (std::fabs(f / q) + std::fabs(mu));
                                 return (2 * std::fabs(f / q - mu) + error) * error * q;
                               }).value;
  for (int k = 0; k < M; ++k) {
    const double missing = on.missing_mass()[k];
    measured excess = on.integral([&](double f, const pdfs& p, double) {
      const double q = mixture(alpha, p);
      return q == 0 ? 0.0 : p[k] * (f / q - mu);
    });
    excess.value -= missing * mu;
    result.one_sample.value += alpha[k] * missing * mu * mu;
    if (missing != 0) result.one_sample.error += alpha[k] * rounding * mu * mu;
    result.difference.value += alpha[k] * excess.value * excess.value;
    result.difference.error += alpha[k] * (2 * std::fabs(excess.value) + excess.error) * excess.error;
  }
  result.multi_sample = {result.one_sample.value - result.difference.value,
                         result.one_sample.error + result.difference.error};
  return result;
}

/// The divergence between g = |f|/∫|f| and the mixture.  D_φ(g, p) = ∫ p(α) φ(g/p(α)) dx
///
/// Reversed divergences give D_φ(p, g).   Source T Eqs. 11, 21.
template <class Divergence, int M>
measured divergence_at(const Divergence& divergence, const problem<M>& on, const fractions<double, M>& alpha) {
  measured result = on.integral([&](double f, const per_technique<double, M>& p, double) {
    const double q = mixture(alpha, p);
    if (q == 0) return f == 0 ? 0.0 : infinity<double>;
    return q * phi_at(divergence, std::fabs(f) / (on.size() * q));
  });
  constexpr double rounding = 4 * epsilon<double>;
  result.error += rounding * (2 + std::fabs(result.value));  // of t, in φ
  // What defective pdfs lose has g = 0.
  const double missing = mixture(alpha, on.missing_mass());
  if (missing > 0) result.value += missing * phi_at(divergence, 0.0);
  return result;
}

}  // namespace phimis::analysis

#endif  // PHIMIS_ANALYSIS_VARIANCE_HPP
