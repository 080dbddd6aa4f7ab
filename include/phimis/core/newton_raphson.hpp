// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_NEWTON_RAPHSON_HPP
#define PHIMIS_CORE_NEWTON_RAPHSON_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/divergence.hpp>
#include <phimis/core/finite.hpp>
#include <phimis/core/rule.hpp>

#include <cmath>

namespace phimis {

/// Which Newton–Raphson iteration.
enum class newton_form {
  /// The paper's protocol: the plain step; an iterate outside the floors is moved to the nearest one.
  paper,
  /// With the control variate E_q[(p_1 − p_2)/q] = 0, and a step that ends beyond a floor goes half the way to it.
  safeguarded
};

namespace detail {

/// Sums of one batch, with t in units of `reference`, the t of the largest |s| so far.
template <class Real>
struct newton_sums {
  Real n = 0;  // observations; −1 where the divergence is infinite
  Real reference = 0;
  Real zeta = 0;     // Σ (p_1 − p_2)/q s
  Real slope = 0;    // Σ (p_1 − p_2)²/(q p) t s'
  Real score = 0;    // Σ p/q s
  Real tilt = 0;     // Σ (p_1 − p_2)/q
  Real mixture = 0;  // Σ p/q
  Real f = 0;        // Σ f/q
};

}  // namespace detail

/// Newton–Raphson on the γ-moments of two techniques, one step for each batch, on that batch alone: O(1) memory.
///
///     ζ̂  = (1/N) Σ f^γ/p^{γ+1} (p_1 − p_2)
///     ζ̂' = −(γ/N) Σ f^γ/p^{γ+2} (p_1 − p_2)²
///     α ← α − ζ̂/ζ̂'
///
/// Source   T Eqs. 30–32; p is the mixture that the batch was drawn from, at the fractions of this rule.
/// Requires a divergence of the power family; batches drawn at `fractions()`, or close by where counts are rounded.
/// Errors   iterates that leave [0, 1] or are not finite are counted in `counters().left`.
/// - Sums are kept relative to the largest term so that no scale of f overflows; the step is the same.
/// - The reversed Kullback–Leibler divergence (γ = 0) always takes the control variate: without it the step would
///   depend on the unit of f.
template <class Divergence, class Real = double>
class newton_raphson : public rule_base<Real, 2, detail::newton_sums<Real>> {
  using sums = detail::newton_sums<Real>;
  static_assert(has_exponent<Divergence>::value,
                "newton_raphson needs a divergence of the power family; exact_minimiser takes any");

 public:
  PHIMIS_HOST_DEVICE newton_raphson() noexcept : newton_raphson(Divergence{}) {}
  PHIMIS_HOST_DEVICE explicit newton_raphson(const Divergence& divergence,
                                             newton_form form = newton_form::safeguarded,
                                             const rule_options<Real, 2>& options = {}) noexcept
      : rule_base<Real, 2, sums>(options), divergence_(divergence), form_(form) {}

  PHIMIS_HOST_DEVICE const Divergence& divergence() const noexcept { return divergence_; }

  PHIMIS_HOST_DEVICE void observe(const observation<Real, 2>& sample) noexcept {
    row<Real, 2> row;
    if (!this->admit(sample, row)) return;
    const auto& alpha = this->state_.fractions;
    const Real x = alpha[0] * row.y[0] + alpha[1] * row.y[1];
    const Real t = row.u > 0 ? row.u / x : Real(0);
    if (!is_finite(t)) {
      ++this->state_.counters.nonfinite;
      return;
    }
    sums& of = this->memory();
    if (of.n < 0) return;
    if (row.u > 0) {
      refer_to(t);
    } else if (exponent() <= 0) {
      of.n = -1;
      return;
    }
    of.n += 1;
    const Real tilt = row.w * (row.y[0] - row.y[1]);
    const Real ratio = row.u > 0 ? t / of.reference : Real(0);
    const score<Real> s = power_score(ratio, exponent());
    of.zeta += tilt * s.value;
    if (x > 0) of.slope += tilt * ((row.y[0] - row.y[1]) / x) * s.slope;
    of.score += row.w * x * s.value;
    of.tilt += tilt;
    of.mixture += row.w * x;
    of.f += row.w * x * ratio;
  }

  PHIMIS_HOST_DEVICE rule_status update() noexcept {
    const sums batch = this->memory();
    this->memory() = sums{};
    if (batch.n < 0) return this->end(rule_status::infinite_divergence);
    if (!(batch.f > 0)) return this->end(rule_status::no_information);

    auto& alpha = this->state_.fractions;
    const auto& options = this->options_;
    Real zeta = batch.zeta;
    Real slope = batch.slope;
    if (form_ == newton_form::safeguarded || exponent() == 0) {
      zeta -= batch.score / batch.mixture * batch.tilt;
    }
    for (int k = 0; k < 2 && options.prior > 0; ++k) {
      const bool in_prior = options.start[k] > 0;
      if (!in_prior && exponent() > 0) continue;
      if (!in_prior || !(alpha[k] > 0)) {
        // Infinitely far from the prior: go back to where it is.
        alpha = share_budget(options.start, options);
        return this->end(rule_status::updated);
      }
      const Real mean = batch.f / batch.n;
      const score<Real> s = power_score(mean * options.start[k] / alpha[k], exponent());
      zeta += options.prior * (k == 0 ? s.value : -s.value);
      slope += options.prior * s.slope / alpha[k];
    }
    const Real step = zeta / slope;
    if (!(slope > 0)) return this->end(rule_status::no_information);
    if (!is_finite(step)) {
      ++this->state_.counters.left;
      return this->end(rule_status::not_converged);
    }
    const Real low = options.floors[0];
    // Floors that sum to one leave a point, whatever their difference to one rounds to.
    const Real high = 1 - options.floors[1] > low ? 1 - options.floors[1] : low;
    Real first = alpha[0] + step;
    if (first < 0 || first > 1) ++this->state_.counters.left;
    if (form_ == newton_form::safeguarded) {
      if (first < low) first = (alpha[0] + low) / 2;
      if (first > high) first = (alpha[0] + high) / 2;
    }
    first = first < low ? low : first > high ? high : first;
    alpha[0] = first;
    alpha[1] = first == high ? options.floors[1] : 1 - first;
    return this->end(rule_status::updated);
  }

  /// Adds the batch that another state observed at the same fractions.
  PHIMIS_HOST_DEVICE void merge(const newton_raphson& other) noexcept {
    PHIMIS_EXPECTS(this->state_.fractions[0] == other.state_.fractions[0]);
    this->state_.counters.merge(other.state_.counters);
    sums theirs = other.memory();
    sums& of = this->memory();
    if (theirs.n < 0) of.n = -1;
    if (of.n < 0) return;
    if (theirs.reference > 0) {
      refer_to(theirs.reference);
      rescale(theirs, of.reference);
    }
    of.n += theirs.n;
    of.zeta += theirs.zeta;
    of.slope += theirs.slope;
    of.score += theirs.score;
    of.tilt += theirs.tilt;
    of.mixture += theirs.mixture;
    of.f += theirs.f;
  }

 private:
  PHIMIS_HOST_DEVICE Real exponent() const noexcept { return static_cast<Real>(divergence_.exponent()); }

  PHIMIS_HOST_DEVICE void refer_to(Real t) noexcept {
    sums& of = this->memory();
    if (!(of.reference > 0)) {
      of.reference = t;
    } else if (exponent() > 0 ? t > of.reference : t < of.reference) {
      rescale(of, t);
    }
  }

  PHIMIS_HOST_DEVICE void rescale(sums& of, Real reference) const noexcept {
    const Real ratio = of.reference / reference;
    const Real beta = exponent();
    if (beta == 0) {
      const Real shift = std::log(ratio);
      of.zeta += shift * of.tilt;
      of.score += shift * of.mixture;
    } else {
      const Real factor = std::pow(ratio, beta);
      of.zeta *= factor;
      of.slope *= factor;
      of.score *= factor;
    }
    of.f *= ratio;
    of.reference = reference;
  }

  Divergence divergence_;
  newton_form form_;
};

}  // namespace phimis

#endif  // PHIMIS_CORE_NEWTON_RAPHSON_HPP
