// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_ESTIMATOR_HPP
#define PHIMIS_CORE_ESTIMATOR_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/fractions.hpp>
#include <phimis/core/moments.hpp>
#include <phimis/core/value.hpp>
#include <phimis/core/weight_heuristic.hpp>

#include <cstdint>

namespace phimis {

/// What one sample of technique k adds to N times the estimate.
///
///     y = w_k(x) f(x) / (α_k p_k(x));   f(x) / p(α, x) for the balance heuristic
///
/// Source   T Eqs. 1, 6, 8.
/// Requires alpha = n_k/N where counts are decided, the probabilities α_k where they are drawn.
/// Errors   not finite where p_k(x) = 0 at its own sample; `estimator::add` counts it.
template <class Heuristic, class Value, class Real, int M>
PHIMIS_HOST_DEVICE Value contribution(const Heuristic& heuristic, int k, const Value& f,
                                      const fractions<Real, M>& alpha, const per_technique<Real, M>& pdfs) {
  return f * static_cast<typename value_traits<Value>::real>(heuristic(k, alpha, pdfs) / (alpha[k] * pdfs[k]));
}
template <class Value, class Real, int M>
PHIMIS_HOST_DEVICE Value contribution(const balance&, int, const Value& f, const fractions<Real, M>& alpha,
                                      const per_technique<Real, M>& pdfs) {
  return f * static_cast<typename value_traits<Value>::real>(Real(1) / mixture(alpha, pdfs));
}

/// How the technique of a sample is chosen.
enum class sampling_model {
  multi_sample,  ///< counts n_k are decided, α_k = n_k/N
  one_sample     ///< the technique is drawn at random for every sample
};

/// The estimate of one batch and its uncertainty.
///
///     F = Σ_j y_j / N
///     Var F = Σ_k n_k s_k² / N²   (multi-sample: spread within each technique)
///     Var ℱ = s² / N              (one-sample: spread of all samples)
///
/// Source T Eqs. 1, 3, 8, 9, with sample variances in place of σ².
/// - A technique with one sample has no spread of its own: its distance to the mean of all is taken, which is more.
template <class Value, int M>
class estimator {
 public:
  using real = typename value_traits<Value>::real;

  /// Adds one contribution. One that is not finite is counted and enters as 0.
  PHIMIS_HOST_DEVICE void add(int technique, const Value& y) {
    if (!value_traits<Value>::finite(y)) {
      ++nonfinite_;
      by_technique_[technique].add(value_traits<Value>::zero());
      magnitude_.add(real(0));
      return;
    }
    const real magnitude = value_traits<Value>::magnitude(y);
    if (!(magnitude > 0)) ++zero_;
    by_technique_[technique].add(y);
    magnitude_.add(magnitude);
  }

  PHIMIS_HOST_DEVICE void merge(const estimator& other) {
    for (int k = 0; k < M; ++k) by_technique_[k].merge(other.by_technique_[k]);
    magnitude_.merge(other.magnitude_);
    zero_ += other.zero_;
    nonfinite_ += other.nonfinite_;
  }

  PHIMIS_HOST_DEVICE std::int64_t samples() const noexcept { return magnitude_.count; }
  PHIMIS_HOST_DEVICE std::int64_t samples(int technique) const noexcept { return by_technique_[technique].count; }
  PHIMIS_HOST_DEVICE std::int64_t zero() const noexcept { return zero_; }
  PHIMIS_HOST_DEVICE std::int64_t nonfinite() const noexcept { return nonfinite_; }

  /// 0 without samples.
  PHIMIS_HOST_DEVICE Value estimate() const { return all().mean; }

  /// Variance of the estimate; 0 with fewer than two samples.
  PHIMIS_HOST_DEVICE Value variance(sampling_model model) const {
    const moments<Value> total = all();
    if (total.count < 2) return value_traits<Value>::zero();
    const real inverse = real(1) / static_cast<real>(total.count);
    if (model == sampling_model::one_sample) return total.variance() * inverse;
    Value sum = value_traits<Value>::zero();
    for (int k = 0; k < M; ++k) {
      const moments<Value>& own = by_technique_[k];
      if (own.count > 1) sum = sum + own.variance() * static_cast<real>(own.count);
      if (own.count == 1) sum = sum + (own.mean - total.mean) * (own.mean - total.mean);
    }
    return sum * (inverse * inverse);
  }

  PHIMIS_HOST_DEVICE Value standard_error(sampling_model model) const {
    return value_traits<Value>::root(variance(model));
  }

  /// Kish's effective sample size of the contributions.  (Σ|y|)² / Σ y², 0 where all are 0
  PHIMIS_HOST_DEVICE real effective_sample_size() const {
    if (!(magnitude_.mean > 0)) return 0;
    const real n = static_cast<real>(magnitude_.count);
    return n / (1 + magnitude_.squares / n / (magnitude_.mean * magnitude_.mean));
  }

 private:
  PHIMIS_HOST_DEVICE moments<Value> all() const {
    moments<Value> total;
    for (int k = 0; k < M; ++k) total.merge(by_technique_[k]);
    return total;
  }

  moments<Value> by_technique_[M]{};
  moments<real> magnitude_{};
  std::int64_t zero_ = 0;
  std::int64_t nonfinite_ = 0;
};

}  // namespace phimis

#endif  // PHIMIS_CORE_ESTIMATOR_HPP
