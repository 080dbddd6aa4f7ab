// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_DIVERGENCE_HPP
#define PHIMIS_CORE_DIVERGENCE_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/finite.hpp>
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

/// Total variation.  D(g, p) = ½ ∫ |g − p| dx,  φ(t) = ½ |t − 1|
///
/// Source T Sec. 5.4, Eq. 26. Its score is a step: two techniques are bracketed, more are solved with the kink rounded off
/// to √((t − 1)² + ε²), ε → 0.
struct total_variation {
  static constexpr bool kinked = true;
  PHIMIS_HOST_DEVICE static constexpr bool smooth() noexcept { return false; }
  template <class Real>
  PHIMIS_HOST_DEVICE static phi_taylor<Real> taylor(Real t, Real rounded = 0) noexcept {
    const Real distance = std::hypot(t - 1, rounded);
    if (!(distance > 0)) return {0, 0, 0};
    const Real sine = rounded / distance;
    return {distance / 2, (t - 1) / distance / 2, sine * sine / distance / 2};
  }
  /// t φ' − φ, which would cancel at large t.
  template <class Real>
  PHIMIS_HOST_DEVICE static score<Real> score_of(Real t, Real rounded = 0) noexcept {
    const Real distance = std::hypot(t - 1, rounded);
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
    const Real distance = std::hypot(t - 1, rounded);
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
    const Real distance = std::hypot(t - 1, rounded);
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

/// A divergence whose kink at t = 1 is rounded off within `width`.
template <class Divergence>
struct rounded_off {
  Divergence divergence;
  double width;

  template <class Real>
  PHIMIS_HOST_DEVICE phi_taylor<Real> taylor(Real t) const noexcept {
    return divergence.taylor(t, static_cast<Real>(width));
  }
  template <class Real>
  PHIMIS_HOST_DEVICE score<Real> score_of(Real t) const noexcept {
    return divergence.score_of(t, static_cast<Real>(width));
  }
};

template <class Divergence>
PHIMIS_HOST_DEVICE rounded_off<Divergence> round_off(const Divergence& divergence, double width) noexcept {
  return {divergence, width};
}
template <class Divergence>
PHIMIS_HOST_DEVICE reversed<rounded_off<Divergence>> round_off(const reversed<Divergence>& divergence,
                                                               double width) noexcept {
  return {{divergence.forward, width}};
}

/// Whether a divergence has a kink that has to be rounded off.
template <class Divergence>
PHIMIS_HOST_DEVICE auto has_sharp_kink(const Divergence& divergence) noexcept -> decltype(divergence.smooth()) {
  return !divergence.smooth();
}
template <class Divergence>
PHIMIS_HOST_DEVICE auto has_sharp_kink(const reversed<Divergence>& divergence) noexcept
    -> decltype(divergence.forward.smooth()) {
  return !divergence.forward.smooth();
}

namespace detail {

template <class Divergence, class = void>
struct can_round_off : std::false_type {};
template <class Divergence>
struct can_round_off<Divergence, std::void_t<decltype(has_sharp_kink(std::declval<const Divergence&>()))>>
    : std::true_type {};

/// A slope at a rounded kink is no scale of a score.
template <class Divergence>
struct is_rounded_off : std::false_type {};
template <class Divergence>
struct is_rounded_off<rounded_off<Divergence>> : std::true_type {};
template <class Divergence>
struct is_rounded_off<reversed<rounded_off<Divergence>>> : std::true_type {};

template <class Divergence, class = void>
struct is_kinked : std::false_type {};
template <class Divergence>
struct is_kinked<Divergence, std::enable_if_t<Divergence::kinked>> : std::true_type {};
template <class Divergence>
struct is_kinked<reversed<Divergence>> : is_kinked<Divergence> {};

template <class Divergence, class = void>
struct has_own_score : std::false_type {};
template <class Divergence>
struct has_own_score<Divergence, std::void_t<decltype(std::declval<const Divergence&>().score_of(1.0))>>
    : std::true_type {};

template <class Divergence, class Real>
PHIMIS_HOST_DEVICE score<Real> forward_score(const Divergence& divergence, Real t) noexcept {
  if constexpr (has_own_score<Divergence>::value) {
    if (t > 0) return divergence.score_of(t);
  }
  const phi_taylor<Real> phi = divergence.taylor(t);
  if (!(t > 0)) return {-phi.value, 0};                      // t φ'(t) → 0 wherever φ(0) is finite
  return {t * phi.first - phi.value, t * (t * phi.second)};  // t² may be infinite where φ is flat
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

#endif  // PHIMIS_CORE_DIVERGENCE_HPP
