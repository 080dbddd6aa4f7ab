// SPDX-License-Identifier: MIT
#ifndef PHIMIS_SOLVER_RULES_HPP
#define PHIMIS_SOLVER_RULES_HPP

#include <phimis/concepts.hpp>
#include <phimis/core/exact_minimiser.hpp>
#include <phimis/core/newton_raphson.hpp>
#include <phimis/core/rule.hpp>
#include <phimis/solver/table.hpp>
#include <phimis/validate.hpp>

namespace phimis {

/// Equal counts, or any fractions that stay as they are.
///
/// Errors std::invalid_argument where options are out of range, here and below.
template <int M, class Real = double>
fixed_fractions<Real, M> fixed_rule(const rule_options<Real, M>& options = {}) {
  validate(options);
  return fixed_fractions<Real, M>(options);
}

/// The paper's Newton–Raphson rule, or its safeguarded form.
template <divergence Divergence, class Real = double>
newton_raphson<Divergence, Real> newton_rule(const Divergence& divergence,
                                             newton_form form = newton_form::safeguarded,
                                             const rule_options<Real, 2>& options = {}) {
  validate(divergence);
  validate(options);
  return newton_raphson<Divergence, Real>(divergence, form, options);
}

/// The exact minimiser on all observations, in a table that grows.
///
///     auto rule = phimis::exact_rule(phimis::tsallis{0.5}, {.floors = {0.05, 0.05}, .prior = 8});
template <divergence Divergence, class Real = double>
exact_minimiser<Divergence, table<Real, 2>> exact_rule(const Divergence& divergence,
                                                       const rule_options<Real, 2>& options = {},
                                                       control_variate variate = control_variate::on) {
  validate(divergence);
  validate(options);
  return exact_minimiser<Divergence, table<Real, 2>>(divergence, options, variate);
}

}  // namespace phimis

#endif  // PHIMIS_SOLVER_RULES_HPP
