// SPDX-License-Identifier: MIT
#ifndef PHIMIS_ESTIMATOR_OPTIMAL_MIS_HPP
#define PHIMIS_ESTIMATOR_OPTIMAL_MIS_HPP

#include <phimis/core/estimator.hpp>
#include <phimis/core/fractions.hpp>
#include <phimis/core/weight_heuristic.hpp>
#include <phimis/estimator/control_coefficients.hpp>
#include <phimis/estimator/control_fit.hpp>

#include <cmath>
#include <cstdint>

namespace phimis {

/// The weight of technique i at a point, by Optimal MIS: least variance among all weights at given fractions.
///
///     w_i(x) = β_i p_i/f + α_i p_i/p(α) · (1 − Σ_k β_k p_k/f)
///
/// May be negative, and sums to one over i.
///
/// Source   Kondapaneni et al. 2019, with β in the unit of f and α_k = n_k/N.   Requires f ≠ 0.
template <int M>
double optimal_weight(int i, const control_coefficients<double, M>& control, double f,
                      const fractions<double, M>& alpha, const per_technique<double, M>& pdfs) {
  double fitted = 0;
  for (int k = 0; k < M; ++k) fitted += control.beta[k] * pdfs[k];
  return control.beta[i] * pdfs[i] / f + balance{}(i, alpha, pdfs) * (1 - fitted / f);
}

/// Where the coefficients of Optimal MIS come from.
enum class optimal_form {
  direct,      ///< the samples that they serve: consistent, with a bias of order 1/N
  progressive  ///< samples of earlier batches only: unbiased
};

/// Optimal MIS at given fractions without keeping samples: a state for each pixel.
///
///     direct:       A β = b, A = Σ_j (p_j/q_j)(p_j/q_j)ᵀ, b = Σ_j (f_j/q_j) p_j/q_j;   F = Σ_k β_k
///     progressive:  F = (1/N) Σ_j [Σ_k β_k + (f_j − Σ_k β_k p_kj)/q_j], β of the samples before the last `update`
///
/// q = p(α). These are the control variates of `control_fit` at α, and what `integrate` does with `pooled_control_variates`
/// without shrinkage and `progressive_control_variates` where fractions stay. Samples with f = 0 enter A.
///
/// - Kondapaneni et al. sum A and b; here their QR decomposition is kept, with the digits that A would square away.
/// - The coefficients of the progressive form are shrunk, since other samples have to bear their noise.
/// - With fewer than `control_fit::least` samples, or after a lost one, it is the balance heuristic.
///
/// Source   Kondapaneni et al. 2019, "Optimal multiple importance sampling", the direct and the progressive estimator.
/// Requires samples drawn at α, in either sampling model; pdfs that integrate to one.
template <class Value, int M>
class optimal_mis {
  using traits = value_traits<Value>;
  using real = typename traits::real;

 public:
  explicit optimal_mis(const fractions<double, M>& alpha = equal_fractions<double, M>(),
                       optimal_form form = optimal_form::direct)
      : alpha_(alpha), form_(form), fit_(alpha) {}

  /// Adds a sample of technique k.
  void add(int k, const Value& f, const per_technique<double, M>& pdfs) {
    const Value value = traits::finite(f) ? f : traits::zero();
    if (!traits::finite(f)) ++nonfinite_;
    const double q = mixture(alpha_, pdfs);
    sum_.add(k, controlled_contribution(control_, value, pdfs, q));
    fit_.add(value, pdfs, q);
  }

  /// The coefficients for the next batch of the progressive form. The direct form needs none.
  void update() {
    if (form_ == optimal_form::progressive) control_ = fit_.solve();
  }

  /// Adds the samples of another state at the same fractions; coefficients stay until the next update.
  void merge(const optimal_mis& other) {
    sum_.merge(other.sum_);
    fit_.merge(other.fit_);
    nonfinite_ += other.nonfinite_;
  }

  Value estimate() const {
    const control_coefficients<Value, M> fitted = coefficients();
    return form_ == optimal_form::direct && fitted.rank > 0 ? fitted.integral() : sum_.estimate();
  }

  Value standard_error(sampling_model model) const {
    const control_coefficients<Value, M> fitted = coefficients();
    if (form_ == optimal_form::progressive || fitted.rank == 0) return sum_.standard_error(model);
    // At the best β the techniques' means are equal, and both models have the same variance.
    const double n = static_cast<double>(fit_.samples());
    if (!(n > fitted.rank)) return traits::unknown();
    return fitted.residual_norm * static_cast<real>(1 / std::sqrt(n * (n - fitted.rank)));
  }

  /// β: of the next batch where it is progressive; of all samples where it is direct.
  control_coefficients<Value, M> coefficients() const {
    return form_ == optimal_form::direct ? fit_.solve(shrinkage::off) : control_;
  }

  std::int64_t samples() const noexcept { return sum_.samples(); }
  std::int64_t nonfinite() const noexcept { return sum_.nonfinite() + nonfinite_; }
  const phimis::fractions<double, M>& fractions() const noexcept { return alpha_; }

 private:
  phimis::fractions<double, M> alpha_;
  optimal_form form_;
  control_fit<Value, M> fit_;
  control_coefficients<Value, M> control_{};
  estimator<Value, M> sum_{};
  std::int64_t nonfinite_ = 0;
};

}  // namespace phimis

#endif  // PHIMIS_ESTIMATOR_OPTIMAL_MIS_HPP
