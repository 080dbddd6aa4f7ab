// SPDX-License-Identifier: MIT
#ifndef PHIMIS_VALIDATE_HPP
#define PHIMIS_VALIDATE_HPP

#include <phimis/core/divergence.hpp>
#include <phimis/core/finite.hpp>
#include <phimis/core/rule.hpp>
#include <phimis/core/weight_heuristic.hpp>
#include <phimis/error.hpp>

#include <limits>

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

template <class Real, int M>
void validate(const rule_options<Real, M>& options) {
  constexpr Real rounding = 8 * M * std::numeric_limits<Real>::epsilon();
  Real floors = 0;
  Real start = 0;
  for (int k = 0; k < M; ++k) {
    require(is_density(options.floors[k]), "floors", "must be finite and not negative", options.floors[k]);
    require(is_density(options.start[k]), "start", "must be finite and not negative", options.start[k]);
    require(is_density(options.costs[k]) && options.costs[k] > 0, "costs", "must be finite and greater than 0",
            options.costs[k]);
    floors += options.floors[k];
    start += options.start[k];
  }
  require(floors <= 1 + rounding, "floors", "must sum to at most 1", floors);
  require(start >= 1 - rounding && start <= 1 + rounding, "start", "must sum to 1", start);
  require(is_density(options.prior), "prior", "must be finite and not negative", options.prior);
}

}  // namespace phimis

#endif  // PHIMIS_VALIDATE_HPP
