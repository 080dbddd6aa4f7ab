// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_PAPERS_HIDDEN_LOBE_HPP
#define PHIMIS_EXAMPLES_PAPERS_HIDDEN_LOBE_HPP

#include <phimis/analysis/problem.hpp>
#include <phimis/phimis.hpp>

#include <cmath>

namespace papers {

/// Of no paper: two pdfs that differ by 1 %, and by a lobe of a thousandth of the domain that half of the runs of 126 samples do
/// not meet. Control variates that trust such samples are ruined.
///
///     p_1 = 1,   p_2 = .99 (1 + .01 (2x − 1)) + .01 · 1000 on [.5, .501],   f = x² + .2 sin 20x
struct hidden_lobe {
  static constexpr const char* name = "lobe";
  static constexpr double share = 0.01, tilt = 0.01, lower = 0.5, width = 1e-3;

  struct uniform {
    double pdf(double x) const { return x >= 0 && x <= 1 ? 1 : 0; }
    template <class Next>
    double sample(Next&& next) const {
      return next();
    }
  };
  struct lobed {
    double pdf(double x) const {
      if (!(x >= 0 && x <= 1)) return 0;
      return (1 - share) * (1 + tilt * (2 * x - 1)) + (x >= lower && x < lower + width ? share / width : 0);
    }
    template <class Next>
    double sample(Next&& next) const {
      if (next() < share) return lower + width * next();
      const double b = 1 - tilt;  // tilt x² + b x = u
      return (std::sqrt(b * b + 4 * tilt * next()) - b) / (2 * tilt);
    }
  };

  static double f(double x) { return x * x + 0.2 * std::sin(20 * x); }
  static phimis::interval domain() { return {0, 1}; }
  static auto techniques() { return phimis::technique_set(uniform{}, lobed{}); }
  static auto exact() { return phimis::analysis::problem(f, techniques(), domain(), {lower, lower + width}); }
};

}  // namespace papers

#endif  // PHIMIS_EXAMPLES_PAPERS_HIDDEN_LOBE_HPP
