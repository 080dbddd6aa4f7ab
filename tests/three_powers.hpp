// SPDX-License-Identifier: MIT
#ifndef PHIMIS_TESTS_THREE_POWERS_HPP
#define PHIMIS_TESTS_THREE_POWERS_HPP

#include "random.hpp"

#include <phimis/core/observation.hpp>

#include <cmath>
#include <vector>

/// Three techniques on [0, 1] by formula: p_1 = 1, p_2 = 2x, p_3 = 3x².
struct three_powers {
  template <class Real = double>
  static phimis::per_technique<Real, 3> pdfs(double x) {
    return {{1, static_cast<Real>(2 * x), static_cast<Real>(3 * x * x)}};
  }
  static double sample(int k, double u) { return k == 0 ? u : k == 1 ? std::sqrt(u) : std::cbrt(u); }

  /// n[k] observations of f from technique k, at random, drawn in turn.
  template <class Real = double, class F>
  static std::vector<phimis::observation<Real, 3>> observe(const F& f, const phimis::per_technique<int, 3>& n,
                                                           std::uint64_t seed) {
    random_numbers random(seed);
    return draw<Real>(f, n, [&](int) { return random(); });
  }

  /// n observations of f from each technique at equally spaced quantiles: quadrature, with an error of order 1/n.
  template <class Real = double, class F>
  static std::vector<phimis::observation<Real, 3>> tabulate(const F& f, int n) {
    return draw<Real>(f, {{n, n, n}}, [n](int j) { return (j + 0.5) / n; });
  }

 private:
  template <class Real, class F, class U>
  static std::vector<phimis::observation<Real, 3>> draw(const F& f, const phimis::per_technique<int, 3>& n,
                                                        const U& u) {
    std::vector<phimis::observation<Real, 3>> all;
    const double total = n[0] + n[1] + n[2];
    for (int j = 0; j < n[0] || j < n[1] || j < n[2]; ++j) {
      for (int k = 0; k < 3; ++k) {
        if (j >= n[k]) continue;
        const double x = sample(k, u(j));
        const auto p = pdfs<double>(x);
        const double q = (n[0] * p[0] + n[1] * p[1] + n[2] * p[2]) / total;
        all.push_back({static_cast<Real>(f(x)), pdfs<Real>(x), static_cast<Real>(q), k});
      }
    }
    return all;
  }
};

#endif  // PHIMIS_TESTS_THREE_POWERS_HPP
