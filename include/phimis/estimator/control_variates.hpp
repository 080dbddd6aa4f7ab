// SPDX-License-Identifier: MIT
#ifndef PHIMIS_ESTIMATOR_CONTROL_VARIATES_HPP
#define PHIMIS_ESTIMATOR_CONTROL_VARIATES_HPP

#include <phimis/core/estimator.hpp>
#include <phimis/core/fractions.hpp>
#include <phimis/core/weight_heuristic.hpp>
#include <phimis/estimator/batch.hpp>
#include <phimis/estimator/combination.hpp>
#include <phimis/estimator/control_coefficients.hpp>
#include <phimis/estimator/control_fit.hpp>
#include <phimis/estimator/run_estimate.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

namespace phimis {

namespace detail {
template <class Value, int M>
class pooled_controlled_estimate;
template <class Value, int M, class Policy>
class controlled_estimate;
}  // namespace detail

/// All samples as one batch of the aggregate mixture, with the pdfs as control variates, fitted to the same samples.
///
///     F = Σ_k β_k + (1/n) Σ_j (f_j − Σ_k β_k p_kj)/p(ᾱ, x_j),   β the regression of f/p(ᾱ) on p_k/p(ᾱ)
///
/// At fractions that stay, and without shrinkage, this is the direct estimator of Optimal MIS. **Consistent, not unbiased**,
/// of order 1/n: docs/policies.md has figures. Goes with the balance heuristic. Requires pdfs that integrate to one; off, and
/// `pooled`, with fewer than 4M samples and after a lost sample.
///
/// Source   Owen & Zhou 2000; Kondapaneni et al. 2019.
struct pooled_control_variates {
  template <class Value, int M>
  using run = detail::pooled_controlled_estimate<Value, M>;
  shrinkage shrink = shrinkage::on;  ///< off: less error where pdfs are close, ruin where no sample met what sets them apart
};

/// Every iteration with the pdfs as control variates, fitted to the samples of earlier iterations: the progressive
/// estimator of Optimal MIS, for fractions that are learnt. The first iteration has none. Unbiased.
///
/// Goes with the balance heuristic. Requires pdfs that integrate to one; off while there are fewer than 4M earlier samples
/// and after a lost sample. Each iteration reads all earlier samples.
///
/// Source   Kondapaneni et al. 2019; He & Owen 2014, with `joint_rule`.
template <combination Combination = square_root>
struct progressive_control_variates {
  template <class Value, int M>
  using run = detail::controlled_estimate<Value, M, progressive_control_variates>;
  static constexpr bool halves = false;  // whether an iteration is split
  Combination combination{};             ///< of the iterations
};

/// The same, without a first iteration that has none: it is split, and each half has the control variates of the other.
/// Unbiased, from the first iteration on.
///
/// Each half is a batch of its own, with its own density. An iteration is split while there are fewer earlier samples than
/// its own; not below 8M samples, and not where a technique has a single one.
///
/// Source   ours; cross-fitting as in statistics, with the density that makes it exact for decided counts.
template <combination Combination = square_root>
struct cross_fitted_control_variates {
  template <class Value, int M>
  using run = detail::controlled_estimate<Value, M, cross_fitted_control_variates>;
  static constexpr bool halves = true;
  Combination combination{};
};

template <class Combination>
progressive_control_variates(Combination) -> progressive_control_variates<Combination>;
template <class Combination>
cross_fitted_control_variates(Combination) -> cross_fitted_control_variates<Combination>;

namespace detail {

/// Adds a sample of a batch that was drawn at α.
template <class Value, int M>
void add_controlled(estimator<Value, M>& to, const drawn_sample<Value, M>& s,
                    const control_coefficients<Value, M>& control, const fractions<double, M>& alpha) {
  to.add(s.observed.technique,
         controlled_contribution(control, s.value, s.observed.pdfs, mixture(alpha, s.observed.pdfs)));
}

template <class Heuristic>
constexpr void balance_only() {
  static_assert(std::is_same_v<Heuristic, balance>, "control variates go with the balance heuristic");
}

/// All samples as one batch of the aggregate mixture, with control variates that were fitted to them.
template <class Value, int M>
class pooled_controlled_estimate {
 public:
  pooled_controlled_estimate(const pooled_control_variates& policy, sampling_model) : shrink_(policy.shrink) {}

  void add(const drawn_sample<Value, M>& sample) { pool_.add(sample); }
  estimator<Value, M> close(const batch<Value, M>& drawn) {
    pool_.close_batch(drawn);
    return drawn.estimator;
  }
  template <class Heuristic, class Line>
  combined<Value> total(const Heuristic&, const std::vector<Line>&, const Value&) {
    balance_only<Heuristic>();
    const fractions<double, M> alpha = pool_.aggregate();
    control_fit<Value, M> fit(alpha);
    for (const auto& s : pool_.all()) fit.add(s.value, s.observed.pdfs, mixture(alpha, s.observed.pdfs));
    control_ = fit.solve(shrink_);
    estimator<Value, M> all;
    for (const auto& s : pool_.all()) add_controlled(all, s, control_, alpha);
    return {all.estimate(), fitted_standard_error(all, pool_.model(), control_.rank),
            static_cast<double>(all.effective_sample_size()),
            fitted_degrees_of_freedom(all, pool_.model(), control_.rank)};
  }
  const control_coefficients<Value, M>& control() const { return control_; }

 private:
  shrinkage shrink_;
  sample_pool<Value, M> pool_{};
  control_coefficients<Value, M> control_{};
};

/// Iterations whose own estimates have control variates, fitted to samples that they do not serve.
template <class Value, int M, class Policy>
class controlled_estimate {
 public:
  controlled_estimate(const Policy& policy, sampling_model model) : policy_(policy), model_(model) {}

  void add(const drawn_sample<Value, M>& sample) { pool_.add(sample); }

  estimator<Value, M> close(const batch<Value, M>& drawn) {
    control_fit<Value, M> past(drawn.fractions);
    for (const auto& s : pool_.earlier()) past.add(s.value, s.observed.pdfs, s.observed.q);
    estimator<Value, M> own;
    if (Policy::halves && can_split(drawn)) {
      const halves of = split(drawn);
      control_fit<Value, M> fit[2] = {past, past};  // each for the other half
      for (std::size_t j = 0; j < of.half.size(); ++j) {
        const auto& s = pool_.batch()[j];
        fit[1 - of.half[j]].add(s.value, s.observed.pdfs, mixture(of.alpha[of.half[j]], s.observed.pdfs));
      }
      const control_coefficients<Value, M> control[2] = {fit[0].solve(), fit[1].solve()};
      for (std::size_t j = 0; j < of.half.size(); ++j) {
        add_controlled(own, pool_.batch()[j], control[of.half[j]], of.alpha[of.half[j]]);
      }
      control_ = control[0];
    } else {
      control_ = past.solve();
      for (const auto& s : pool_.batch()) add_controlled(own, s, control_, drawn.fractions);
    }
    pool_.close_batch(drawn);
    return own;
  }
  template <class Heuristic, class Line>
  combined<Value> total(const Heuristic&, const std::vector<Line>& trace, const Value& spread) const {
    balance_only<Heuristic>();
    return combine(policy_.combination, trace, spread);
  }
  const control_coefficients<Value, M>& control() const { return control_; }

 private:
  /// Which half each sample of a batch belongs to, and the fractions of each half.
  struct halves {
    std::vector<int> half;
    fractions<double, M> alpha[2];
  };

  /// Each half must be a batch of its own: where counts were decided, with at least one sample of each technique.
  bool can_split(const batch<Value, M>& drawn) const {
    const std::size_t own = pool_.batch().size();
    if (pool_.earlier().size() >= own || own < 2 * control_fit<Value, M>::least) return false;
    if (model_ == sampling_model::one_sample) return true;
    if (drawn.variance != sampling_model::multi_sample) return false;
    return std::none_of(drawn.counts.begin(), drawn.counts.end(), [](std::int64_t n) { return n == 1; });
  }

  halves split(const batch<Value, M>& drawn) const {
    halves result{{}, {drawn.fractions, drawn.fractions}};
    per_technique<std::int64_t, M> counts[2]{};
    int next = 0;
    for (const auto& s : pool_.batch()) {
      // Samples of a technique follow each other: in turns, each half gets half of every technique's.
      const int half = next;
      next = 1 - next;
      result.half.push_back(half);
      ++counts[half][s.observed.technique];
    }
    if (model_ == sampling_model::one_sample) return result;
    for (int h = 0; h < 2; ++h) {
      double n = 0;
      for (const std::int64_t count : counts[h]) n += static_cast<double>(count);
      for (int k = 0; k < M; ++k) result.alpha[h][k] = static_cast<double>(counts[h][k]) / n;
    }
    return result;
  }

  Policy policy_;
  sampling_model model_;
  sample_pool<Value, M> pool_{};
  control_coefficients<Value, M> control_{};
};

}  // namespace detail

}  // namespace phimis

#endif  // PHIMIS_ESTIMATOR_CONTROL_VARIATES_HPP
