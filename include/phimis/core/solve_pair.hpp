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

    const double step = at.zeta / at.slope;
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
      } else if (!inside || std::fabs(step) > way / 8) {
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
