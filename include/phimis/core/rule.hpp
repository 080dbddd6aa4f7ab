// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_RULE_HPP
#define PHIMIS_CORE_RULE_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/fractions.hpp>
#include <phimis/core/observation.hpp>

#include <cstdint>
#include <type_traits>

namespace phimis {

/// How the last update of a rule ended.
enum class rule_status : std::uint8_t {
  start,                ///< no update yet: the start fractions
  updated,              ///< new fractions
  local,                ///< new fractions at a local minimum of an objective that is not convex
  no_information,       ///< every f is 0, or a technique is silent: fractions as before
  infinite_divergence,  ///< a reversed divergence, infinite where f = 0 < p: fractions as before
  not_converged         ///< the solver's residual stayed above its tolerance: fractions are its best
};

/// What a rule met on its way; every observation is counted once in `observations`. In float, whose rules live by the
/// million in a renderer, each count is 32 bits wide.
template <class Real>
struct rule_counters {
  using count = std::conditional_t<sizeof(Real) == 4, std::uint32_t, std::int64_t>;
  count observations = 0;
  count zero = 0;       ///< f = 0: observations like any other
  count nonfinite = 0;  ///< refused: not finite, a negative pdf, or a density of 0
  count dropped = 0;    ///< refused: the table was full
  count left = 0;       ///< iterates that left [0, 1] before they were brought back

  PHIMIS_HOST_DEVICE void merge(const rule_counters& other) noexcept {
    observations += other.observations;
    zero += other.zero;
    nonfinite += other.nonfinite;
    dropped += other.dropped;
    left += other.left;
  }
};

/// The default floors: 2 % of the budget, shared equally.
template <class Real, int M>
PHIMIS_HOST_DEVICE constexpr per_technique<Real, M> defensive_floors() noexcept {
  per_technique<Real, M> floors{};
  for (int k = 0; k < M; ++k) floors[k] = Real(0.02) / Real(M);
  return floors;
}

/// The costs of techniques that all cost the same.
template <class Real, int M>
PHIMIS_HOST_DEVICE constexpr per_technique<Real, M> equal_costs() noexcept {
  per_technique<Real, M> costs{};
  for (int k = 0; k < M; ++k) costs[k] = 1;
  return costs;
}

/// Costs in units of the largest: only their ratios matter, whatever their unit. A cost of less than 1e-150 of it (float:
/// 1e-18) counts as that, so that neither its inverse nor the product of two is out of range.
template <class Real, int M>
PHIMIS_HOST_DEVICE per_technique<Real, M> relative_costs(const per_technique<Real, M>& costs) noexcept {
  Real largest = 0;
  for (const Real cost : costs) largest = cost > largest ? cost : largest;
  constexpr Real least = sizeof(Real) == 8 ? Real(1e-150) : Real(1e-18);
  per_technique<Real, M> relative{};
  for (int k = 0; k < M; ++k) relative[k] = costs[k] / largest > least ? costs[k] / largest : least;
  return relative;
}

/// What every rule takes: where to start, what to keep, how much to trust the start, what a sample costs.
///
/// Requires start on the simplex; floors_k >= 0, Σ floors <= 1, of frozen techniques the start in place of the floor;
///          prior >= 0; costs_k > 0. A start below a floor is raised to it. A rule that knows nothing of costs, or of
///          frozen techniques, says so.
template <class Real, int M>
struct rule_options {
  fractions<Real, M> start = equal_fractions<Real, M>();
  /// Defensive floors: constraints inside the optimisation. At 0 a technique may be given up for good, with what it alone
  /// can reach; estimates are unbiased only where every technique that is needed keeps a fraction.
  per_technique<Real, M> floors = defensive_floors<Real, M>();
  /// Weight of the start fractions π in units of samples: the objective is n D(g, p(α)) + prior · D(π, α). For the
  /// Kullback–Leibler divergence this is the Dirichlet prior of concentration prior · π.
  Real prior = 0;
  /// What a sample of each technique costs, in any unit: cost-aware rules minimise Σ c_k α_k times what they minimise.
  per_technique<Real, M> costs = equal_costs<Real, M>();
  /// Techniques whose fraction stays at the start, whatever their floor.
  per_technique<bool, M> frozen{};
};

/// Options in which a technique may be given up: for those who know that no technique alone reaches any part of f.
template <class Real, int M>
PHIMIS_HOST_DEVICE constexpr rule_options<Real, M> without_floors() noexcept {
  rule_options<Real, M> options;
  options.floors = per_technique<Real, M>{};
  return options;
}

/// Fractions in proportion to shares, none below its floor; those that are frozen stay at the start, whatever their floor.
///
/// Requires shares_k >= 0 and finite. Where every share is 0, the budget above the frozen ones is shared equally.
template <class Real, int M>
PHIMIS_HOST_DEVICE fractions<Real, M> share_budget(const per_technique<Real, M>& shares,
                                                   const rule_options<Real, M>& options) noexcept {
  per_technique<Real, M> free = shares;
  per_technique<Real, M> floors = options.floors;
  Real total = 0;
  Real left = 1;
  int movable = 0;
  for (int k = 0; k < M; ++k) {
    if (options.frozen[k]) {
      left -= options.start[k];
    } else {
      total += shares[k];
      ++movable;
    }
  }
  if (movable == M) return with_floors(shares, options.floors);
  if (movable == 0) return options.start;
  if (!(left > 0)) {
    // Frozen techniques have all, up to rounding: of floors that are rounding, too.
    for (int k = 0; k < M; ++k)
      free[k] = options.frozen[k] || options.start[k] > floors[k] ? options.start[k] : floors[k];
    return free;
  }
  // The same problem on what is left of the budget.
  for (int k = 0; k < M; ++k) {
    free[k] = options.frozen[k] ? Real(0) : total > 0 ? shares[k] : Real(1);
    floors[k] = options.frozen[k] ? Real(0) : options.floors[k] / left;
  }
  fractions<Real, M> alpha = with_floors(free, floors);
  for (int k = 0; k < M; ++k) alpha[k] = options.frozen[k] ? options.start[k] : alpha[k] * left;
  return alpha;
}

/// What a rule has learnt: all that changes. A host with many rules of the same options keeps one rule and many of these.
template <class Real, int M, class Memory>
struct rule_state {
  phimis::fractions<Real, M> fractions;
  rule_counters<Real> counters;
  rule_status status;
  Memory memory;  ///< of observations, as the rule keeps them
};

/// The memory of a rule that keeps nothing of observations.
struct no_memory {};

/// What every rule has: its options and its state.
///
///     rule.resume(pixels[i]);  …  rule.observe(sample);  rule.update();  …  pixels[i] = rule.state();
template <class Real, int M, class Memory = no_memory>
class rule_base {
 public:
  static constexpr int techniques = M;
  using real = Real;
  using state_type = rule_state<Real, M, Memory>;

  PHIMIS_HOST_DEVICE explicit rule_base(const rule_options<Real, M>& options) noexcept
      : options_(options), state_{share_budget(options.start, options), {}, rule_status::start, {}} {}

  /// What has been learnt so far, to be kept apart from the options.
  PHIMIS_HOST_DEVICE const state_type& state() const noexcept { return state_; }
  /// Goes on from a state that a rule of the same type and options gave.
  PHIMIS_HOST_DEVICE void resume(const state_type& state) { state_ = state; }

  PHIMIS_HOST_DEVICE const rule_options<Real, M>& options() const noexcept { return options_; }
  PHIMIS_HOST_DEVICE const phimis::fractions<Real, M>& fractions() const noexcept { return state_.fractions; }
  PHIMIS_HOST_DEVICE const rule_counters<Real>& counters() const noexcept { return state_.counters; }
  PHIMIS_HOST_DEVICE rule_status status() const noexcept { return state_.status; }

 protected:
  /// Counts an observation and writes its row; false where it is refused.
  PHIMIS_HOST_DEVICE bool admit(const observation<Real, M>& sample, row<Real, M>& out) noexcept {
    ++state_.counters.observations;
    if (!to_row(sample, out)) {
      ++state_.counters.nonfinite;
      return false;
    }
    if (!(out.u > 0)) ++state_.counters.zero;
    return true;
  }

  /// Ends an update.
  PHIMIS_HOST_DEVICE rule_status end(rule_status how) noexcept { return state_.status = how; }

  PHIMIS_HOST_DEVICE Memory& memory() noexcept { return state_.memory; }
  PHIMIS_HOST_DEVICE const Memory& memory() const noexcept { return state_.memory; }

  rule_options<Real, M> options_;
  state_type state_;
};

/// The rule that learns nothing: its fractions are the start, equal by default, whatever the floors.
template <class Real, int M>
class fixed_fractions : public rule_base<Real, M> {
 public:
  PHIMIS_HOST_DEVICE fixed_fractions() noexcept : fixed_fractions(rule_options<Real, M>{}) {}
  PHIMIS_HOST_DEVICE explicit fixed_fractions(const rule_options<Real, M>& options) noexcept
      : rule_base<Real, M>(options) {
    this->state_.fractions = options.start;
  }

  PHIMIS_HOST_DEVICE void observe(const observation<Real, M>& sample) noexcept {
    row<Real, M> ignored;
    this->admit(sample, ignored);
  }
  PHIMIS_HOST_DEVICE rule_status update() noexcept { return this->state_.status; }
  PHIMIS_HOST_DEVICE void merge(const fixed_fractions& other) noexcept {
    this->state_.counters.merge(other.state_.counters);
  }
};

}  // namespace phimis

#endif  // PHIMIS_CORE_RULE_HPP
