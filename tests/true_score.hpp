// SPDX-License-Identifier: MIT
#ifndef PHIMIS_TESTS_TRUE_SCORE_HPP
#define PHIMIS_TESTS_TRUE_SCORE_HPP

#include "divergences.hpp"

#include <phimis/core/divergence.hpp>

#include <cmath>
#include <limits>

// Scores and their integrals in long double, with the sizes of their terms: what a minimum is held against.

using real = long double;

struct true_score {
  real value, slope;
  real size;  ///< of the terms of s, and its slope where it may cross zero
};

/// s(0) where it is finite.
template <class D>
real score_of_zero(const D&) {
  return 0;
}
inline real score_of_zero(const phimis::pearson_vajda&) { return -1; }
inline real score_of_zero(const phimis::total_variation&) { return -0.5L; }

/// Without the library: the power family by its power, others by algebra on φ.
template <class D>
true_score score_of(const D& divergence, real t) {
  if constexpr (phimis::has_exponent<D>::value) {
    const real b = divergence.exponent();
    if (b == 0) return {std::log(t), 1, std::fabs(std::log(t)) + 1};
    if (!(t > 0)) return {0, 0, 0};
    const real power = b == 1 ? t : b == 2 ? t * t : b == 0.5L ? std::sqrt(t) : std::pow(t, b);
    return {b > 0 ? power : -power, std::fabs(b) * power, power};
  } else if (t > 0) {
    const true_phi phi = true_phi_at(divergence, t);
    const real slope = t * t * phi.second;
    return {t * phi.first - phi.value, slope, 1 + std::fabs(t * phi.first) + std::fabs(phi.value) + slope};
  } else {
    return {score_of_zero(divergence), 0, 1};
  }
}
inline true_score score_of(const phimis::reversed<phimis::pearson_vajda>& divergence, real t) {
  if (!(t > 0)) return {0, 0, 0};  // a lost sample: no pdf reaches it
  const true_phi phi = true_phi_at(divergence.forward, 1 / t);
  return {-phi.first, phi.second / t, divergence.forward.k * std::pow(1 + 1 / t, divergence.forward.k - 1)};
}

/// −∫ s(u/p) dp: p φ(u/p) but for a multiple of p and for what does not depend on p.
template <class D>
real primitive(const D& divergence, real u, real p) {
  constexpr real infinity = std::numeric_limits<real>::infinity();
  if (!(u > 0)) return 0;
  const real t = p > 0 ? u / p : infinity;
  if constexpr (phimis::has_exponent<D>::value) {
    const real b = divergence.exponent();
    if (!(p > 0)) return b < 1 ? 0 : infinity;
    if (b == 1) return -u * std::log(p);
    if (b == 0) return -p * (std::log(t) + 1);
    return std::pow(u, b) * std::pow(p, 1 - b) / (b > 0 ? b - 1 : 1 - b);
  } else {
    return p > 0 ? p * (true_phi_at(divergence, t).value + score_of_zero(divergence)) : infinity;
  }
}
inline real primitive(const phimis::pearson_vajda& divergence, real u, real p) {
  if (divergence.k == 1) return std::fabs(u - p) - p;  // finite where p = 0
  if (!(p > 0)) return u > 0 ? std::numeric_limits<real>::infinity() : 0;
  return p * (true_phi_at(divergence, u / p).value + score_of_zero(divergence));
}
inline real primitive(const phimis::total_variation&, real u, real p) { return (std::fabs(u - p) - p) / 2; }
inline real primitive(const phimis::reversed<phimis::pearson_vajda>& divergence, real u, real p) {
  if (!(u > 0)) return 0;
  const real lost = divergence.forward.k == 1 ? p : 0;  // total variation has a finite s(0)
  return u * true_phi_at(divergence.forward, p / u).value - lost;
}

/// Over how many decades, up and down, f, pdfs and q may be wide such that numbers stay doubles: 30, or fewer where
///
///     s = −t^β, β < −1   1/t³ of numbers from 1e-120 to 1e120 is no double;
///     s = t^β, β < ½     a fraction is the 1/β-th power of a ratio of densities;
///     s = log t          it is the exponential function of one;
///     others             t² − 1 is t² but for what is rounded off.
template <class Divergence>
double decades_of(const Divergence& divergence) {
  if constexpr (phimis::has_exponent<Divergence>::value) {
    const double beta = divergence.exponent();
    return beta == 0 ? 1 : beta < -1 ? -30 / beta : beta > 0 && beta < 0.5 ? 60 * beta : 30;
  } else {
    return 3;
  }
}

#endif  // PHIMIS_TESTS_TRUE_SCORE_HPP
