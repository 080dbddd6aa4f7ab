// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_STREAMING_NEWTON_HPP
#define PHIMIS_CORE_STREAMING_NEWTON_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/divergence.hpp>
#include <phimis/core/finite.hpp>
#include <phimis/core/quadratic_on_simplex.hpp>
#include <phimis/core/rule.hpp>
#include <phimis/core/simplex_problem.hpp>

#include <type_traits>

namespace phimis {

namespace detail {

/// γ of the moments that are summed up: 2 for the variances.
template <class Divergence>
PHIMIS_HOST_DEVICE constexpr double streaming_exponent(const Divergence& divergence) noexcept {
  if constexpr (has_exponent<Divergence>::value) {
    return divergence.exponent();
  } else {
    static_assert(std::is_same<Divergence, multi_sample_variance>::value,
                  "streaming_newton needs a divergence of the power family, or a variance");
    return 2;
  }
}

/// Σ t p_k p_l/(p q), k >= l, t with the sign of f: minus the slopes of the techniques' means μ'_k.
template <class Real, int M, bool Wanted>
struct streaming_means {
  Real m[M * (M + 1) / 2] = {};
};
template <class Real, int M>
struct streaming_means<Real, M, false> {};

/// With t = |f|/p(α) in units of the largest so far.
template <class Real, int M, bool Means>
struct streaming_sums : streaming_means<Real, M, Means> {
  static constexpr int entries = M * (M + 1) / 2;

  Real n = 0;
  Real reference = 0;
  Real f = 0;            // Σ |f|/q
  Real g[M] = {};        // Σ s p_k/q
  Real h[entries] = {};  // Σ s p_k p_l/(p q), k >= l

  PHIMIS_HOST_DEVICE void scale(Real factor, Real power) noexcept {
    f *= factor;
    for (Real& entry : g) entry *= power;
    for (Real& entry : h) entry *= power;
    if constexpr (Means) {
      for (Real& entry : this->m) entry *= factor;
    }
  }

  PHIMIS_HOST_DEVICE void add(const streaming_sums& other, Real weight) noexcept {
    n += weight * other.n;
    f += weight * other.f;
    for (int k = 0; k < M; ++k) g[k] += weight * other.g[k];
    for (int at = 0; at < entries; ++at) h[at] += weight * other.h[at];
    if constexpr (Means) {
      for (int at = 0; at < entries; ++at) this->m[at] += weight * other.m[at];
    }
  }
};

}  // namespace detail

/// Newton's method on the γ-moments of any number of techniques, from sums alone: O(M²) memory, all observations in use.
///
///     G_k  = Σ_j p_kj/q_j t_j^γ,   H_kl = Σ_j p_kj p_lj/(q_j p_j) t_j^γ,   t_j = |f_j|/p_j,   p_j = Σ_k α_k p_kj
///     α   ← argmin ½ αᵀHα − (1 + 1/γ) Gᵀα,   α_k ≥ floor_k,   Σ α_k = 1
///
/// each observation at the fractions of its time. Since Σ_l H_kl α_l = G_k, its second order around these is the same
/// quadratic form whatever they were: sums over many fractions, and over many states, are one quadratic. At each update
/// older sums are multiplied by `retention`: 0 is the paper's rule, this batch only; near 1 is least noise, but models
/// around fractions that were bad stay. An update costs no pass over samples: many small ones in a row walk to the optimum.
///
/// For two techniques and one batch drawn at q = p it is the step of `newton_raphson`.
///
/// For V[F], the `multi_sample_variance`, γ = 2 and what balancing between techniques takes off, Σ α_k μ'_k², adds its slope
/// at α to 3/2 G:
///
///     ½ (μ'_l² − 2 Σ_k α_k μ'_k M_kl),   M_kl = ∫ f p_k p_l/p² dx,   μ'_k = Σ_l M_kl α_l
///
/// Its curvature is left out, so that steps are short where V[F] is far below V[ℱ]; where f has both signs they may be too
/// long, and fractions swing if retention is near 0. M_kl stays at the fractions of its time. Where pixels of a cell share
/// sums, means of means stand for the means of each: between V[ℱ] and V[F].
///
/// Source   T Eqs. 30–32, for M techniques; floors as constraints. V[F]: T Eq. 7.
/// Requires a divergence of the power family, γ > 0, or a variance; 0 <= retention <= 1.
/// Errors   no_information, and fractions as before, where every f is 0; not_converged, and all sums forgotten, where
///          p/q was so large that one is not finite. An observation whose |f|/p is not finite is
///          counted as such; of one with f = 0 the pdfs are not looked at.
/// Cost     an observation with f ≠ 0: M (M + 7)/2 multiplications (V[F]: M (M + 1) more), three divisions and a power; with
///          f = 0 nothing. An update: M³ for each change of the set of techniques at their floors.
/// - There is no control variate: pdfs may be defective. Costs are not known to this rule.
/// - The prior enters as the second order of prior · D(π, α) at π, at each update.
template <class Divergence, class Real, int M>
class streaming_newton
    : public rule_base<Real, M, detail::streaming_sums<Real, M, !has_exponent<Divergence>::value>> {
  static_assert(M >= 2, "streaming_newton needs two techniques to choose from");
  static constexpr bool means = !has_exponent<Divergence>::value;
  using sums = detail::streaming_sums<Real, M, means>;

 public:
  PHIMIS_HOST_DEVICE streaming_newton() noexcept : streaming_newton(Divergence{}) {}
  PHIMIS_HOST_DEVICE explicit streaming_newton(const Divergence& divergence,
                                               const rule_options<Real, M>& options = {},
                                               Real retention = Real(1)) noexcept
      : rule_base<Real, M, sums>(options), divergence_(divergence), retention_(retention) {
    PHIMIS_EXPECTS(exponent() > 0 && retention >= 0 && retention <= 1);
  }

  PHIMIS_HOST_DEVICE const Divergence& divergence() const noexcept { return divergence_; }

  PHIMIS_HOST_DEVICE void observe(const observation<Real, M>& sample) noexcept {
    sums& of = this->memory();
    rule_counters<Real>& counters = this->state_.counters;
    ++counters.observations;
    if (is_finite(sample.f) && sample.f == 0) {  // NaN == 0 under -ffast-math
      ++counters.zero;
      of.n += 1;
      return;
    }
    const phimis::fractions<Real, M>& alpha = this->state_.fractions;
    Real p = 0;
    bool good = is_finite(sample.f);
    for (int k = 0; k < M; ++k) {
      p += alpha[k] * sample.pdfs[k];
      good = good && !(sample.pdfs[k] < 0);
    }
    const Real inverse = 1 / p;
    const Real t = (sample.f < 0 ? -sample.f : sample.f) * inverse;
    const Real w = p / sample.q;
    if (!good || !is_finite(t) || !(w > 0) || !is_finite(w)) {
      ++counters.nonfinite;
      return;
    }
    of.n += 1;
    if (t > of.reference) refer_to(t, of);
    const Real ratio = t / of.reference;
    const Real s = w * power_score(ratio, static_cast<Real>(exponent())).value;
    of.f += w * ratio;
    Real share[M];  // p_k/p
    for (int k = 0, at = 0; k < M; ++k) {
      share[k] = sample.pdfs[k] * inverse;
      const Real weighted = s * share[k];
      of.g[k] += weighted;
      for (int l = 0; l <= k; ++l) of.h[at++] += weighted * share[l];
    }
    if constexpr (means) {
      const Real mean = sample.f < 0 ? -w * ratio : w * ratio;
      for (int k = 0, at = 0; k < M; ++k) {
        for (int l = 0; l <= k; ++l) of.m[at++] += mean * share[k] * share[l];
      }
    }
  }

  PHIMIS_HOST_DEVICE rule_status update() noexcept {
    sums& of = this->memory();
    if (!(of.f > 0)) return this->end(rule_status::no_information);
    const auto& options = this->options_;
    double a[M][M];
    double b[M] = {};
    const double n = static_cast<double>(of.n);
    const double prior = static_cast<double>(options.prior);
    const double mean = static_cast<double>(of.f) / n;  // in the unit of t
    double kappa[M];
    double total = mean;
    if constexpr (means) add_slope_of_means(b);
    for (int k = 0, at = 0; k < M; ++k) {
      for (int l = 0; l <= k; ++l, ++at) total += a[k][l] = a[l][k] = static_cast<double>(of.h[at]);
      total += b[k] += static_cast<double>(of.g[k]);
      kappa[k] = 1;
      const double start = static_cast<double>(options.start[k]);
      if (!(prior > 0) || !(start > 0)) continue;
      // prior · D(π, α) to second order at π
      const double s = prior * power_score(mean, exponent()).value;
      a[k][k] += s / start;
      b[k] += s;
    }
    if (!is_finite(total)) {
      of = sums{};
      return this->end(rule_status::not_converged);
    }
    double map_memory[floored_simplex::doubles(M)];
    int coordinates[M];
    floored_simplex on(M, kappa, map_memory, coordinates);
    on.constrain([&](int k) { return options.frozen[k]; },
                 [&](int k) { return options.frozen[k] ? options.start[k] : options.floors[k]; });
    rule_status status = rule_status::updated;
    if (on.has_freedom()) {
      status = minimise_quadratic(a, b, 1 + 1 / exponent(), on, this->state_.fractions);
    }
    if (retention_ > 0) {
      of.n *= retention_;
      of.scale(retention_, retention_);
    } else {
      of = sums{};  // the unit too
    }
    return this->end(status);
  }

  /// Adds what another state has observed.
  PHIMIS_HOST_DEVICE void merge(const streaming_newton& other) noexcept {
    this->state_.counters.merge(other.state_.counters);
    pool(other.state_, 1);
  }

  /// Learns from a neighbour's state as if each of its observations counted `weight` times: how alike the two are is for
  /// the host to say. The counters stay those of this rule.
  PHIMIS_HOST_DEVICE void pool(const typename streaming_newton::state_type& neighbour, Real weight) noexcept {
    PHIMIS_EXPECTS(weight >= 0);
    sums theirs = neighbour.memory;
    sums& of = this->memory();
    if (theirs.reference > of.reference) refer_to(theirs.reference, of);
    if (theirs.reference > 0) refer_to(of.reference, theirs);
    of.add(theirs, weight);
  }

 private:
  PHIMIS_HOST_DEVICE double exponent() const noexcept { return detail::streaming_exponent(divergence_); }

  /// Adds the slope of n Σ α_k μ'_k², over 3, up to a constant with which b stays of its size: Σ α_k b_k does not change.
  PHIMIS_HOST_DEVICE void add_slope_of_means(double (&b)[M]) const noexcept {
    const sums& of = this->memory();
    const phimis::fractions<Real, M>& alpha = this->state_.fractions;
    const double n = static_cast<double>(of.n);
    double slopes[M][M];
    double mean[M] = {};
    double squares = 0;
    for (int k = 0, at = 0; k < M; ++k) {
      for (int l = 0; l <= k; ++l, ++at) slopes[k][l] = slopes[l][k] = static_cast<double>(of.m[at]) / n;
    }
    for (int k = 0; k < M; ++k) {
      for (int l = 0; l < M; ++l) mean[k] += slopes[k][l] * static_cast<double>(alpha[l]);
      squares += static_cast<double>(alpha[k]) * mean[k] * mean[k];
    }
    for (int l = 0; l < M; ++l) {
      double slope = squares + mean[l] * mean[l];
      for (int k = 0; k < M; ++k) slope -= 2 * static_cast<double>(alpha[k]) * mean[k] * slopes[k][l];
      b[l] += n * slope / 3;
    }
  }

  PHIMIS_HOST_DEVICE void refer_to(Real t, sums& of) const noexcept {
    if (!(of.reference > 0)) of.reference = t;
    if (!(t > of.reference)) return;
    const Real ratio = of.reference / t;
    of.scale(ratio, power_score(ratio, static_cast<Real>(exponent())).value);
    of.reference = t;
  }

  Divergence divergence_;
  Real retention_;
};

}  // namespace phimis

#endif  // PHIMIS_CORE_STREAMING_NEWTON_HPP
