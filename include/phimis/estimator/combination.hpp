// SPDX-License-Identifier: MIT
#ifndef PHIMIS_ESTIMATOR_COMBINATION_HPP
#define PHIMIS_ESTIMATOR_COMBINATION_HPP

#include <phimis/core/finite.hpp>
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

namespace detail {
template <class Value, int M>
class pooled_estimate;  // in run_estimate.hpp
}  // namespace detail

/// What a combination may know of one iteration.
struct iteration_summary {
  std::int64_t samples;
  double standard_error;  ///< of the iteration's estimate, by magnitude
  bool all_zero;          ///< every contribution was 0: its standard error is unknown, not 0
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
      require(w >= 0 && is_finite(w), "fixed_weights", "must be finite and not negative", w);
    }
    require(per_sample_.back() > 0, "fixed_weights", "must end with a weight greater than 0", per_sample_.back());
  }
  void operator()(std::span<const iteration_summary> iterations, std::span<double> weights) const {
    // A run that was stopped early may have met no positive weight: then all samples count.
    const bool any =
        iterations.size() >= per_sample_.size() ||
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
/// share all the weight where there are any. What is not finite counts as all 0.
struct inverse_variance {
  void operator()(std::span<const iteration_summary> iterations, std::span<double> weights) const {
    const auto known = [](const iteration_summary& it) {
      return !it.all_zero && it.samples > 1 && is_finite(it.standard_error);
    };
    double largest = 0;
    bool exact = false;
    for (const iteration_summary& it : iterations) {
      if (!known(it)) continue;
      largest = std::max(largest, it.standard_error);
      exact = exact || it.standard_error == 0;
    }
    for (std::size_t b = 0; b < iterations.size(); ++b) {
      const iteration_summary& it = iterations[b];
      if (exact || largest == 0) {
        weights[b] = !exact || (known(it) && it.standard_error == 0) ? static_cast<double>(it.samples) : 0;
      } else {
        const double ratio = known(it) ? largest / it.standard_error : 1;
        weights[b] = ratio * ratio;
      }
    }
  }
};

/// All samples as one batch of the aggregate mixture of all iterations: F = (1/n) Σ f/p(ᾱ), ᾱ = Σ_b n_b α_b / n.
///
/// **Consistent, not unbiased**: the fractions of later iterations depend on earlier samples. Needs every sample
/// in memory, and a pass over all of them after each iteration.
struct pooled {
  template <class Value, int M>
  using run = detail::pooled_estimate<Value, M>;
};

}  // namespace phimis

#endif  // PHIMIS_ESTIMATOR_COMBINATION_HPP
