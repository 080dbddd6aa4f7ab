// SPDX-License-Identifier: MIT
#ifndef PHIMIS_ANALYSIS_OPTIMUM_HPP
#define PHIMIS_ANALYSIS_OPTIMUM_HPP

#include <phimis/analysis/problem.hpp>
#include <phimis/analysis/variance.hpp>
#include <phimis/concepts.hpp>
#include <phimis/core/divergence_at.hpp>
#include <phimis/core/kink.hpp>
#include <phimis/core/limits.hpp>
#include <phimis/core/minimise_rows.hpp>
#include <phimis/core/movable_techniques.hpp>
#include <phimis/core/pair_sums.hpp>
#include <phimis/core/solve_pair.hpp>
#include <phimis/validate.hpp>

#include <boost/math/tools/roots.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

namespace phimis::analysis {

/// Fractions that are optimal in a stated sense.
template <int M>
struct optimal_fractions {
  fractions<double, M> alpha;
  /// Of the α_k. Of two techniques: from the error of the condition over its slope, 0 at a bound. Of more: how far the
  /// embedded Gauss rule has its optimum from that of the Kronrod rule, which is far nearer to the truth.
  double error;
  double residual;  ///< KKT residual on all coordinates relative to λ
  bool local;       ///< the objective is not convex: this is the minimum downhill of the start
};

namespace detail {

/// Where g = p(α): the kinks of total variation and of odd Pearson–Vajda divergences.
inline std::vector<double> crossings(const problem<2>& on, const fractions<double, 2>& alpha) {
  const auto excess = [&](double x) { return std::fabs(on.f(x)) / on.size() - mixture(alpha, on.pdfs_at(x)); };
  std::vector<double> roots;
  const std::vector<double>& x = on.nodes();
  double before = excess(x[0]);
  for (std::size_t i = 1; i < x.size(); ++i) {
    const double after = excess(x[i]);
    if (before * after < 0) {
      std::uintmax_t most = 100;
      const auto [low, high] = boost::math::tools::toms748_solve(excess, x[i - 1], x[i], before, after,
                                                                 boost::math::tools::eps_tolerance<double>(), most);
      roots.push_back(low + (high - low) / 2);
    }
    before = after;
  }
  return roots;
}

/// The integrand of ζ, where it is one.
template <class Divergence>
double condition(const Divergence& divergence, const problem<2>& on, double f, const per_technique<double, 2>& p,
                 const fractions<double, 2>& alpha) {
  const double q = mixture(alpha, p);
  if (q == 0) return 0;
  const double t = std::fabs(f) / (on.size() * q);
  if constexpr (std::is_same_v<Divergence, multi_sample_variance>) {
    return (p[0] - p[1]) * t * t;
  } else {
    return (p[0] - p[1]) * (score_at(divergence, t).value - score_at_zero(divergence));
  }
}

template <class Divergence>
optimal_fractions<2> solve_pair_on(const Divergence& divergence, const problem<2>& on,
                                   const rule_options<double, 2>& options, const fractions<double, 2>& from) {
  constexpr bool kinked = phimis::detail::is_kinked<Divergence>::value;
  constexpr bool local = std::is_same_v<Divergence, multi_sample_variance>;
  const bool normalised = on.missing_mass()[0] == 0 && on.missing_mass()[1] == 0;
  const table<double, 2> rows = local ? on.signed_rows() : on.rows();
  const auto evaluate = [&](const pair_fractions& at) {
    const pair_point<double> point{{at.first, at.second}, {1, 1}, 1 / on.size(), 1, normalised};
    if constexpr (kinked) {
      const table<double, 2> split = on.split_at(crossings(on, {{at.first, at.second}})).rows();
      return sum_pair(divergence, split.view(), point);
    } else {
      return sum_pair(divergence, rows.view(), point);
    }
  };
  const pair_fractions low{options.floors[0], 1 - options.floors[0]};
  const pair_fractions high{1 - options.floors[1], options.floors[1]};
  const fractions<double, 2> start = with_floors(from, options.floors);
  const pair_solution found =
      solve_pair(evaluate, low, high, {start[0], start[1]}, 1e-15, local ? objective::any : objective::convex);

  optimal_fractions<2> result{
      {{found.alpha.first, found.alpha.second}}, 0, kinked && found.bracketed ? 0 : found.residual, local};
  if (found.alpha.first == low.first || found.alpha.second == high.second) return result;
  // How far ζ may be off, by quadrature, by what is left of it and by the rounding of its sum, over how fast it changes.
  constexpr double rounding = 16 * epsilon<double>;
  const pair_sums at = evaluate(found.alpha);
  const double h = 1e-4 * phimis::detail::smaller(found.alpha);
  const double above = evaluate({found.alpha.first + h, found.alpha.second - h}).zeta;
  const double below = evaluate({found.alpha.first - h, found.alpha.second + h}).zeta;
  const auto integrand = [&](double f, const per_technique<double, 2>& p, double) {
    return condition(divergence, on, f, p, result.alpha);
  };
  const measured zeta =
      kinked ? on.split_at(crossings(on, result.alpha)).integral(integrand) : on.integral(integrand);
  result.error = (zeta.error + std::fabs(at.zeta) + rounding * at.lambda) / ((below - above) / (2 * h));
  return result;
}

/// The score at a point, times Σ p_k: what panels have to resolve.
template <class Divergence, int M>
double score_of_all(const Divergence& divergence, const problem<M>& on, double f, const per_technique<double, M>& p,
                    const fractions<double, M>& alpha) {
  const double q = mixture(alpha, p);
  if (q == 0) return 0;
  double sum = 0;
  for (const double pdf : p) sum += pdf;
  const double t = std::fabs(f) / (on.size() * q);
  if constexpr (phimis::detail::is_variance<Divergence>::value) {
    return sum * t * t;
  } else {
    return sum * (score_at(divergence, t).value - score_at_zero(divergence));
  }
}

template <class Divergence, int M>
optimal_fractions<M> solve_on(const Divergence& divergence, const problem<M>& on,
                              const rule_options<double, M>& options, const fractions<double, M>& from) {
  const fractions<double, M> start = share_budget(from, options);
  const auto solve = [&](const table<double, M>& rows, fractions<double, M>& alpha) {
    const columns<double, M> view = rows.view();
    const column_pointers<double> pointers{view.u, view.w, view.y, view.n, M};
    double largest = 0;
    for (std::ptrdiff_t j = 0; j < view.n; ++j) largest = std::max(largest, std::fabs(view.u[j]));
    const minimisation<double> wanted{.start = options.start.value,
                                      .from = start.value,
                                      .floors = options.floors.value,
                                      .costs = options.costs.value,
                                      .frozen = options.frozen.value,
                                      .prior = options.prior,
                                      .mass = 1,
                                      .variate = control_variate::off};
    std::array<double, minimise_doubles<Divergence>(M)> memory{};
    std::array<int, minimise_indices(M)> indices{};
    alpha = start;
    return row_minimisation<Divergence, double>(divergence, pointers, largest, wanted, memory.data(), indices.data())
        .minimise(alpha.value);
  };
  constexpr bool is_signed = phimis::detail::is_variance<Divergence>::value;
  optimal_fractions<M> result{};
  const row_minimum found = solve(is_signed ? on.signed_rows() : on.rows(), result.alpha);
  result.residual = found.solution.residual;
  result.local = found.status == rule_status::local;
  fractions<double, M> embedded{};
  const table<double, M> nodes = on.embedded_rows();
  table<double, M> coarse;
  for (std::ptrdiff_t j = 0; j < nodes.size(); ++j) {
    row<double, M> row = nodes[j];
    if (!is_signed) row.u = std::fabs(row.u);
    coarse.push(row);
  }
  solve(coarse, embedded);
  result.error = 4 * epsilon<double>;
  for (int k = 0; k < M; ++k) result.error = std::max(result.error, std::fabs(embedded[k] - result.alpha[k]));
  return result;
}

}  // namespace detail

/// The divergence as `divergence_at`, with the kinks of the integrand as panel edges.
template <class Divergence>
measured divergence_between_kinks(const Divergence& divergence, const problem<2>& on,
                                  const fractions<double, 2>& alpha) {
  return divergence_at(divergence, on.split_at(detail::crossings(on, alpha)), alpha);
}

/// The fractions that minimise a divergence, or V[F], on the exact integrals; cost times either with costs.
///
/// The solver is that of the exact minimiser, on quadrature nodes in place of samples; without floors unless they are
/// asked for. Where φ has kinks, the panels are split at g = p(α) for every α that two techniques try; kinks elsewhere than
/// at t = 1, or of more techniques, enlarge the error.
///
/// Source T Eqs. 16, 18, 25, 27; V[F] by multi_sample_variance.
/// Units  the prior in units of the integral: D(g, p(α)) + prior · D(π, α).
/// Errors std::invalid_argument as `validate`; where a reversed divergence is infinite for every α.
template <divergence Divergence, int M>
optimal_fractions<M> optimum(
    const Divergence& divergence, const problem<M>& on,
    const std::type_identity_t<rule_options<double, M>>& options = without_floors<double, M>()) {
  validate(divergence);
  validate(options);
  validate_costs<double>(divergence, options.costs.value);
  constexpr bool kinked = phimis::detail::is_kinked<Divergence>::value;
  if (infinite_at_zero(divergence)) {
    const table<double, M> rows = on.rows();
    std::ptrdiff_t zeros = 0;
    for (std::ptrdiff_t j = 0; j < rows.size(); ++j) zeros += rows[j].u > 0 ? 0 : 1;
    require(zeros == 0, "divergence", "is infinite where f = 0 < p; number of such nodes", zeros);
  }
  // Nothing can move: the start is the best there is.
  if (!movable_techniques<M>(options).any()) return {share_budget(options.start, options), 0, 0, false};
  const auto solve = [&](const problem<M>& with, const fractions<double, M>& from) {
    if constexpr (M == 2) {
      const bool plain = options.costs[0] == options.costs[1] && !(options.prior > 0);
      if (plain) return detail::solve_pair_on(divergence, with, options, from);
    }
    return detail::solve_on(divergence, with, options, from);
  };
  optimal_fractions<M> result = solve(on, options.start);
  if (!kinked && result.error > 1e-12) {
    // Powers of f/p far from 1 need finer panels than f and p themselves: resolve the condition at the solution.
    const fractions<double, M> at = result.alpha;
    const problem<M> refined = on.refined_for(
        [&](double f, const per_technique<double, M>& p) { return detail::score_of_all(divergence, on, f, p, at); });
    result = solve(refined, at);
  }
  return result;
}

}  // namespace phimis::analysis

#endif  // PHIMIS_ANALYSIS_OPTIMUM_HPP
