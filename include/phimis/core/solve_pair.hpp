// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_SOLVE_PAIR_HPP
#define PHIMIS_CORE_SOLVE_PAIR_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/finite.hpp>
#include <phimis/core/limits.hpp>
#include <phimis/core/pair_sums.hpp>

#include <cmath>

namespace phimis {

/// Two fractions that sum to one, each precise to its own last digit: 1 − α is never formed where α is near 1.
struct pair_fractions {
  double first;
  double second;
};

/// A root of ζ on the segment between two pairs of fractions, and how well it is one.
struct pair_solution {
  pair_fractions alpha;
  double residual;  ///< |ζ|/λ in the interior; 0 at an end that ζ points out of
  bool bracketed;   ///< ζ changes sign within the last digit of alpha
  int evaluations;
  double lambda;  ///< at alpha
};

namespace detail {

PHIMIS_HOST_DEVICE inline pair_fractions shifted(const pair_fractions& from, double step) noexcept {
  return {from.first + step, from.second - step};
}

PHIMIS_HOST_DEVICE inline double smaller(const pair_fractions& alpha) noexcept {
  return alpha.first < alpha.second ? alpha.first : alpha.second;
}

/// How far b lies above a, from whichever component is small.
PHIMIS_HOST_DEVICE inline double distance(const pair_fractions& a, const pair_fractions& b) noexcept {
  return b.second < 0.5 ? a.second - b.second : b.first - a.first;
}

/// A fraction between two others whose orders of magnitude differ: at 0 there is none, and some decades are gone down.
PHIMIS_HOST_DEVICE inline double between_orders(double small, double large) noexcept {
  return small > 0 ? std::sqrt(small) * std::sqrt(large) : 1e-4 * large;
}

/// A point between a and b that halves the interval, in its logarithm where it spans orders of magnitude.
PHIMIS_HOST_DEVICE inline pair_fractions between(const pair_fractions& a, const pair_fractions& b) noexcept {
  if (b.first <= 0.5 && a.first < 1e-3 * b.first) {
    const double middle = between_orders(a.first, b.first);
    return {middle, 1 - middle};
  }
  if (a.second <= 0.5 && b.second < 1e-3 * a.second) {
    const double middle = between_orders(b.second, a.second);
    return {1 - middle, middle};
  }
  return {(a.first + b.first) / 2, (a.second + b.second) / 2};
}

/// Newton's step of α_1 towards ζ = 0; not finite where there is none.
///
/// Where s is a power, ±t^β, it is that of log(G_1/G_2) in log(α_1/α_2), which is nearly linear where techniques share little:
/// G_1 = λ + α_2 ζ, G_2 = λ − α_1 ζ and λ' = (1 − β) ζ, up to the sign of s, so that no other sum is needed.
PHIMIS_HOST_DEVICE inline double newton_step(const pair_fractions& alpha, const pair_sums& at) noexcept {
  const double plain = at.zeta / at.slope;
  const double beta = at.exponent;
  if (beta == 0) return plain;
  const double z = beta < 0 ? -at.zeta : at.zeta;
  const double dz = beta < 0 ? at.slope : -at.slope;
  const double g1 = at.lambda + alpha.second * z;
  const double g2 = at.lambda - alpha.first * z;
  const double tilt = (alpha.second * dz - beta * z) / g1 + (alpha.first * dz + beta * z) / g2;
  const double rate = alpha.first * alpha.second * tilt;  // of log(G_1/G_2)
  if (!(g1 > 0) || !(g2 > 0) || !(beta < 0 ? rate > 0 : rate < 0)) return plain;
  const double grown = std::expm1(-std::log1p(z / g2) / rate);
  const double step = alpha.first * alpha.second * grown / (1 + alpha.first * grown);
  // Where both say that next to nothing is left of a fraction, its end is to be tried.
  const double left = plain > 0 ? alpha.second : alpha.first;
  const bool to_the_end = std::fabs(plain) >= left && left - std::fabs(step) <= 0.01 * left;
  return is_finite(step) && !to_the_end ? step : plain;
}

}  // namespace detail

/// Whether ζ falls everywhere, so that it has one root at most.
enum class objective { convex, any };

/// The root of ζ between two ends, by Newton's method inside a bracket that shrinks with every sign of ζ.
///
/// evaluate(pair_fractions) returns pair_sums. Where ζ decreases from + to − in α_1 the root is the minimiser. Of an
/// objective that is not convex it is a local minimum downhill of the start: the end is approached in steps of at most
/// an eighth of the way, and the first change of sign is taken. An end is the answer where ζ points out of it. A ζ that
/// is not finite pushes away from the nearer end.
///
/// \param epsilon    the rounding of α and of the sums
/// \param tolerance  of the residual, where that of rounding is not wanted
///
/// Requires low.first <= start.first <= high.first.   Errors none; the residual tells.
/// Cost     2 to 4 evaluations from a near start, 4 to 10 from most others, 20 where Newton leaves the segment; at most
///          150.
template <class Evaluate>
[[gnu::noinline]] PHIMIS_HOST_DEVICE pair_solution solve_pair(const Evaluate& evaluate, pair_fractions low,
                                                              pair_fractions high, pair_fractions start,
                                                              double epsilon, objective kind = objective::convex,
                                                              double tolerance = 0) noexcept {
  constexpr int most = 150;
  const double enough = tolerance > epsilon / 8 ? tolerance : epsilon / 8;
  bool low_known = false;  // ζ(low) > 0 was seen
  bool high_known = false;
  double last_step = 2;
  pair_fractions alpha = start;
  double least = -1;  // |ζ| of the best
  pair_solution best{start, 0, false, 0, 0};
  while (best.evaluations < most) {
    const pair_sums at = evaluate(alpha);
    ++best.evaluations;
    const bool finite = is_finite(at.zeta) && is_finite(at.lambda);
    const double zeta = finite ? at.zeta : alpha.first < alpha.second ? 1 : -1;
    const double size = finite ? std::fabs(zeta) : 1 / smallest_normal<double>;
    const double residual = !finite ? 1 : at.lambda > 0 ? size / at.lambda : size;
    if (least < 0 || size <= least) {
      least = size;
      best.alpha = alpha;
      best.residual = residual;
      best.lambda = at.lambda;
    }
    // Where ζ is rounding of its sums, here or over the whole segment, no other α is better.
    const double range = size + std::fabs(at.slope);
    if (finite && (size <= enough * at.lambda || range <= 16 * epsilon * at.lambda)) {
      best.alpha = alpha;
      best.residual = residual;
      break;
    }

    // An end where ζ points outwards is the optimum.
    if ((zeta < 0 && !low_known && detail::distance(low, alpha) <= 0) ||
        (zeta > 0 && !high_known && detail::distance(alpha, high) <= 0)) {
      best.alpha = alpha;
      best.residual = 0;
      break;
    }
    (zeta > 0 ? low : high) = alpha;
    (zeta > 0 ? low_known : high_known) = true;
    const double resolution = epsilon * detail::smaller(alpha);
    best.bracketed = low_known && high_known && detail::distance(low, high) <= resolution;
    if (best.bracketed) {
      // On a step of ζ the size says nothing about the distance.
      best.alpha = alpha;
      best.residual = residual;
      break;
    }

    const double step = detail::newton_step(alpha, at);
    const bool newton = finite && at.slope > 0 && is_finite(at.slope) && is_finite(step);
    if (newton && std::fabs(step) <= resolution) break;
    // Newton's step is taken while it halves and stays inside; otherwise an unseen end, then the middle.
    pair_fractions next = detail::shifted(alpha, newton ? step : 0);
    const bool inside = newton && detail::distance(low, next) > 0 && detail::distance(next, high) > 0;
    const bool bracket = zeta > 0 ? high_known : low_known;
    if (kind == objective::any && !bracket) {
      const pair_fractions& end = zeta > 0 ? high : low;
      const double way = zeta > 0 ? detail::distance(alpha, high) : detail::distance(low, alpha);
      if (way <= 1e-3) {
        next = end;
      } else if (!inside || std::fabs(step) > way / 8 || std::fabs(step) > last_step) {
        // Steps that grow are those of a pole: Newton's method would leave it by a constant factor at a time.
        next = detail::shifted(alpha, zeta > 0 ? way / 8 : -way / 8);
      }
    } else if (!inside || std::fabs(step) > last_step / 2) {
      next = bracket ? detail::between(low, high) : zeta > 0 ? high : low;
    }
    last_step = std::fabs(next.first - alpha.first);
    alpha = next;
  }
  return best;
}

}  // namespace phimis

#endif  // PHIMIS_CORE_SOLVE_PAIR_HPP
