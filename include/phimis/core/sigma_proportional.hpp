// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_SIGMA_PROPORTIONAL_HPP
#define PHIMIS_CORE_SIGMA_PROPORTIONAL_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/finite.hpp>
#include <phimis/core/rule.hpp>
#include <phimis/core/technique_moments.hpp>
#include <phimis/core/weight_heuristic.hpp>

#include <cmath>

namespace phimis {

/// Counts in proportion to the spread of each technique's own contributions: optimal for `count_independent` weights.
///
///     F_ij = w_i(X_ij) f(X_ij) / p_i(X_ij)              f / Σ_k p_k for the balance heuristic
///     σ_i² = V[F_ij], from the samples of technique i
///     α_i ∝ σ_i / √c_i,   then V[F] = (Σ σ_i)² and cost × V[F] = (Σ σ_i √c_i)², the least that there is
///
/// F_ij does not depend on the counts, so every sample ever made is used, however it was allotted.
///
/// Source   V Eqs. 11, 14, 27, 28, 31, Theorems 2 and 3.
/// Requires `observation::technique`; estimates by count_independent weights of the same heuristic.
/// Errors   no_information, and fractions as before: while every f is 0; while a technique that has a fraction has fewer
///          than two samples; where every σ_i is 0, for then no fractions are better than others.
/// Cost     O(1) memory and time; an update, M² at most.
/// - Floors leave the rest of the budget in the same proportion: the least V[F] under them; with unequal costs and a floor
///   that binds, close to the least cost × V[F].
/// - The prior is in the objective, n V[F]/(Σσ_i)² + prior · Σ π_i²/α_i: each σ_i² is a mean of n samples' and of the one
///   that would ask for the start.
template <class Real, int M, class Heuristic = balance>
class sigma_proportional : public rule_base<Real, M, technique_moments<Real, M>> {
 public:
  PHIMIS_HOST_DEVICE sigma_proportional() noexcept : sigma_proportional(rule_options<Real, M>{}) {}
  PHIMIS_HOST_DEVICE explicit sigma_proportional(const rule_options<Real, M>& options,
                                                 const Heuristic& heuristic = {}) noexcept
      : rule_base<Real, M, technique_moments<Real, M>>(options), heuristic_(heuristic) {}

  PHIMIS_HOST_DEVICE const Heuristic& heuristic() const noexcept { return heuristic_; }

  PHIMIS_HOST_DEVICE void observe(const observation<Real, M>& sample) noexcept {
    const int i = sample.technique;
    PHIMIS_EXPECTS(i >= 0 && i < M);
    row<Real, M> row;
    if (!this->admit(sample, row)) return;
    Real value = 0;
    if (row.u > 0) {
      per_technique<Real, M> shares{};
      for (int k = 0; k < M; ++k) shares[k] = row.y[k];
      value = scaled(heuristic_, i, row.u, shares);
      if (!is_finite(value)) {  // p_i = 0 at its own sample
        ++this->state_.counters.nonfinite;
        return;
      }
      if (sample.f < 0) value = -value;
    }
    this->memory().add(i, value);
  }

  PHIMIS_HOST_DEVICE rule_status update() noexcept {
    const auto& options = this->options_;
    if (!this->memory().any()) return this->end(rule_status::no_information);
    const per_technique<Real, M> costs = relative_costs(options.costs);
    Real total = 0;     // S = Σ σ_k √c_k
    Real expected = 0;  // Σ π_k c_k
    per_technique<Real, M> sigma{};
    per_technique<Real, M> root{};
    for (int k = 0; k < M; ++k) {
      if (!this->memory().known(k) && this->state_.fractions[k] > 0) return this->end(rule_status::no_information);
      sigma[k] = this->memory().deviation(k);
      root[k] = std::sqrt(costs[k]);
      total += sigma[k] * root[k];
      expected += options.start[k] * costs[k];
    }
    if (!(total > 0)) return this->end(rule_status::no_information);
    per_technique<Real, M> shares{};
    const Real prior = options.prior / static_cast<Real>(this->memory().count());
    for (int k = 0; k < M; ++k) {
      const Real learnt = sigma[k] / total;
      const Real given = options.start[k] * root[k] / expected;
      shares[k] = (prior > 0 ? std::hypot(learnt, std::sqrt(prior) * given) : learnt) / root[k];
    }
    this->state_.fractions = share_budget(shares, options);
    return this->end(rule_status::updated);
  }

  /// Adds what another state has observed.
  PHIMIS_HOST_DEVICE void merge(const sigma_proportional& other) noexcept {
    this->state_.counters.merge(other.state_.counters);
    this->memory().merge(other.memory());
  }

 private:
  /// w_i f / p_i with f = u and p_k = y_k.
  template <class Weights>
  PHIMIS_HOST_DEVICE static Real scaled(const Weights& weights, int i, Real u,
                                        const per_technique<Real, M>& y) noexcept {
    return u * (weights(i, equal_fractions<Real, M>(), y) / y[i]);
  }
  PHIMIS_HOST_DEVICE static Real scaled(const balance&, int, Real u, const per_technique<Real, M>&) noexcept {
    return u;
  }

  Heuristic heuristic_;
};

}  // namespace phimis

#endif  // PHIMIS_CORE_SIGMA_PROPORTIONAL_HPP
