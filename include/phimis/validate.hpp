// SPDX-License-Identifier: MIT
#ifndef PHIMIS_VALIDATE_HPP
#define PHIMIS_VALIDATE_HPP

#include <phimis/core/divergence.hpp>
#include <phimis/core/finite.hpp>
#include <phimis/core/rule.hpp>
#include <phimis/core/weight_heuristic.hpp>
#include <phimis/error.hpp>

#include <cstddef>
#include <limits>
#include <span>
#include <type_traits>

// Core cannot throw. What is built from its values above core is checked here first: each overload throws
// std::invalid_argument that names the parameter, the rule and the value.

namespace phimis {

/// A divergence without parameters is always right.
template <class Divergence>
void validate(const Divergence&) {}

inline void validate(const tsallis& divergence) {
  require(divergence.gamma > 0 && is_finite(divergence.gamma), "gamma", "must be finite and greater than 0",
          divergence.gamma);
}

inline void validate(const pearson_vajda& divergence) {
  require(divergence.k >= 1 && is_finite(divergence.k), "k", "must be finite and at least 1", divergence.k);
}

template <class Divergence>
void validate(const reversed<Divergence>& divergence) {
  validate(divergence.forward);
}

inline void validate(const power& heuristic) {
  require(heuristic.beta >= 0 && is_finite(heuristic.beta), "beta", "must be finite and not negative",
          heuristic.beta);
}

inline void validate(const cutoff& heuristic) {
  require(heuristic.threshold >= 0 && heuristic.threshold <= 1, "threshold", "must lie in [0, 1]",
          heuristic.threshold);
}

template <class Heuristic>
void validate(const count_independent<Heuristic>& heuristic) {
  validate(heuristic.inner);
}

/// Start, floors, costs and frozen techniques, of as many techniques as they have entries.
template <class Real>
void validate(std::span<const Real> start, std::span<const Real> floors, std::span<const Real> costs,
              std::span<const bool> frozen, Real prior) {
  // What fractions may be off by; sums that are rounded themselves would let a little more pass.
  const long double rounding = 4.0L * static_cast<long double>(start.size()) * std::numeric_limits<Real>::epsilon();
  long double least = 0;
  long double bound = 0;
  long double all = 0;
  for (std::size_t k = 0; k < start.size(); ++k) {
    require(is_density(floors[k]), "floors", "must be finite and not negative", floors[k]);
    require(is_density(start[k]), "start", "must be finite and not negative", start[k]);
    require(is_density(costs[k]) && costs[k] > 0, "costs", "must be finite and greater than 0", costs[k]);
    least += floors[k];
    bound += frozen[k] ? start[k] : floors[k];
    all += start[k];
  }
  require(least <= 1 + rounding, "floors", "must sum to at most 1", static_cast<Real>(least));
  require(all >= 1 - rounding && all <= 1 + rounding, "start", "must sum to 1", static_cast<Real>(all));
  require(bound <= 1 + rounding, "floors", "must leave room for the frozen techniques",
          static_cast<Real>(bound));
  require(is_density(prior), "prior", "must be finite and not negative", prior);
}

template <class Real, int M>
void validate(const rule_options<Real, M>& options) {
  validate<Real>(options.start.value, options.floors.value, options.costs.value, options.frozen.value,
                 options.prior);
}

/// Options of a rule that knows nothing of costs.
template <class Real, int M>
void validate_equal_costs(const rule_options<Real, M>& options) {
  for (int k = 0; k < M; ++k) {
    require(options.costs[k] == options.costs[0], "costs", "must be equal for a rule that knows nothing of costs",
            options.costs[k]);
  }
}

/// Options of a rule that knows nothing of costs and moves all techniques.
template <class Real, int M>
void validate_plain(const rule_options<Real, M>& options) {
  validate_equal_costs(options);
  for (int k = 0; k < M; ++k) {
    require(!options.frozen[k], "frozen", "must be empty for a rule that moves all techniques; it has technique", k);
  }
}

/// Costs that are not all the same need an objective that a cost multiplies: a positive power of f/p, or a variance.
template <class Real, class Divergence>
void validate_costs(const Divergence& divergence, std::span<const Real> costs) {
  for (const Real cost : costs) {
    if constexpr (has_exponent<Divergence>::value) {
      require(cost == costs[0] || divergence.exponent() > 0, "costs",
              "must be equal for a divergence whose score is no positive power of f/p", cost);
    } else if constexpr (!std::is_same_v<Divergence, multi_sample_variance>) {
      require(cost == costs[0], "costs", "must be equal for a divergence whose score is no power of f/p", cost);
    }
  }
}

}  // namespace phimis

#endif  // PHIMIS_VALIDATE_HPP
