// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_PAPERS_LINEAR_PROBLEMS_HPP
#define PHIMIS_EXAMPLES_PAPERS_LINEAR_PROBLEMS_HPP

#include <papers/tsallis_problems.hpp>
#include <papers/variance_problems.hpp>

#include <phimis/phimis.hpp>

/// The 1-D examples of Sbert & Szirmay-Kalos, "A linear heuristic for multiple importance sampling", EURASIP J. Adv.
/// Signal Process. 2023, 31, Sec. 6.1. Examples 1 to 3 are those of the Tsallis paper, with the same convention.
namespace papers {

/// Eq. 23.
struct linear_4 {
  static constexpr const char* name = "L4";
  static phimis::interval domain() { return {-3, 3}; }
  static double f(double x) {
    return normal_pdf(x, -1.8, 1) + 2 * normal_pdf(x, 1.5, 0.75) + 3 * normal_pdf(x, -0.5, 0.5);
  }
  static auto techniques() {
    return phimis::technique_set(phimis::gaussian(-1.5, 1, domain()), phimis::gaussian(1.5, 0.75, domain()),
                                 phimis::gaussian(-0.5, 1, domain()));
  }
};

/// Eq. 24.
struct linear_5 {
  static constexpr const char* name = "L5";
  static phimis::interval domain() { return {-3, 3}; }
  static double f(double x) {
    return normal_pdf(x, -1.8, 1) + 6 * normal_pdf(x, 1.5, 0.75) + 3 * normal_pdf(x, -0.5, 0.5) +
           3 * normal_pdf(x, 0.5, 0.5);
  }
  static auto techniques() {
    return phimis::technique_set(phimis::gaussian(-1.5, 1, domain()), phimis::gaussian(1.5, 0.75, domain()),
                                 phimis::gaussian(-0.5, 1, domain()), phimis::gaussian(0.5, 1, domain()));
  }
};

/// Eq. 25: example 2 of the variance paper.
///
/// - The lower limit is 3/(2π), not 3π/2 as printed, which is above the upper one.
struct linear_6 : variance_2 {
  static constexpr const char* name = "L6";
};

}  // namespace papers

#endif  // PHIMIS_EXAMPLES_PAPERS_LINEAR_PROBLEMS_HPP
