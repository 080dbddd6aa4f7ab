// SPDX-License-Identifier: MIT
#ifndef PHIMIS_ESTIMATOR_RUN_ESTIMATE_HPP
#define PHIMIS_ESTIMATOR_RUN_ESTIMATE_HPP

#include <phimis/concepts.hpp>
#include <phimis/core/estimator.hpp>
#include <phimis/core/finite.hpp>
#include <phimis/core/limits.hpp>
#include <phimis/error.hpp>
#include <phimis/estimator/batch.hpp>
#include <phimis/estimator/combination.hpp>
#include <phimis/estimator/control_coefficients.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace phimis::detail {

/// A combination that is more than weights of iterations: it keeps what it needs in a `run` of its own.
template <class T>
concept run_policy = requires {
  typename T::template run<double, 2>;
};

template <class Value>
struct combined {
  Value estimate;
  Value standard_error;
  double effective_sample_size;
  double degrees_of_freedom;
};

/// F = Σ w_b F_b / Σ w_b, Var F = Σ w_b² Var F_b / (Σ w_b)², over the iterations of a trace. An iteration of one sample
/// has the given spread.
///
///     ν = (Σ_b V_b)² / Σ_b V_b²/ν_b,   V_b = w_b² Var F_b
///
/// Source Satterthwaite 1946.
template <class Value, class Line, combination Combination>
combined<Value> combine(const Combination& combination, const std::vector<Line>& trace, const Value& spread) {
  using traits = value_traits<Value>;
  using real = typename traits::real;
  std::vector<iteration_summary> summaries;
  std::vector<Value> errors;
  double largest = 0;
  for (const auto& it : trace) {
    errors.push_back(it.samples > 1 ? it.standard_error : spread);
    const double error = static_cast<double>(traits::magnitude(errors.back()));
    summaries.push_back({it.samples, error, it.zero + it.nonfinite == it.samples});
    largest = std::max(largest, error);
  }
  std::vector<double> weights(trace.size());
  combination(std::span<const iteration_summary>(summaries), std::span<double>(weights));
  double sum = 0;
  for (const double w : weights) {
    require(is_density(w), "a combination's weights", "must be finite and not negative", w);
    sum += w;
  }
  require(sum > 0 && is_finite(sum), "a combination's weights", "must have a finite sum greater than 0", sum);

  // Squares are taken in units of the largest.
  const real unit = largest > 0 && is_finite(largest) ? static_cast<real>(largest) : real(1);
  Value estimate = traits::zero();
  Value variance = traits::zero();
  double reached = 0;
  double spent = 0;
  double total = 0;    // Σ V_b
  double squares = 0;  // Σ V_b²/ν_b
  double own = 0;
  for (std::size_t b = 0; b < trace.size(); ++b) {
    const double share = weights[b] / sum;
    if (!(share > 0)) continue;
    estimate = estimate + trace[b].estimate * static_cast<real>(share);
    const Value part = errors[b] * (static_cast<real>(share) / unit);
    variance = variance + part * part;
    const double size = static_cast<double>(traits::magnitude(part));
    const double of_its_own = std::max(trace[b].degrees_of_freedom, 1.0);
    total += size * size;
    squares += size * size * size * size / of_its_own;
    own += of_its_own;
    if (!(trace[b].effective_sample_size > 0)) continue;
    reached += share;
    spent += share * share / trace[b].effective_sample_size;
  }
  // An infinite variance is an unknown one.
  const double freedom = !is_finite(squares) ? 0 : squares > 0 ? total * total / squares : own;
  return {estimate, traits::root(variance) * unit, spent > 0 ? reached * reached / spent : 0, freedom};
}

/// The samples of a run, with the aggregate mixture of their batches.
template <class Value, int M>
class sample_pool {
 public:
  using sample = drawn_sample<Value, M>;

  /// One that is not finite counts as a sample of value 0.
  void add(sample one) {
    if (!value_traits<Value>::finite(one.value)) one.value = value_traits<Value>::zero();
    samples_.push_back(one);
  }
  void close_batch(const phimis::batch<Value, M>& drawn) {
    for (int k = 0; k < M; ++k) shares_[k] += drawn.fractions[k] * static_cast<double>(samples_.size() - closed_);
    closed_ = samples_.size();
    if (drawn.variance == sampling_model::one_sample) model_ = sampling_model::one_sample;
  }

  std::span<const sample> all() const { return samples_; }
  std::span<const sample> earlier() const { return all().first(closed_); }
  std::span<const sample> batch() const { return all().subspan(closed_); }

  /// ᾱ = Σ_b n_b α_b / n
  fractions<double, M> aggregate() const {
    fractions<double, M> alpha = shares_;
    for (int k = 0; k < M; ++k) alpha[k] /= static_cast<double>(closed_);
    return alpha;
  }
  /// Which variance holds: the multi-sample one where it did for every batch.
  sampling_model model() const { return model_; }

 private:
  std::vector<sample> samples_;
  per_technique<double, M> shares_{};
  std::size_t closed_ = 0;
  sampling_model model_ = sampling_model::multi_sample;
};

/// The estimate of a run, as a combination makes it: the driver's half of that policy.
///
/// `add` takes every sample of a batch; `close` ends the batch and returns the iteration's own estimate; `total` is the
/// estimate of all iterations; `control` are the control variates in it. A policy with a member template `run<Value, M>`
/// brings its own.
template <class Value, int M, combination Combination>
class combined_estimate {
 public:
  combined_estimate(const Combination& combination, sampling_model) : combination_(combination) {}

  void add(const drawn_sample<Value, M>&) {}
  estimator<Value, M> close(const batch<Value, M>& drawn) { return drawn.estimator; }
  template <class Heuristic, class Line>
  combined<Value> total(const Heuristic&, const std::vector<Line>& trace, const Value& spread) const {
    return combine(combination_, trace, spread);
  }
  control_coefficients<Value, M> control() const { return {}; }

 private:
  Combination combination_;
};

/// All samples as one batch of the aggregate mixture.
template <class Value, int M>
class pooled_estimate {
 public:
  pooled_estimate(const pooled&, sampling_model) {}

  void add(const drawn_sample<Value, M>& sample) { pool_.add(sample); }
  estimator<Value, M> close(const batch<Value, M>& drawn) {
    pool_.close_batch(drawn);
    return drawn.estimator;
  }
  template <class Heuristic, class Line>
  combined<Value> total(const Heuristic& heuristic, const std::vector<Line>&, const Value&) const {
    const fractions<double, M> alpha = pool_.aggregate();
    estimator<Value, M> all;
    for (const auto& s : pool_.all()) {
      const int k = s.observed.technique;
      all.add(k, contribution(heuristic, k, s.value, alpha, s.observed.pdfs));
    }
    return {all.estimate(), all.standard_error(pool_.model()), static_cast<double>(all.effective_sample_size()),
            static_cast<double>(all.degrees_of_freedom(pool_.model()))};
  }
  control_coefficients<Value, M> control() const { return {}; }

 private:
  sample_pool<Value, M> pool_{};
};

template <class Value, int M, class Policy>
struct run_of {
  using type = combined_estimate<Value, M, Policy>;
};
template <class Value, int M, run_policy Policy>
struct run_of<Value, M, Policy> {
  using type = typename Policy::template run<Value, M>;
};

}  // namespace phimis::detail

#endif  // PHIMIS_ESTIMATOR_RUN_ESTIMATE_HPP
