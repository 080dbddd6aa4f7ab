// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_SECOND_ORDER_HPP
#define PHIMIS_CORE_SECOND_ORDER_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/finite.hpp>
#include <phimis/core/quadratic_on_simplex.hpp>
#include <phimis/core/rule.hpp>
#include <phimis/core/simplex_problem.hpp>

#include <cstdint>

namespace phimis {

namespace detail {

/// With t = f/p(π) in units of `reference`, the largest so far.
template <class Real, int M>
struct second_order_sums {
  static constexpr int entries = M * (M + 1) / 2;

  std::int64_t n = 0;
  Real reference = 0;
  Real f = 0;            // Σ f/q
  Real a[entries] = {};  // Σ f² p_k p_l/(p³ q), k >= l
};

}  // namespace detail

/// One Newton step for V[ℱ] from the start fractions π, equal by default, for any number of techniques.
///
///     V[ℱ](π + d) ≈ V[ℱ](π) − b·d + dᵀA d
///     A_kl = ∫ f² p_k p_l / p(π)³ dx,   b_k = ∫ f² p_k / p(π)² dx = Σ_l A_kl π_l
///
/// The minimum of that quadratic over the fractions that respect the floors; A is summed over all observations ever made.
/// Away from the start it is an approximation: it does not become exact with more samples.
///
/// Source   Lu, Pacanowski & Granier 2013, as told by V Sec. 1: "Taylor's second order approximation of the variance around
///          the equal weights ½".
/// Requires each observation with the density q that it was drawn from.
/// Errors   no_information, and fractions as before, where every f is 0 or a technique has no density where f ≠ 0; samples
///          where p(π) = 0 ≠ f count as not finite.
/// Cost     M² memory; an observation M², an update M³ for each change of the set of techniques at their floors.
/// - V tells the idea and no formula; here it is carried out, for the variance of the balance heuristic V[ℱ], M techniques
///   in place of two, and any start.
/// - Floors and frozen techniques are constraints of the quadratic, not a clamp after its step.
/// - With costs it is the same step for (Σ c_k α_k) ∫ f²/p(α) dx, in the shares a_k ∝ c_k α_k, in which that is convex: the
///   cost times the second moment, not the variance.
/// - The prior enters as the second order of prior · D(π, α): a matrix prior · μ²/π_k on the diagonal.
template <class Real, int M>
class second_order : public rule_base<Real, M, detail::second_order_sums<Real, M>> {
  using sums = detail::second_order_sums<Real, M>;

 public:
  PHIMIS_HOST_DEVICE second_order() noexcept : second_order(rule_options<Real, M>{}) {}
  PHIMIS_HOST_DEVICE explicit second_order(const rule_options<Real, M>& options) noexcept
      : rule_base<Real, M, sums>(options) {}

  PHIMIS_HOST_DEVICE void observe(const observation<Real, M>& sample) noexcept {
    row<Real, M> row;
    if (!this->admit(sample, row)) return;
    Real x = 0;
    for (int k = 0; k < M; ++k) x += this->options_.start[k] * row.y[k];
    const Real t = row.u > 0 ? row.u / x : Real(0);
    if (!is_finite(t)) {
      ++this->state_.counters.nonfinite;
      return;
    }
    sums& of = this->memory();
    ++of.n;
    if (!(t > 0)) return;
    if (t > of.reference) refer_to(t, of);
    const Real ratio = t / of.reference;
    of.f += row.w * x * ratio;
    const Real square = row.w * x * ratio * ratio;
    for (int k = 0, at = 0; k < M; ++k) {
      for (int l = 0; l <= k; ++l, ++at) of.a[at] += square * (row.y[k] / x) * (row.y[l] / x);
    }
  }

  PHIMIS_HOST_DEVICE rule_status update() noexcept {
    const auto& options = this->options_;
    const sums& of = this->memory();
    if (!(of.f > 0)) return this->end(rule_status::no_information);
    double a[M][M];
    const double n = static_cast<double>(of.n);
    const double mean = static_cast<double>(of.f) / n;
    const per_technique<Real, M> costs = relative_costs(options.costs);
    double mean_cost = 0;
    double kappa[M];
    for (int k = 0, at = 0; k < M; ++k) {
      for (int l = 0; l <= k; ++l, ++at) a[k][l] = a[l][k] = static_cast<double>(of.a[at]) / n;
      if (!(a[k][k] > 0)) return this->end(rule_status::no_information);
      const double start = static_cast<double>(options.start[k]);
      if (options.prior > 0 && start > 0) a[k][k] += static_cast<double>(options.prior) / n * mean * mean / start;
      mean_cost += start * static_cast<double>(costs[k]);
      kappa[k] = 1 / static_cast<double>(costs[k]);
    }
    double b[M] = {};
    for (int k = 0; k < M; ++k) {
      for (int l = 0; l < M; ++l) b[k] += a[k][l] * static_cast<double>(options.start[l]) / mean_cost;
    }

    double map_memory[floored_simplex::doubles(M)];
    int coordinates[M];
    floored_simplex on(M, kappa, map_memory, coordinates);
    const auto from = share_budget(options.start, options);
    on.constrain([&](int k) { return options.frozen[k]; },
                 [&](int k) { return options.frozen[k] ? from[k] : options.floors[k]; });
    this->state_.fractions = from;
    if (!on.has_freedom()) return this->end(rule_status::updated);
    return this->end(minimise_quadratic(a, b, 1.5, on, this->state_.fractions));
  }

  /// Adds what another state, with the same start, has observed.
  PHIMIS_HOST_DEVICE void merge(const second_order& other) noexcept {
    for (int k = 0; k < M; ++k) PHIMIS_EXPECTS(this->options_.start[k] == other.options_.start[k]);
    this->state_.counters.merge(other.state_.counters);
    sums theirs = other.memory();
    sums& of = this->memory();
    if (theirs.reference > of.reference) refer_to(theirs.reference, of);
    if (theirs.reference > 0) refer_to(of.reference, theirs);
    of.n += theirs.n;
    of.f += theirs.f;
    for (int at = 0; at < sums::entries; ++at) of.a[at] += theirs.a[at];
  }

 private:
  PHIMIS_HOST_DEVICE static void refer_to(Real t, sums& of) noexcept {
    const Real ratio = of.reference / t;
    of.f *= ratio;
    for (Real& entry : of.a) entry *= ratio * ratio;
    of.reference = t;
  }
};

}  // namespace phimis

#endif  // PHIMIS_CORE_SECOND_ORDER_HPP
