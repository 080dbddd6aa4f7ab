// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_HPP
#define PHIMIS_CORE_HPP

// All of phimis::core: C++17, the standard library only, no heap, no exceptions, host and device.
#include <phimis/core/config.hpp>
#include <phimis/core/counts.hpp>
#include <phimis/core/divergence.hpp>
#include <phimis/core/divergence_at.hpp>
#include <phimis/core/estimator.hpp>
#include <phimis/core/exact_minimiser.hpp>
#include <phimis/core/finite.hpp>
#include <phimis/core/fractions.hpp>
#include <phimis/core/inverse_variance_fractions.hpp>
#include <phimis/core/kink.hpp>
#include <phimis/core/limits.hpp>
#include <phimis/core/linear_equations.hpp>
#include <phimis/core/linear_heuristic.hpp>
#include <phimis/core/moments.hpp>
#include <phimis/core/movable_techniques.hpp>
#include <phimis/core/newton_raphson.hpp>
#include <phimis/core/observation.hpp>
#include <phimis/core/pack.hpp>
#include <phimis/core/pair_sums.hpp>
#include <phimis/core/projection_sums.hpp>
#include <phimis/core/quadratic_on_simplex.hpp>
#include <phimis/core/rule.hpp>
#include <phimis/core/second_order.hpp>
#include <phimis/core/sigma_proportional.hpp>
#include <phimis/core/solve_dense.hpp>
#include <phimis/core/solve_nonnegative.hpp>
#include <phimis/core/solve_pair.hpp>
#include <phimis/core/streaming_newton.hpp>
#include <phimis/core/table.hpp>
#include <phimis/core/technique_moments.hpp>
#include <phimis/core/technique_sums.hpp>
#include <phimis/core/uniform.hpp>
#include <phimis/core/value.hpp>
#include <phimis/core/version.hpp>
#include <phimis/core/weight_heuristic.hpp>

#endif  // PHIMIS_CORE_HPP
