// SPDX-License-Identifier: MIT
#ifndef PHIMIS_ESTIMATOR_COMBINATION_HPP
#define PHIMIS_ESTIMATOR_COMBINATION_HPP

#include <phimis/error.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace phimis {

/// What a combination may know of one iteration.
struct iteration_summary {
  std::int64_t samples;
  double variance;  ///< of the iteration's estimate, by magnitude
  bool all_zero;    ///< every contribution was 0: its variance is unknown, not 0
};

/// How iterations become one estimate: F = Σ_b weight_b F_b / Σ_b weight_b.
///
/// Writes one weight for each iteration; only their ratios matter. Not all are 0.
template <class T>
concept combination = requires(const T& c, std::span<const iteration_summary> iterations, std::span<double> weights) {
  c(iterations, weights);
};

/// Every sample counts the same. Unbiased.
struct by_count {
  void operator()(std::span<const iteration_summary> iterations, std::span<double> weights) const {
    for (std::size_t b = 0; b < iterations.size(); ++b) weights[b] = static_cast<double>(iterations[b].samples);
  }
};

/// A sample of iteration b counts √b: later iterations, better adapted, count more. Unbiased, since the weights do not
/// look at the data.
///
/// Source Owen & Zhou 2020, "The square root rule for adaptive importance sampling".
struct square_root {
  void operator()(std::span<const iteration_summary> iterations, std::span<double> weights) const {
    for (std::size_t b = 0; b < iterations.size(); ++b) {
      weights[b] = static_cast<double>(iterations[b].samples) * std::sqrt(static_cast<double>(b + 1));
    }
  }
};

/// A sample of iteration b counts what was given for b; the last number holds for all later ones. Unbiased.
///
/// Errors std::invalid_argument where no weight is given, one is negative, or the last is 0.
class fixed_weights {
 public:
  explicit fixed_weights(std::vector<double> per_sample) : per_sample_(std::move(per_sample)) {
    require(!per_sample_.empty(), "fixed_weights", "must hold at least one weight", per_sample_.size());
    for (const double w : per_sample_) {
      require(w >= 0 && std::isfinite(w), "fixed_weights", "must be finite and not negative", w);
    }
    require(per_sample_.back() > 0, "fixed_weights", "must end with a weight greater than 0", per_sample_.back());
  }
  void operator()(std::span<const iteration_summary> iterations, std::span<double> weights) const {
    // A run that was stopped early may have met no positive weight: then all samples count.
    const bool any = iterations.size() >= per_sample_.size() ||
                     std::any_of(per_sample_.begin(), per_sample_.begin() + static_cast<std::ptrdiff_t>(iterations.size()),
                                 [](double w) { return w > 0; });
    for (std::size_t b = 0; b < iterations.size(); ++b) {
      const double each = any ? per_sample_[std::min(b, per_sample_.size() - 1)] : 1;
      weights[b] = static_cast<double>(iterations[b].samples) * each;
    }
  }

 private:
  std::vector<double> per_sample_;
};

/// Weights 1/variance, estimated from the same samples. **Biased**: an iteration that missed a peak has a small
/// estimate and a small variance, so low estimates weigh more.
///
/// An iteration whose contributions are all 0 gets the largest variance that was seen; iterations without variance
/// share all the weight where there are any.
struct inverse_variance {
  void operator()(std::span<const iteration_summary> iterations, std::span<double> weights) const {
    double largest = 0;
    bool exact = false;
    for (const iteration_summary& it : iterations) {
      largest = std::max(largest, it.variance);
      exact = exact || (it.variance == 0 && !it.all_zero && it.samples > 1);
    }
    for (std::size_t b = 0; b < iterations.size(); ++b) {
      const iteration_summary& it = iterations[b];
      const bool known = !it.all_zero && it.samples > 1;
      if (exact || largest == 0) {
        weights[b] = !exact || (known && it.variance == 0) ? static_cast<double>(it.samples) : 0;
      } else {
        weights[b] = largest / (known ? it.variance : largest);
      }
    }
  }
};

/// All samples as one batch of the aggregate mixture of all iterations: F = (1/n) Σ f/p(ᾱ), ᾱ = Σ_b n_b α_b / n.
///
/// **Consistent, not unbiased**: the fractions of later iterations depend on earlier samples. Needs every sample
/// in memory, and a pass over all of them after each iteration.
struct pooled {};

}  // namespace phimis

#endif  // PHIMIS_ESTIMATOR_COMBINATION_HPP
