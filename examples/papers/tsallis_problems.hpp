// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_PAPERS_TSALLIS_PROBLEMS_HPP
#define PHIMIS_EXAMPLES_PAPERS_TSALLIS_PROBLEMS_HPP

#include <phimis/phimis.hpp>

#include <cmath>
#include <numbers>

/// The three 1-D examples of Sbert & Szirmay-Kalos, "Robust Multiple Importance Sampling with Tsallis φ-Divergences",
/// Entropy 24 (2022) 1240, Sec. 7.
///
/// - Every pdf is truncated to the domain and renormalised there; the Gaussians inside an integrand are not. The
///   paper does not say so, but no other reading gives its numbers.
namespace papers {

inline double normal_pdf(double x, double mean, double sigma) {
  const double z = (x - mean) / sigma;
  return std::exp(-z * z / 2) / (sigma * std::sqrt(2 * std::numbers::pi));
}

/// Eq. 33.
struct tsallis_1 {
  static constexpr const char* name = "T1";
  static phimis::interval domain() { return {0.01, 3.5 * std::numbers::pi}; }
  static double f(double x) { return std::sqrt(x) + std::sin(x); }
  static auto techniques() {
    return phimis::technique_set(phimis::gaussian(2, 1, domain()), phimis::gaussian(8, 2, domain()));
  }
};

/// Eq. 34.
struct tsallis_2 {
  static constexpr const char* name = "T2";
  static phimis::interval domain() { return {-4, 4}; }
  static double f(double x) { return normal_pdf(x, -1.5, 1) + 2 * normal_pdf(x, 1.5, 0.75); }
  static auto techniques() {
    return phimis::technique_set(phimis::gaussian(-1.5, 1, domain()), phimis::gaussian(1.5, 0.75, domain()));
  }
};

/// Eq. 35.
struct tsallis_3 {
  static constexpr const char* name = "T3";
  static phimis::interval domain() { return {0.01, std::numbers::pi / 2}; }
  static double f(double x) { return std::sqrt(x) + std::sin(x); }
  static auto techniques() {
    return phimis::technique_set(phimis::density([](double x) { return 2 - x; }, domain()),
                                 phimis::density([](double x) { return std::sin(x) * std::sin(x); }, domain()));
  }
};

}  // namespace papers

#endif  // PHIMIS_EXAMPLES_PAPERS_TSALLIS_PROBLEMS_HPP
