// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_ESTIMATOR_HPP
#define PHIMIS_CORE_ESTIMATOR_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/finite.hpp>
#include <phimis/core/fractions.hpp>
#include <phimis/core/moments.hpp>
#include <phimis/core/value.hpp>
#include <phimis/core/weight_heuristic.hpp>

#include <cmath>
#include <cstdint>

namespace phimis {

namespace detail {

/// weight · f / density; 0 for a lost sample, f = 0 where there is no density; infinite where a pdf is no density.
template <class Value, class Real, int M>
PHIMIS_HOST_DEVICE Value per_density(const Value& f, Real weight, Real density, const per_technique<Real, M>& pdfs) {
  using traits = value_traits<Value>;
  for (int k = 0; k < M; ++k) {
    if (!is_density(pdfs[k])) return traits::unknown();
  }
  if (!(density > 0) && traits::finite(f) && !(traits::magnitude(f) > 0)) return traits::zero();
  return f * static_cast<typename traits::real>(weight / density);
}

}  // namespace detail

/// What one sample of technique k adds to N times the estimate.
///
///     y = w_k(x) f(x) / (α_k p_k(x));   f(x) / p(α, x) for the balance heuristic
///
/// Source   T Eqs. 1, 6, 8.
/// Requires alpha = n_k/N where counts are decided, the probabilities α_k where they are drawn.
/// Errors   0 where f is 0, as at a lost sample; not finite, which `estimator::add` counts, where a pdf is negative or not
///          finite, as a delta's, or where f ≠ 0 and p_k(x) = 0 at its own sample.
template <class Heuristic, class Value, class Real, int M>
PHIMIS_HOST_DEVICE Value contribution(const Heuristic& heuristic, int k, const Value& f,
                                      const fractions<Real, M>& alpha, const per_technique<Real, M>& pdfs) {
  return detail::per_density(f, heuristic(k, alpha, pdfs), alpha[k] * pdfs[k], pdfs);
}
template <class Value, class Real, int M>
PHIMIS_HOST_DEVICE Value contribution(const balance&, int, const Value& f, const fractions<Real, M>& alpha,
                                      const per_technique<Real, M>& pdfs) {
  return detail::per_density(f, Real(1), mixture(alpha, pdfs), pdfs);
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
///     ν = (Σ_k V_k)² / Σ_k V_k²/(n_k − 1),   V_k = n_k s_k² / N²      (one-sample: N − 1)
///
/// Source T Eqs. 1, 3, 8, 9, with sample variances in place of σ²; ν of Satterthwaite 1946.
/// - A technique with one sample has no spread of its own: its distance to the mean of the others is taken, whose
///   square is more on average.
/// - Contributions are kept in units of a power of two near the first that is not 0, so that no scale of f overflows.
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
    if (!(unit_ > 0) && magnitude > 0) unit_ = unit_near(magnitude);
    const real scale = unit_ > 0 ? 1 / unit_ : real(1);
    by_technique_[technique].add(y * scale);
    magnitude_.add(magnitude * scale);
  }

  PHIMIS_HOST_DEVICE void merge(const estimator& other) {
    if (!(unit_ > 0)) unit_ = other.unit_;
    const real ratio = other.unit_ > 0 ? other.unit_ / unit_ : real(1);
    for (int k = 0; k < M; ++k) by_technique_[k].merge(scaled(other.by_technique_[k], ratio));
    magnitude_.merge(scaled(other.magnitude_, ratio));
    zero_ += other.zero_;
    nonfinite_ += other.nonfinite_;
  }

  PHIMIS_HOST_DEVICE std::int64_t samples() const noexcept { return magnitude_.count; }
  PHIMIS_HOST_DEVICE std::int64_t samples(int technique) const noexcept { return by_technique_[technique].count; }
  PHIMIS_HOST_DEVICE std::int64_t zero() const noexcept { return zero_; }
  PHIMIS_HOST_DEVICE std::int64_t nonfinite() const noexcept { return nonfinite_; }

  /// 0 without samples.
  PHIMIS_HOST_DEVICE Value estimate() const { return all().mean * unit(); }

  /// Variance of the estimate; infinite, for unknown, with fewer than two samples.
  PHIMIS_HOST_DEVICE Value variance(sampling_model model) const { return variance_in_units(model) * unit() * unit(); }

  /// Square root of the variance, also where that would overflow.
  PHIMIS_HOST_DEVICE Value standard_error(sampling_model model) const {
    return value_traits<Value>::root(variance_in_units(model)) * unit();
  }

  /// ν: the variance is about as uncertain as that of ν + 1 normal numbers. 0 where it is unknown. A technique with one
  /// sample has 1, as has its distance to the mean.
  PHIMIS_HOST_DEVICE real degrees_of_freedom(sampling_model model) const {
    const moments<Value> total = all();
    if (total.count < 2) return 0;
    if (model == sampling_model::one_sample) return static_cast<real>(total.count - 1);
    const real sum = value_traits<Value>::magnitude(sum_of_spreads(total));
    real own = 0;
    real inverse = 0;  // Σ (V_k / ΣV)² / ν_k
    for (int k = 0; k < M; ++k) {
      if (by_technique_[k].count == 0) continue;
      const real freedom = by_technique_[k].count > 1 ? static_cast<real>(by_technique_[k].count - 1) : real(1);
      const real share = sum > 0 ? value_traits<Value>::magnitude(spread_of(k, total)) / sum : real(0);
      own += freedom;
      inverse += share * share / freedom;
    }
    return inverse > 0 ? 1 / inverse : own;
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

  PHIMIS_HOST_DEVICE real unit() const noexcept { return unit_ > 0 ? unit_ : real(1); }

  PHIMIS_HOST_DEVICE Value variance_in_units(sampling_model model) const {
    const moments<Value> total = all();
    if (total.count < 2) return value_traits<Value>::unknown();
    const real n = static_cast<real>(total.count);
    if (model == sampling_model::one_sample) return total.variance() * (1 / n);
    return sum_of_spreads(total) * (1 / (n * n));
  }

  /// n_k s_k², in units.
  PHIMIS_HOST_DEVICE Value spread_of(int k, const moments<Value>& total) const {
    const moments<Value>& own = by_technique_[k];
    if (own.count != 1) return own.variance() * static_cast<real>(own.count);
    const real n = static_cast<real>(total.count);
    const Value apart = (own.mean - total.mean) * (n / (n - 1));
    return apart * apart;
  }
  PHIMIS_HOST_DEVICE Value sum_of_spreads(const moments<Value>& total) const {
    Value sum = value_traits<Value>::zero();
    for (int k = 0; k < M; ++k) sum = sum + spread_of(k, total);
    return sum;
  }

  /// A power of two within a factor of 2, whose inverse is a number too.
  PHIMIS_HOST_DEVICE static real unit_near(real magnitude) noexcept {
    int exponent = 0;
    (void)std::frexp(magnitude, &exponent);
    constexpr int least = sizeof(real) == 8 ? -1000 : -120;
    return std::ldexp(real(1), exponent > least ? exponent - 1 : least);
  }

  template <class V>
  PHIMIS_HOST_DEVICE static moments<V> scaled(moments<V> of, real ratio) {
    of.mean = of.mean * ratio;
    of.squares = of.squares * ratio * ratio;
    return of;
  }

  moments<Value> by_technique_[M]{};
  moments<real> magnitude_{};
  std::int64_t zero_ = 0;
  std::int64_t nonfinite_ = 0;
  real unit_ = 0;  // of by_technique_ and magnitude_; 0 before the first contribution that is not 0
};

}  // namespace phimis

#endif  // PHIMIS_CORE_ESTIMATOR_HPP
