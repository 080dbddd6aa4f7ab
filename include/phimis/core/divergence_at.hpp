// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_DIVERGENCE_AT_HPP
#define PHIMIS_CORE_DIVERGENCE_AT_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/divergence.hpp>
#include <phimis/core/finite.hpp>
#include <phimis/core/limits.hpp>

#include <cmath>
#include <type_traits>
#include <utility>

namespace phimis {

namespace detail {

template <class Divergence, class = void>
struct has_own_score : std::false_type {};
template <class Divergence>
struct has_own_score<Divergence, std::void_t<decltype(std::declval<const Divergence&>().score_of(1.0))>>
    : std::true_type {};

/// No fraction reaches a row with a larger t. Its square is finite: -ffast-math takes t (t φ'') for t² φ'', ∞ · 0.
template <class Real>
inline constexpr Real largest_ratio = sizeof(Real) == 8 ? Real(1e150) : Real(1e18);

template <class Divergence, class Real>
PHIMIS_HOST_DEVICE score<Real> forward_score(const Divergence& divergence, Real t) noexcept {
  if (t > largest_ratio<Real>) t = largest_ratio<Real>;
  if constexpr (has_own_score<Divergence>::value) {
    if (t > 0) return divergence.score_of(t);
  }
  const phi_taylor<Real> phi = divergence.taylor(t);
  if (!(t > 0)) return {-phi.value, 0};  // t φ'(t) → 0 wherever φ(0) is finite
  return {t * phi.first - phi.value, t * t * phi.second};
}

/// The slope of φ at infinity, which is −s(0) of the reversed divergence; infinite where it still grows over 14 decades.
template <class Divergence>
PHIMIS_HOST_DEVICE double slope_at_infinity(const Divergence& divergence) noexcept {
  const double near = divergence.taylor(1e14).first;
  const double far = divergence.taylor(1e28).first;
  return is_finite(far) && std::fabs(far - near) <= 1e-6 * (1 + std::fabs(far)) ? far : infinity<double>;
}

template <class Divergence, class Real>
PHIMIS_HOST_DEVICE score<Real> reversed_score(const Divergence& divergence, Real t) noexcept {
  if (!(t > 0)) return {static_cast<Real>(-slope_at_infinity(divergence)), 0};
  const phi_taylor<Real> phi = divergence.taylor(1 / t);
  return {-phi.first, phi.second / t};
}

}  // namespace detail

/// Score of a divergence at t = f/p(α) ≥ 0; t = g/p(α), g = f/μ, where it is not of the power family.
template <class Divergence, class Real>
PHIMIS_HOST_DEVICE score<Real> score_at(const Divergence& divergence, Real t) noexcept {
  if constexpr (has_exponent<Divergence>::value) {
    return power_score(t, static_cast<Real>(divergence.exponent()));
  } else {
    return detail::forward_score(divergence, t);
  }
}
template <class Divergence, class Real>
PHIMIS_HOST_DEVICE score<Real> score_at(const reversed<Divergence>& divergence, Real t) noexcept {
  if constexpr (has_exponent<Divergence>::value) {
    return power_score(t, static_cast<Real>(divergence.exponent()));
  } else {
    return detail::reversed_score(divergence.forward, t);
  }
}

/// s(0) where it is finite, else 0: what is subtracted from a score, so that lost samples, f = 0 where every pdf is 0,
/// are worth nothing.
template <class Divergence>
PHIMIS_HOST_DEVICE double score_at_zero(const Divergence& divergence) noexcept {
  if constexpr (has_exponent<Divergence>::value) {
    return 0;
  } else {
    const double value = score_at(divergence, 0.0).value;
    return is_finite(value) ? value : 0;
  }
}

/// s of a prior at the share a of a technique that has the share π of the start: one sample of f = mean where only that
/// technique has density. s(0) where π is 0, and 0 where that is infinite: such a technique is to have no fraction.
template <class Divergence>
PHIMIS_HOST_DEVICE score<double> prior_score(const Divergence& divergence, double mean, double pi,
                                             double a) noexcept {
  if (!(pi > 0)) return {score_at_zero(divergence), 0};
  const double t = mean * pi / a;
  constexpr double largest = 1e308;
  return score_at(divergence, a > 0 && t > largest ? largest : t);  // a fraction may be subnormal
}

/// A unit of f in which the mean, which is f at a prior's samples, is at most 1, or at least 1 where scores grow as t falls:
/// powers of a mean of 1e300, beside one sample that weighs so much, are no numbers. Left alone where Real has no such unit.
template <class Real>
PHIMIS_HOST_DEVICE void limit_mean(double& unit, double& mean, bool falls) noexcept {
  if (falls ? mean >= 1 : mean <= 1) return;
  if (!is_positive_as<Real>(unit / mean)) return;
  unit /= mean;
  mean = 1;
}

/// What sums over rows are scaled by beside a prior, and the prior, too: scores times a prior of 1e308 are no numbers.
PHIMIS_HOST_DEVICE inline double scale_beside(double prior) noexcept {
  constexpr double largest = 1e200;
  return prior > largest ? largest / prior : 1;
}

/// φ(t) of a divergence at t = g/p(α) ≥ 0; the divergence is ∫ p φ(g/p) dx.
template <class Divergence, class Real>
PHIMIS_HOST_DEVICE Real phi_at(const Divergence& divergence, Real t) noexcept {
  if constexpr (has_exponent<Divergence>::value) {
    return divergence.phi(t);
  } else {
    return divergence.taylor(t).value;
  }
}
template <class Divergence, class Real>
PHIMIS_HOST_DEVICE Real phi_at(const reversed<Divergence>& divergence, Real t) noexcept {
  if (t > 0) return t * phi_at(divergence.forward, 1 / t);
  if constexpr (has_exponent<Divergence>::value) {
    // φ is a multiple of the Tsallis divergence's, whose slope at infinity is 1/(1 − γ) for γ < 1.
    const double gamma = divergence.forward.exponent();
    const double scale = divergence.forward.phi(2.0) / tsallis{gamma}.phi(2.0);
    return gamma < 1 ? static_cast<Real>(scale / (1 - gamma)) : infinity<Real>;
  } else {
    return static_cast<Real>(detail::slope_at_infinity(divergence.forward));
  }
}

/// True where D is infinite as soon as f = 0 < p on a set that p can reach: some reversed divergences.
///
/// A rule then reports `rule_status::infinite_divergence` and leaves its fractions.
template <class Divergence>
PHIMIS_HOST_DEVICE bool infinite_at_zero(const Divergence& divergence) noexcept {
  if constexpr (has_exponent<Divergence>::value || std::is_same<Divergence, multi_sample_variance>::value) {
    return false;
  } else {
    return !is_finite(divergence.taylor(0.0).value);
  }
}
template <class Divergence>
PHIMIS_HOST_DEVICE bool infinite_at_zero(const reversed<Divergence>& divergence) noexcept {
  if constexpr (has_exponent<Divergence>::value) {
    return divergence.exponent() <= 0;
  } else {
    return !is_finite(detail::slope_at_infinity(divergence.forward));
  }
}

}  // namespace phimis

#endif  // PHIMIS_CORE_DIVERGENCE_AT_HPP
