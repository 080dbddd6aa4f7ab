// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_PAPERS_TSALLIS_WHOLE_LINE_HPP
#define PHIMIS_EXAMPLES_PAPERS_TSALLIS_WHOLE_LINE_HPP

#include "papers/tsallis_problems.hpp"

#include <phimis/analysis/problem.hpp>

#include <numbers>

/// The 1-D examples of the Tsallis paper with Gaussians on the whole line: f is 0 outside its domain, and some samples fall
/// there. What was measured before the library was written, of estimates that learn, was measured on these.
namespace papers {

/// range(): beyond it the densities are 0 to rounding.
template <class Paper>
struct whole_line {
  static double f(double x) { return Paper::domain().contains(x) ? Paper::f(x) : 0; }
};

struct whole_1 : whole_line<tsallis_1> {
  static constexpr const char* name = "T1";
  static phimis::interval range() { return {-10, 30}; }
  static auto techniques() { return phimis::technique_set(phimis::gaussian(2, 1), phimis::gaussian(8, 2)); }
  static phimis::analysis::problem<2> exact() { return {f, techniques(), range(), {0.01, 3.5 * std::numbers::pi}}; }
};

struct whole_2 : whole_line<tsallis_2> {
  static constexpr const char* name = "T2";
  static phimis::interval range() { return {-12, 12}; }
  static auto techniques() { return phimis::technique_set(phimis::gaussian(-1.5, 1), phimis::gaussian(1.5, 0.75)); }
  static phimis::analysis::problem<2> exact() { return {f, techniques(), range(), {-4, 4}}; }
};

/// As the paper has it: its densities end with the domain.
struct whole_3 : tsallis_3 {
  static phimis::analysis::problem<2> exact() { return {f, techniques(), domain()}; }
};

}  // namespace papers

#endif  // PHIMIS_EXAMPLES_PAPERS_TSALLIS_WHOLE_LINE_HPP
