// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_DIVERGENCE_HPP
#define PHIMIS_CORE_DIVERGENCE_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/limits.hpp>

#include <cmath>
#include <type_traits>
#include <utility>

namespace phimis {

/// Score s(t) of a divergence and its logarithmic slope t s'(t), at t = f/p(α).
///
/// The fractions are optimal where E_{p_k}[s(t)] is the same for every technique above its floor, and not larger for
/// one at its floor. s is nondecreasing because φ is convex.
///
///     D_φ(g, p):  s = t φ'(t) − φ(t),   t s' = t² φ''(t)
///     D_φ(p, g):  s = −φ'(1/t),         t s' = φ''(1/t) / t
///
/// Source T Eqs. 16, 18. A constant factor of s changes no optimum and is dropped. A constant term changes none between
/// normalised densities; where a pdf is defective it must be such that s(0) = 0, see `score_at_zero`.
template <class Real>
struct score {
  Real value;
  Real slope;
};

/// Score of the power family: the γ-moments of Tsallis divergences, forward (β = γ) and reversed (β = 1 − γ).
///
///     β > 0: s = t^β     β = 0: s = log t     β < 0: s = −t^β
///
/// Source T Eq. 25 and Sec. 5.3; β = 0 is the reversed Kullback–Leibler divergence, which Sec. 5.3 leaves out.
template <class Real>
PHIMIS_HOST_DEVICE score<Real> power_score(Real t, Real beta) noexcept {
  if (beta == Real(1)) return {t, t};
  if (beta == Real(2)) return {t * t, 2 * t * t};
  if (beta == Real(0.5)) return {std::sqrt(t), std::sqrt(t) / 2};
  if (beta == Real(0)) return {std::log(t), Real(1)};
  const Real power = std::pow(t, beta);
  return beta > 0 ? score<Real>{power, beta * power} : score<Real>{-power, -beta * power};
}

/// Tsallis divergence of order γ > 0.
///
///     D_γ(g, p) = (∫ g^γ p^{1−γ} dx − 1) / (γ − 1),   φ(t) = (t^γ − t) / (γ − 1),   s = t^γ
///
/// Source T Eqs. 21, 25.
/// - T prints φ = (t^γ − 1)/(γ − 1). The two differ by a multiple of t − 1, which changes no divergence between
///   densities; this one tends to t log t as γ → 1.
struct tsallis {
  double gamma = 1;

  PHIMIS_HOST_DEVICE constexpr double exponent() const noexcept { return gamma; }

  template <class Real>
  PHIMIS_HOST_DEVICE Real phi(Real t) const noexcept {
    if (!(t > 0)) return 0;
    const Real order = static_cast<Real>(gamma) - 1;
    return order == 0 ? t * std::log(t) : t * std::expm1(order * std::log(t)) / order;
  }
};

/// Kullback–Leibler divergence.  D(g, p) = ∫ g log(g/p) dx,  φ(t) = t log t,  s = t
///
/// Source T Eq. 12.
struct kullback_leibler {
  PHIMIS_HOST_DEVICE static constexpr double exponent() noexcept { return 1; }
  template <class Real>
  PHIMIS_HOST_DEVICE static Real phi(Real t) noexcept {
    return tsallis{exponent()}.phi(t);
  }
};

/// χ² divergence.  D(g, p) = ∫ g²/p dx − 1,  s = t²
///
/// Source T Eq. 22.
struct chi_squared {
  PHIMIS_HOST_DEVICE static constexpr double exponent() noexcept { return 2; }
  template <class Real>
  PHIMIS_HOST_DEVICE static Real phi(Real t) noexcept {
    return tsallis{exponent()}.phi(t);
  }
};

/// Squared Hellinger distance.  D(g, p) = 1 − ∫ √(g p) dx,  s = √t
///
/// Source T Eq. 24: half of the Tsallis divergence of order ½.
struct hellinger {
  PHIMIS_HOST_DEVICE static constexpr double exponent() noexcept { return 0.5; }
  template <class Real>
  PHIMIS_HOST_DEVICE static Real phi(Real t) noexcept {
    return tsallis{exponent()}.phi(t) / 2;
  }
};

/// Variance V[ℱ] of the one-sample estimator, N = 1.  V[ℱ] = ∫ f²/p dx − μ² = μ² χ²(f/μ, p),  s = t²
///
/// Source T Eqs. 9, 13.
struct one_sample_variance : chi_squared {};

/// Variance V[F] of the multi-sample estimator, N = 1, with the balance heuristic.
///
///     V[F] = ∫ f²/p dx − Σ_k α_k μ'_k²,   μ'_k = ∫ f p_k/p dx
///
/// Stationary where σ'_j² + 2μ'_j² − 2∫ f p_j (Σ_k α_k μ'_k p_k)/p² dx is the same for every j above its floor. It has
/// no score and is not convex in general: a minimiser finds a local minimum and says so.
///
/// Source T Eq. 7.
/// - The condition printed as Eqs. 43, 67, 68 of Sbert, Havran & Szirmay-Kalos 2016 is wrong; this is the right one.
struct multi_sample_variance {};

/// φ(t) and its first two derivatives.
template <class Real>
struct phi_taylor {
  Real value;
  Real first;
  Real second;
};

namespace detail {

/// √((t − 1)² + rounded²). Under -ffast-math std::hypot squares t, which overflows where no fraction reaches a row.
template <class Real>
PHIMIS_HOST_DEVICE Real rounded_distance(Real t, Real rounded) noexcept {
  const Real off = t < 1 ? 1 - t : t - 1;
  const Real larger = off < rounded ? rounded : off;
  if (!(larger > 0)) return 0;
  const Real ratio = (off < rounded ? off : rounded) / larger;
  return larger * std::sqrt(1 + ratio * ratio);
}

}  // namespace detail

/// Total variation.  D(g, p) = ½ ∫ |g − p| dx,  φ(t) = ½ |t − 1|
///
/// Source T Sec. 5.4, Eq. 26. Its score is a step: two techniques are bracketed, more are solved with the kink rounded off
/// to √((t − 1)² + ε²), ε → 0.
struct total_variation {
  static constexpr bool kinked = true;
  PHIMIS_HOST_DEVICE static constexpr bool smooth() noexcept { return false; }
  template <class Real>
  PHIMIS_HOST_DEVICE static phi_taylor<Real> taylor(Real t, Real rounded = 0) noexcept {
    const Real distance = detail::rounded_distance(t, rounded);
    if (!(distance > 0)) return {0, 0, 0};
    const Real sine = rounded / distance;
    return {distance / 2, (t - 1) / distance / 2, sine * sine / distance / 2};
  }
  /// t φ' − φ, which would cancel at large t.
  template <class Real>
  PHIMIS_HOST_DEVICE static score<Real> score_of(Real t, Real rounded = 0) noexcept {
    const Real distance = detail::rounded_distance(t, rounded);
    if (!(distance > 0)) return {0, 0};
    return {((t - 1) - rounded * rounded) / distance / 2, t * (t * taylor(t, rounded).second)};
  }
};

/// Pearson–Vajda divergence of order k ≥ 1.  D(g, p) = ∫ |g − p|^k / p^{k−1} dx,  φ(t) = |t − 1|^k
///
/// Source T Sec. 5.4. For even k it is χ_P^k; for odd k, (t − 1)^k is not convex and |χ|_P^k is meant.
/// - T prints g^{k−1} as the denominator: with φ(t) and Eq. 11 that is `reversed<pearson_vajda>`.
struct pearson_vajda {
  double k = 2;
  static constexpr bool kinked = true;
  PHIMIS_HOST_DEVICE constexpr bool smooth() const noexcept { return k >= 2; }
  template <class Real>
  PHIMIS_HOST_DEVICE phi_taylor<Real> taylor(Real t, Real rounded = 0) const noexcept {
    const Real order = static_cast<Real>(k);
    const Real distance = detail::rounded_distance(t, rounded);
    if (!(distance > 0)) return {0, 0, order == 2 ? Real(2) : order < 2 && order > 1 ? infinity<Real> : Real(0)};
    const Real cosine = (t - 1) / distance;
    const Real sine = rounded / distance;
    const Real curvature = (order - 1) * cosine * cosine + sine * sine;
    return {std::pow(distance, order), cosine * order * std::pow(distance, order - 1),
            order * curvature * std::pow(distance, order - 2)};
  }
  /// t φ' − φ, which would cancel at large t.
  template <class Real>
  PHIMIS_HOST_DEVICE score<Real> score_of(Real t, Real rounded = 0) const noexcept {
    const Real order = static_cast<Real>(k);
    const Real distance = detail::rounded_distance(t, rounded);
    if (!(distance > 0)) return {0, 0};
    const Real cosine = (t - 1) / distance;
    const Real sine = rounded / distance;
    return {std::pow(distance, order - 1) * (cosine * ((order - 1) * t + 1) - sine * rounded),
            t * (t * taylor(t, rounded).second)};
  }
};

/// True for the divergences whose score is a power of t: those with a member `exponent()`. They need no estimate
/// of μ, but for exponent 0.
template <class Divergence, class = void>
struct has_exponent : std::false_type {};
template <class Divergence>
struct has_exponent<Divergence, std::void_t<decltype(std::declval<const Divergence&>().exponent())>>
    : std::true_type {};

/// The same divergence with its arguments swapped: D_φ(p, g) in place of D_φ(g, p).
///
/// It is the φ-divergence of φ*(t) = t φ(1/t).
///
/// Source T Sec. 5.1, Eqs. 17, 18.
template <class Divergence>
struct reversed {
  Divergence forward{};

  /// 1 − γ for the power family.
  template <class D = Divergence>
  PHIMIS_HOST_DEVICE constexpr auto exponent() const noexcept -> std::enable_if_t<has_exponent<D>::value, double> {
    return 1 - forward.exponent();
  }
};
template <class Divergence>
reversed(Divergence) -> reversed<Divergence>;

}  // namespace phimis

#endif  // PHIMIS_CORE_DIVERGENCE_HPP
