// SPDX-License-Identifier: MIT
#ifndef PHIMIS_TESTS_TWO_TRIANGLES_HPP
#define PHIMIS_TESTS_TWO_TRIANGLES_HPP

#include "random.hpp"

#include <phimis/core/observation.hpp>

#include <cmath>
#include <vector>

/// Two techniques on [0, 1] by formula: p_1 = 2(1 − x), p_2 = 2x. f = p(α) for any α is their zero-variance integrand.
struct two_triangles {
  static double p1(double x) { return 2 * (1 - x); }
  static double p2(double x) { return 2 * x; }
  static double sample(int k, double u) { return k == 0 ? 1 - std::sqrt(1 - u) : std::sqrt(u); }

  /// n observations of f drawn at α_1 = first, n α_1 of them from the first technique.
  template <class Real = double, class F>
  static std::vector<phimis::observation<Real, 2>> observe(const F& f, double first, int n, std::uint64_t seed) {
    random_numbers random(seed);
    std::vector<phimis::observation<Real, 2>> all;
    for (int j = 0; j < n; ++j) {
      const int k = j < std::lround(first * n) ? 0 : 1;
      const double x = sample(k, random());
      const Real a = static_cast<Real>(p1(x));
      const Real b = static_cast<Real>(p2(x));
      all.push_back({static_cast<Real>(f(x)), {{a, b}}, static_cast<Real>(first * p1(x) + (1 - first) * p2(x)), k});
    }
    return all;
  }
};

#endif  // PHIMIS_TESTS_TWO_TRIANGLES_HPP
