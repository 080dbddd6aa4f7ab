// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_INVERSE_VARIANCE_FRACTIONS_HPP
#define PHIMIS_CORE_INVERSE_VARIANCE_FRACTIONS_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/finite.hpp>
#include <phimis/core/rule.hpp>
#include <phimis/core/technique_moments.hpp>

namespace phimis {

/// Fractions inverse to the variance that each technique has alone, and to its cost: a heuristic.
///
///     G_i = f(X_ij) / p_i(X_ij),   α_i ∝ 1 / (c_i V[G_i])
///
/// V[G_i] from the samples of technique i. Nothing is minimised: what the techniques have in common is not seen.
///
/// Source   Havran & Sbert 2014, as told by V Sec. 1 and App. A.
/// Requires `observation::technique`.
/// Errors   no_information, and fractions as before, where every f is 0 or no V[G_i] is known.
/// Cost     O(1) memory and time; an update, M² at most.
/// - A technique of unknown variance gets no share but its floor: with fewer than two samples, with nothing but zeros, or
///   where V[G_i] is infinite against the least. Techniques without variance share all, by 1/c_i.
/// - The prior, of which the source knows nothing, is a mean: (n · learnt + prior · start) / (n + prior).
template <class Real, int M>
class inverse_variance_fractions : public rule_base<Real, M, technique_moments<Real, M>> {
 public:
  PHIMIS_HOST_DEVICE inverse_variance_fractions() noexcept : inverse_variance_fractions(rule_options<Real, M>{}) {}
  PHIMIS_HOST_DEVICE explicit inverse_variance_fractions(const rule_options<Real, M>& options) noexcept
      : rule_base<Real, M, technique_moments<Real, M>>(options) {}

  PHIMIS_HOST_DEVICE void observe(const observation<Real, M>& sample) noexcept {
    const int i = sample.technique;
    PHIMIS_EXPECTS(i >= 0 && i < M);
    row<Real, M> row;
    if (!this->admit(sample, row)) return;
    Real value = row.u > 0 ? row.u / row.y[i] : Real(0);
    if (!is_finite(value)) {  // p_i = 0 at its own sample
      ++this->state_.counters.nonfinite;
      return;
    }
    if (sample.f < 0) value = -value;
    this->memory().add(i, value);
  }

  PHIMIS_HOST_DEVICE rule_status update() noexcept {
    const auto& options = this->options_;
    bool exact = false;
    Real least = 0;  // σ, of those that are not 0
    for (int k = 0; k < M; ++k) {
      if (!known(k)) continue;
      const Real sigma = this->memory().deviation(k);
      if (!(sigma > 0)) exact = true;
      if (sigma > 0 && (!(least > 0) || sigma < least)) least = sigma;
    }
    if (!exact && !(least > 0)) return this->end(rule_status::no_information);
    const per_technique<Real, M> costs = relative_costs(options.costs);
    per_technique<Real, M> shares{};
    Real total = 0;
    for (int k = 0; k < M; ++k) {
      const Real sigma = known(k) ? this->memory().deviation(k) : Real(-1);
      const Real ratio = sigma > 0 ? least / sigma : Real(0);
      shares[k] = (exact ? Real(sigma == 0 ? 1 : 0) : ratio * ratio) / costs[k];
      total += shares[k];
    }
    const Real n = static_cast<Real>(this->memory().count());
    for (int k = 0; k < M; ++k) {
      shares[k] = (n * (shares[k] / total) + options.prior * options.start[k]) / (n + options.prior);
    }
    this->state_.fractions = share_budget(shares, options);
    return this->end(rule_status::updated);
  }

  /// Adds what another state has observed.
  PHIMIS_HOST_DEVICE void merge(const inverse_variance_fractions& other) noexcept {
    this->state_.counters.merge(other.state_.counters);
    this->memory().merge(other.memory());
  }

 private:
  PHIMIS_HOST_DEVICE bool known(int k) const noexcept { return this->memory().known(k) && this->memory().any(k); }
};

}  // namespace phimis

#endif  // PHIMIS_CORE_INVERSE_VARIANCE_FRACTIONS_HPP
