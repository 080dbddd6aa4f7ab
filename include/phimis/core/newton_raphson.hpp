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
class newton_raphson : public rule_base<Real, 2> {
  static_assert(has_exponent<Divergence>::value,
                "newton_raphson needs a divergence of the power family; exact_minimiser takes any");

 public:
  PHIMIS_HOST_DEVICE newton_raphson() noexcept : newton_raphson(Divergence{}) {}
  PHIMIS_HOST_DEVICE explicit newton_raphson(const Divergence& divergence,
                                             newton_form form = newton_form::safeguarded,
                                             const rule_options<Real, 2>& options = {}) noexcept
      : rule_base<Real, 2>(options), divergence_(divergence), form_(form) {}

  PHIMIS_HOST_DEVICE const Divergence& divergence() const noexcept { return divergence_; }

  PHIMIS_HOST_DEVICE void observe(const observation<Real, 2>& sample) noexcept {
    row<Real, 2> row;
    if (!this->admit(sample, row)) return;
    const auto& alpha = this->fractions_;
    const Real x = alpha[0] * row.y[0] + alpha[1] * row.y[1];
    const Real t = row.u > 0 ? row.u / x : Real(0);
    if (!is_finite(t)) {
      ++this->counters_.nonfinite;
      return;
    }
    ++sums_.n;
    if (row.u > 0) {
      refer_to(t);
    } else if (exponent() <= 0) {
      sums_.infinite = true;
      return;
    }
    const Real tilt = row.w * (row.y[0] - row.y[1]);
    const Real ratio = row.u > 0 ? t / sums_.reference : Real(0);
    const score<Real> s = power_score(ratio, exponent());
    sums_.zeta += tilt * s.value;
    if (x > 0) sums_.slope += tilt * ((row.y[0] - row.y[1]) / x) * s.slope;
    sums_.score += row.w * x * s.value;
    sums_.tilt += tilt;
    sums_.mixture += row.w * x;
    sums_.f += row.w * x * ratio;
  }

  PHIMIS_HOST_DEVICE rule_status update() noexcept {
    const sums batch = sums_;
    sums_ = sums{};
    if (batch.infinite) return this->status_ = rule_status::infinite_divergence;
    if (!(batch.f > 0)) return this->status_ = rule_status::no_information;

    auto& alpha = this->fractions_;
    const auto& options = this->options_;
    Real zeta = batch.zeta;
    Real slope = batch.slope;
    if (form_ == newton_form::safeguarded || exponent() == 0) {
      zeta -= batch.score / batch.mixture * batch.tilt;
    }
    for (int k = 0; k < 2 && options.prior > 0; ++k) {
      if (!(options.start[k] > 0)) continue;
      if (!(alpha[k] > 0)) {
        // An end is infinitely far from the prior: go back to where it is.
        alpha = share_budget(options.start, options);
        return this->status_ = rule_status::updated;
      }
      const Real mean = batch.f / static_cast<Real>(batch.n);
      const score<Real> s = power_score(mean * options.start[k] / alpha[k], exponent());
      zeta += options.prior * (k == 0 ? s.value : -s.value);
      slope += options.prior * s.slope / alpha[k];
    }
    const Real step = zeta / slope;
    if (!(slope > 0)) return this->status_ = rule_status::no_information;
    if (!is_finite(step)) {
      ++this->counters_.left;
      return this->status_ = rule_status::not_converged;
    }
    const Real low = options.floors[0];
    const Real high = 1 - options.floors[1];
    Real first = alpha[0] + step;
    if (first < 0 || first > 1) ++this->counters_.left;
    if (form_ == newton_form::safeguarded) {
      if (first < low) first = (alpha[0] + low) / 2;
      if (first > high) first = (alpha[0] + high) / 2;
    }
    first = first < low ? low : first > high ? high : first;
    alpha[0] = first;
    alpha[1] = first == high ? options.floors[1] : 1 - first;
    return this->status_ = rule_status::updated;
  }

  /// Adds the batch that another state observed at the same fractions.
  PHIMIS_HOST_DEVICE void merge(const newton_raphson& other) noexcept {
    PHIMIS_EXPECTS(this->fractions_[0] == other.fractions_[0]);
    this->counters_.merge(other.counters_);
    sums theirs = other.sums_;
    if (theirs.reference > 0) {
      refer_to(theirs.reference);
      rescale(theirs, sums_.reference);
    }
    sums_.n += theirs.n;
    sums_.infinite = sums_.infinite || theirs.infinite;
    sums_.zeta += theirs.zeta;
    sums_.slope += theirs.slope;
    sums_.score += theirs.score;
    sums_.tilt += theirs.tilt;
    sums_.mixture += theirs.mixture;
    sums_.f += theirs.f;
  }

 private:
  /// Sums of one batch, with t in units of `reference`, the t of the largest |s| so far.
  struct sums {
    std::int64_t n = 0;
    bool infinite = false;
    Real reference = 0;
    Real zeta = 0;     // Σ (p_1 − p_2)/q s
    Real slope = 0;    // Σ (p_1 − p_2)²/(q p) t s'
    Real score = 0;    // Σ p/q s
    Real tilt = 0;     // Σ (p_1 − p_2)/q
    Real mixture = 0;  // Σ p/q
    Real f = 0;        // Σ f/q
  };

  PHIMIS_HOST_DEVICE Real exponent() const noexcept { return static_cast<Real>(divergence_.exponent()); }

  PHIMIS_HOST_DEVICE void refer_to(Real t) noexcept {
    if (!(sums_.reference > 0)) {
      sums_.reference = t;
    } else if (exponent() > 0 ? t > sums_.reference : t < sums_.reference) {
      rescale(sums_, t);
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
  sums sums_{};
};

}  // namespace phimis

#endif  // PHIMIS_CORE_NEWTON_RAPHSON_HPP
