// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_STREAMING_NEWTON_HPP
#define PHIMIS_CORE_STREAMING_NEWTON_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/divergence.hpp>
#include <phimis/core/finite.hpp>
#include <phimis/core/quadratic_on_simplex.hpp>
#include <phimis/core/rule.hpp>
#include <phimis/core/simplex_problem.hpp>

namespace phimis {

namespace detail {

/// In units of the largest t = |f|/q so far; the batch since the last update, and what is left of earlier ones.
template <class Real, int M>
struct streaming_sums {
  static constexpr int entries = M * (M + 1) / 2;

  Real n = 0;
  Real reference = 0;
  Real f = 0;            // Σ f/q
  Real g[M] = {};        // Σ t^γ p_k/q
  Real h[entries] = {};  // Σ t^γ p_k p_l/q², k >= l

  PHIMIS_HOST_DEVICE void scale(Real factor, Real power) noexcept {
    f *= factor;
    for (Real& entry : g) entry *= power;
    for (Real& entry : h) entry *= power;
  }
};

}  // namespace detail

/// Newton's method on the γ-moments of any number of techniques, from sums alone.
///
///     G_k = Σ_j t_j^γ p_kj/q_j,   H_kl = Σ_j t_j^γ p_kj p_lj/q_j²,   t_j = |f_j|/q_j
///     α ← argmin −(1 + 1/γ) Σ_k G_k α_k + ½ Σ_kl H_kl α_k α_l,   α_k ≥ floor_k,  α_k ≥ α_k/4,  Σ α_k = 1
///
/// the second order of Σ_j (q_j/p)^… at the fractions that each batch was drawn at, which q tells: the sums of many states and of
/// many batches are one quadratic. For two techniques and one batch it is the step of `newton_raphson`; a fraction falls to a
/// quarter at most, since a step to a floor starves the technique whose samples would have said so.
///
/// Batches drawn at other fractions are models around these. `memory` is what is left of older sums at each update:
/// 1 keeps all alike, 0 is the paper's rule, that batch only.
///
/// Source   T Eqs. 30–32, for M techniques; floors as constraints.
/// Requires a divergence of the power family, γ > 0; q the mixture of a batch, at fractions near these.
/// Errors   `no_information` and fractions as before where every f is 0.
/// Cost     M (M + 3)/2 multiplications an observation, and a power; M² memory; an update M³ for each change of the set of
///          techniques at their floors.
/// - pdfs may be defective: there is no control variate.
/// - Costs are not known to this rule.
template <class Divergence, class Real, int M>
class streaming_newton : public rule_base<Real, M, detail::streaming_sums<Real, M>> {
  static_assert(has_exponent<Divergence>::value, "streaming_newton needs a divergence of the power family");
  static_assert(M >= 2, "streaming_newton needs two techniques to choose from");
  using sums = detail::streaming_sums<Real, M>;

 public:
  PHIMIS_HOST_DEVICE streaming_newton() noexcept : streaming_newton(Divergence{}) {}
  PHIMIS_HOST_DEVICE explicit streaming_newton(const Divergence& divergence,
                                               const rule_options<Real, M>& options = {},
                                               Real memory = Real(1)) noexcept
      : rule_base<Real, M, sums>(options), divergence_(divergence), memory_(memory) {
    PHIMIS_EXPECTS(divergence.exponent() > 0 && memory >= 0 && memory <= 1);
  }

  PHIMIS_HOST_DEVICE const Divergence& divergence() const noexcept { return divergence_; }

  PHIMIS_HOST_DEVICE void observe(const observation<Real, M>& sample) noexcept {
    sums& of = this->memory();
    rule_counters<Real>& counters = this->state_.counters;
    ++counters.observations;
    if (sample.f == 0) {
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
    const Real s = w * power_score(ratio, exponent()).value;
    of.f += w * ratio;
    Real* h = of.h;
    Real share[M];  // p_k/p
    for (int k = 0; k < M; ++k) {
      share[k] = sample.pdfs[k] * inverse;
      const Real weighted = s * share[k];
      of.g[k] += weighted;
      for (int l = 0; l <= k; ++l) *h++ += weighted * share[l];
    }
  }

  PHIMIS_HOST_DEVICE rule_status update() noexcept {
    sums& of = this->memory();
    if (!(of.f > 0)) return this->end(rule_status::no_information);
    const auto& options = this->options_;
    double a[M][M];
    double b[M];
    const double n = static_cast<double>(of.n);
    const double prior = static_cast<double>(options.prior);
    const double mean = static_cast<double>(of.f) / n;  // in the unit of t
    double kappa[M];
    for (int k = 0, at = 0; k < M; ++k) {
      for (int l = 0; l <= k; ++l, ++at) a[k][l] = a[l][k] = static_cast<double>(of.h[at]);
      b[k] = static_cast<double>(of.g[k]);
      kappa[k] = 1;
      const double start = static_cast<double>(options.start[k]);
      if (!(prior > 0) || !(start > 0)) continue;
      // prior · D(π, α) to second order at π
      const double s = prior * power_score(mean, static_cast<double>(exponent())).value;
      a[k][k] += s / start;
      b[k] += s;
    }
    double map_memory[floored_simplex::doubles(M)];
    int coordinates[M];
    floored_simplex on(M, kappa, map_memory, coordinates);
    const auto& from = this->state_.fractions;
    on.constrain([&](int k) { return options.frozen[k]; },
                 [&](int k) {
                   if (options.frozen[k]) return options.start[k];
                   return from[k] / 4 > options.floors[k] ? from[k] / 4 : options.floors[k];
                 });
    rule_status status = rule_status::updated;
    if (on.has_freedom()) {
      status = minimise_quadratic(a, b, 1 + 1 / static_cast<double>(exponent()), on, this->state_.fractions);
    }
    of.n *= memory_;
    of.scale(memory_, memory_);
    return this->end(status);
  }

  /// Adds what another state has observed, each observation counting `weight` times.
  PHIMIS_HOST_DEVICE void merge(const streaming_newton& other, Real weight = Real(1)) noexcept {
    this->state_.counters.merge(other.state_.counters);
    add(other.memory(), weight);
  }
  /// The same from what was kept of another state; its counts of observations stay apart.
  PHIMIS_HOST_DEVICE void add(sums theirs, Real weight = Real(1)) noexcept {
    sums& of = this->memory();
    if (theirs.reference > of.reference) refer_to(theirs.reference, of);
    if (theirs.reference > 0) refer_to(of.reference, theirs);
    of.n += weight * theirs.n;
    of.f += weight * theirs.f;
    for (int k = 0; k < M; ++k) of.g[k] += weight * theirs.g[k];
    for (int at = 0; at < sums::entries; ++at) of.h[at] += weight * theirs.h[at];
  }

 private:
  PHIMIS_HOST_DEVICE Real exponent() const noexcept { return static_cast<Real>(divergence_.exponent()); }

  PHIMIS_HOST_DEVICE void refer_to(Real t, sums& of) const noexcept {
    if (!(of.reference > 0)) of.reference = t;
    if (!(t > of.reference)) return;
    const Real ratio = of.reference / t;
    of.scale(ratio, power_score(ratio, exponent()).value);
    of.reference = t;
  }

  Divergence divergence_;
  Real memory_;
};

}  // namespace phimis

#endif  // PHIMIS_CORE_STREAMING_NEWTON_HPP
