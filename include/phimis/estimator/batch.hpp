// SPDX-License-Identifier: MIT
#ifndef PHIMIS_ESTIMATOR_BATCH_HPP
#define PHIMIS_ESTIMATOR_BATCH_HPP

#include <phimis/concepts.hpp>
#include <phimis/core/counts.hpp>
#include <phimis/core/estimator.hpp>
#include <phimis/core/observation.hpp>

#include <cstdint>
#include <type_traits>

namespace phimis {

/// How fractions become counts where they are decided.
enum class rounding {
  largest_remainder,  ///< deterministic; every technique with a fraction gets a sample where the budget allows
  systematic          ///< at random with E[n_k] = Nα_k
};

/// How one batch is drawn.
struct batch_options {
  std::int64_t samples = 100;
  sampling_model model = sampling_model::multi_sample;
  phimis::rounding rounding = rounding::largest_remainder;
};

/// One batch: its counts, the fractions that its weights use, and its estimate.
template <class Value, int M>
struct batch {
  phimis::counts<M> counts{};
  phimis::fractions<double, M> fractions{};  ///< n_k/N where counts were decided, α_k where they were drawn
  sampling_model variance = sampling_model::multi_sample;  ///< which formula holds for the counts
  phimis::estimator<Value, M> estimator{};
};

/// One sample as the driver sees it: its observation for rules, its value for estimates.
template <class Value, int M>
struct drawn_sample {
  observation<double, M> observed;
  Value value;
  Value contribution;
};

/// Draws one batch at given fractions and hands every sample to the receiver. A pure function of its arguments and the
/// uniform numbers.
///
/// Largest remainder gives a technique no sample where the budget is smaller than the number of techniques; then, and
/// only then, it rounds systematically, which stays unbiased.
///
/// Source T Eqs. 6, 8.
template <class Integrand, class Techniques, int M, weight_heuristic Heuristic, uniform_source Next, class Receiver>
auto draw_batch(const Integrand& f, const Techniques& techniques, const fractions<double, M>& alpha,
                const batch_options& options, const Heuristic& heuristic, Next& next, Receiver&& receive) {
  using value = std::decay_t<decltype(f(techniques.sample(0, next)))>;
  batch<value, M> result;
  const auto one_sample = [&](int k) {
    const auto x = techniques.sample(k, next);
    drawn_sample<value, M> sample{{}, f(x), value_traits<value>::zero()};
    sample.observed.pdfs = techniques.pdfs(x);
    if constexpr (std::is_floating_point_v<value>) {
      sample.observed.f = static_cast<double>(sample.value);
    } else {
      sample.observed.f = static_cast<double>(value_traits<value>::magnitude(sample.value));
    }
    sample.observed.q = mixture(result.fractions, sample.observed.pdfs);
    sample.observed.technique = k;
    sample.contribution = contribution(heuristic, k, sample.value, result.fractions, sample.observed.pdfs);
    result.estimator.add(k, sample.contribution);
    receive(sample);
  };

  if (options.model == sampling_model::one_sample) {
    result.fractions = alpha;
    result.variance = sampling_model::one_sample;
    for (std::int64_t j = 0; j < options.samples; ++j) {
      const int k = pick_technique(alpha, static_cast<double>(next()));
      ++result.counts[k];
      one_sample(k);
    }
    return result;
  }
  int needed = 0;
  for (const double a : alpha) needed += a > 0 ? 1 : 0;
  if (options.rounding == rounding::systematic || options.samples < needed) {
    result.counts = split_systematic(alpha, options.samples, static_cast<double>(next()));
    result.fractions = alpha;
    result.variance = sampling_model::one_sample;  // close where N is large against M; the true one is hard to know
  } else {
    result.counts = split_largest_remainder(alpha, options.samples);
    for (int k = 0; k < M; ++k) {
      result.fractions[k] = static_cast<double>(result.counts[k]) / static_cast<double>(options.samples);
    }
  }
  for (int k = 0; k < M; ++k) {
    for (std::int64_t j = 0; j < result.counts[k]; ++j) one_sample(k);
  }
  return result;
}

}  // namespace phimis

#endif  // PHIMIS_ESTIMATOR_BATCH_HPP
