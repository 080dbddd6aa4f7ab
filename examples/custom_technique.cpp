// SPDX-License-Identifier: MIT
// test:
#include <phimis/phimis.hpp>

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

using point = std::array<double, 2>;

// A technique of your own: `sample` turns uniform numbers into a point, `pdf` is exactly the density of such points.
// Here polar coordinates around the origin, p = 2/(√2 π r): it cancels a peak 1/r. Points may fall outside of the
// unit square; they are samples with f = 0.
struct around_origin {
  template <class Next>
  point sample(Next&& next) const {
    const double r = std::numbers::sqrt2 * next();
    const double angle = std::numbers::pi / 2 * next();
    return {r * std::cos(angle), r * std::sin(angle)};
  }
  double pdf(const point& x) const {
    const double r = std::hypot(x[0], x[1]);
    return r <= std::numbers::sqrt2 ? 2 / (std::numbers::sqrt2 * std::numbers::pi * r) : 0;
  }
};

struct unit_square {
  static bool contains(const point& x) { return x[0] >= 0 && x[0] < 1 && x[1] >= 0 && x[1] < 1; }

  template <class Next>
  point sample(Next&& next) const {
    const double x = next();
    return {x, next()};
  }
  double pdf(const point& x) const { return contains(x) ? 1 : 0; }
};

int main(int argc, char**) {
  if (argc > 1) return std::puts("usage: custom_technique\nA 2-D integral with a user's own techniques."), 0;

  // ∫∫ 1/r + 4xy dx dy over the unit square = 2 log(1 + √2) + 1
  const auto f = [](const point& x) {
    return unit_square::contains(x) ? 1 / std::hypot(x[0], x[1]) + 4 * x[0] * x[1] : 0;
  };
  const double exact = 2 * std::log(1 + std::numbers::sqrt2) + 1;

  const phimis::technique_set techniques(around_origin{}, unit_square{});
  const auto result = phimis::integrate(f, techniques, {.budget = 20000});

  std::printf("fractions  %.3f polar, %.3f uniform; %lld of %lld samples outside\n", result.fractions[0],
              result.fractions[1], static_cast<long long>(result.zero), static_cast<long long>(result.samples));
  std::printf("estimate   %.5f +- %.5f\nexact      %.5f\n", result.estimate, result.standard_error, exact);
  const bool right = std::fabs(result.estimate - exact) <= 5 * result.standard_error;
  return right && result.standard_error < 0.02 ? 0 : 1;
}
