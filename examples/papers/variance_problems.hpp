// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_PAPERS_VARIANCE_PROBLEMS_HPP
#define PHIMIS_EXAMPLES_PAPERS_VARIANCE_PROBLEMS_HPP

#include <phimis/analysis/problem.hpp>
#include <phimis/phimis.hpp>

#include <cmath>
#include <numbers>
#include <vector>

/// The four 1-D examples of Sbert, Havran & Szirmay-Kalos, "Variance Analysis of Multi-sample and One-sample Multiple
/// Importance Sampling", Pacific Graphics 2016, App. A.
///
/// - The printed normalisation integrals end at π/2; they run to π, as the integrals of f do.
namespace papers {

/// What the examples share: sampling x, x² − x/π and sin x on [3/(2π), π], at costs 1, 6.24 and 3.28.
struct variance_setting {
  static constexpr double pi = std::numbers::pi;
  static constexpr double start = 3 / (2 * pi);

  static phimis::interval domain() { return {start, pi}; }
  static double linear(double x) { return x; }
  static double quadratic(double x) { return x * (x - 1 / pi); }
  static double sine(double x) { return std::sin(x); }
  static constexpr phimis::per_technique<double, 3> costs{{1, 6.24, 3.28}};

  /// The integrals of the three over the domain.
  static phimis::per_technique<double, 3> normalisations() {
    const double square = pi * pi - start * start;
    const double cube = pi * pi * pi - start * start * start;
    return {{square / 2, cube / 3 - square / (2 * pi), 1 + std::cos(start)}};
  }
  static auto techniques() {
    return phimis::technique_set(phimis::density(linear, domain()), phimis::density(quadratic, domain()),
                                 phimis::density(sine, domain()));
  }
};

/// Examples 3 and 4 up to the double nearest to π, in t = π − x, which double resolves there: what the paper's V[G_3] is.
///
/// The domain [3/(2π), π − 1.2246e-16] is that of a program that writes π for the end point.
namespace up_to_rounded_pi {

inline constexpr double cut = 1.2246467991473532e-16;  // π − double(π)
inline constexpr double length = std::numbers::pi - variance_setting::start;

inline double linear(double t) { return variance_setting::linear(std::numbers::pi - t); }
inline double quadratic(double t) { return variance_setting::quadratic(std::numbers::pi - t); }
inline double sine(double t) { return std::sin(t); }

/// Edges of decades: f²/sin t grows like 1/t.
inline std::vector<double> decades() {
  std::vector<double> edges;
  for (double t = 1e-15; t < 1; t *= 10) edges.push_back(t);
  return edges;
}

/// The problem of an integrand in t.
template <class Integrand>
phimis::analysis::problem<3> problem_of(const Integrand& f) {
  const phimis::interval domain(cut, length);
  return {f,
          phimis::technique_set(phimis::density(linear, domain), phimis::density(quadratic, domain),
                                phimis::density(sine, domain)),
          domain, decades()};
}

}  // namespace up_to_rounded_pi

/// Example 1, Eq. 51: the product of the three.
struct variance_1 : variance_setting {
  static constexpr const char* name = "V1";
  static double f(double x) { return linear(x) * quadratic(x) * sine(x); }
};

/// Example 2, Eq. 53.
struct variance_2 : variance_setting {
  static constexpr const char* name = "V2";
  static double f(double x) { return quadratic(x) * sine(x) * sine(x); }
};

/// Example 3, Eq. 54: the sum of the three. V[G_3] is infinite: f²/sin x diverges like 1/(π − x).
struct variance_3 : variance_setting {
  static constexpr const char* name = "V3";
  static double f(double x) { return linear(x) + quadratic(x) + sine(x); }
  static double f_from_pi(double t) {
    return up_to_rounded_pi::linear(t) + up_to_rounded_pi::quadratic(t) + up_to_rounded_pi::sine(t);
  }
};

/// Example 4, Eq. 55: the sum of the three pdfs. V[G_3] is infinite as in example 3.
struct variance_4 : variance_setting {
  static constexpr const char* name = "V4";
  static double f(double x) { return sum(linear(x), quadratic(x), sine(x)); }
  static double f_from_pi(double t) {
    return sum(up_to_rounded_pi::linear(t), up_to_rounded_pi::quadratic(t), up_to_rounded_pi::sine(t));
  }

 private:
  static double sum(double first, double second, double third) {
    static const phimis::per_technique<double, 3> z = normalisations();
    return first / z[0] + second / z[1] + third / z[2];
  }
};

}  // namespace papers

#endif  // PHIMIS_EXAMPLES_PAPERS_VARIANCE_PROBLEMS_HPP
