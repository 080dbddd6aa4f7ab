// SPDX-License-Identifier: MIT
#ifndef PHIMIS_SOLVER_RULES_HPP
#define PHIMIS_SOLVER_RULES_HPP

#include <phimis/concepts.hpp>
#include <phimis/core/exact_minimiser.hpp>
#include <phimis/core/finite.hpp>
#include <phimis/core/inverse_variance_fractions.hpp>
#include <phimis/core/linear_heuristic.hpp>
#include <phimis/core/newton_raphson.hpp>
#include <phimis/core/rule.hpp>
#include <phimis/core/second_order.hpp>
#include <phimis/core/sigma_proportional.hpp>
#include <phimis/core/streaming_newton.hpp>
#include <phimis/solver/table.hpp>
#include <phimis/validate.hpp>

#include <type_traits>

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
  validate_plain(options);
  return newton_raphson<Divergence, Real>(divergence, form, options);
}

/// The exact minimiser on all observations, in a table that grows; of two techniques unless told otherwise.
///
///     auto rule = phimis::exact_rule(phimis::tsallis{0.5}, {.floors = {0.05, 0.05}, .prior = 8});
///     auto of_three = phimis::exact_rule<3>(phimis::chi_squared{}, {.costs = {1, 6.24, 3.28}});
template <int M, divergence Divergence, class Real = double>
exact_minimiser<Divergence, table<Real, M>> exact_rule(const Divergence& divergence,
                                                       const rule_options<Real, M>& options = {},
                                                       control_variate variate = control_variate::on) {
  validate(divergence);
  validate(options);
  validate_costs<Real>(divergence, options.costs.value);
  return exact_minimiser<Divergence, table<Real, M>>(divergence, options, variate);
}
template <divergence Divergence, class Real = double>
exact_minimiser<Divergence, table<Real, 2>> exact_rule(const Divergence& divergence,
                                                       const rule_options<Real, 2>& options = {},
                                                       control_variate variate = control_variate::on) {
  return exact_rule<2, Divergence, Real>(divergence, options, variate);
}

/// Newton's method on γ-moments from sums alone; `retention` is what is left of older sums at each update.
///
///     auto rule = phimis::streaming_rule<5>(phimis::kullback_leibler{}, {.prior = 2}, 0.5);
template <int M, divergence Divergence, class Real = double>
streaming_newton<Divergence, Real, M> streaming_rule(const Divergence& divergence,
                                                     const rule_options<Real, M>& options = {},
                                                     Real retention = Real(1)) {
  validate(divergence);
  const double exponent = detail::streaming_exponent(divergence);
  require(exponent > 0, "divergence", "must have a positive power of f/p as its score", exponent);
  validate(options);
  validate_equal_costs(options);
  require(is_density(retention) && retention <= 1, "retention", "must lie in [0, 1]", retention);
  return streaming_newton<Divergence, Real, M>(divergence, options, retention);
}

/// Counts in proportion to each technique's spread under `count_independent` weights.
///
///     auto rule = phimis::sigma_rule<3>({.costs = {1, 6.24, 3.28}});
template <int M, class Real = double, weight_heuristic Heuristic = balance>
sigma_proportional<Real, M, Heuristic> sigma_rule(const rule_options<Real, M>& options = {},
                                                  const Heuristic& heuristic = {}) {
  validate(options);
  validate(heuristic);
  return sigma_proportional<Real, M, Heuristic>(options, heuristic);
}

/// Fractions inverse to the variance that each technique has alone, and to its cost.
template <int M, class Real = double>
inverse_variance_fractions<Real, M> inverse_variance_rule(const rule_options<Real, M>& options = {}) {
  validate(options);
  return inverse_variance_fractions<Real, M>(options);
}

/// One Newton step for V[ℱ] from the start fractions.
template <int M, class Real = double>
second_order<Real, M> second_order_rule(const rule_options<Real, M>& options = {}) {
  validate(options);
  return second_order<Real, M>(options);
}

/// The linear heuristic; best_face keeps its samples in tables that grow.
///
///     auto rule = phimis::linear_rule<3>();
///     auto as_printed = phimis::linear_rule<3, phimis::negative_fractions::drop_most_negative>(
///         phimis::without_floors<double, 3>());
template <int M, negative_fractions Treatment = negative_fractions::project, class Real = double>
auto linear_rule(const rule_options<Real, M>& options = {}) {
  validate(options);
  validate_equal_costs(options);
  using samples = std::conditional_t<Treatment == negative_fractions::best_face, table<Real, M>, no_table>;
  return linear_heuristic<Real, M, Treatment, samples>(options);
}

}  // namespace phimis

#endif  // PHIMIS_SOLVER_RULES_HPP
