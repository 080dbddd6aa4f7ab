// SPDX-License-Identifier: MIT
// analysis/problem.hpp, variance.hpp, optimum.hpp
#include "catch.hpp"

#include <phimis/analysis/optimum.hpp>
#include <phimis/analysis/problem.hpp>
#include <phimis/analysis/variance.hpp>
#include <phimis/divergence/phi_divergence.hpp>
#include <phimis/technique/density.hpp>

#include <boost/math/quadrature/tanh_sinh.hpp>

#include <cmath>
#include <limits>

namespace {

using phimis::interval;
using phimis::measured;
using phimis::analysis::normalisation;
using phimis::analysis::problem;
using fractions = phimis::fractions<double, 2>;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// c x^n (1 − x)^m on [0, 1]
struct polynomial {
  double c;
  int n, m;
  double pdf(double x) const { return c * std::pow(x, n) * std::pow(1 - x, m); }
  template <phimis::uniform_source Next>
  double sample(Next&&) const {
    return 0;
  }
};
const phimis::technique_set triangles(polynomial{2, 0, 1}, polynomial{2, 1, 0});  // 2(1 − x) and 2x
const interval unit(0, 1);
double square(double x) { return x * x; }

/// The value is the closed form up to the error that it states, which is small, and to the rounding of the function
/// that is integrated, a few last digits. A function like x² log x has the larger error estimate.
void check(const measured& computed, double wanted, double largest_error = 1e-12) {
  INFO("error " << computed.error << ", off by " << computed.value - wanted);
  CHECK(std::fabs(computed.value - wanted) <= computed.error + 1e-15 * (1 + std::fabs(wanted)));
  CHECK(computed.error <= largest_error);
}

/// A second quadrature, for what has no closed form.
template <class F>
double by_tanh_sinh(const F& f) {
  static boost::math::quadrature::tanh_sinh<double> rule;
  return rule.integrate(f, 0.0, 1.0, 1e-15);
}

}  // namespace

TEST_CASE("Gamma-moments are those of the closed form") {
  // p = 1 at equal fractions: M_1 = ∫ x^{2γ} 2(1 − x), M_2 = ∫ x^{2γ} 2x.
  const problem on(square, triangles, unit);
  for (const double gamma : {0.5, 1.0, 2.0, 3.5}) {
    const auto moments = phimis::analysis::gamma_moments(on, gamma, fractions{{0.5, 0.5}});
    check(moments[0], 2 / (2 * gamma + 1) - 2 / (2 * gamma + 2));
    check(moments[1], 2 / (2 * gamma + 2));
  }
}

TEST_CASE("Gamma-moments at one technique alone are finite where it reaches what the other does") {
  // All of f lies where p_1 = 0 at one point only.
  const problem on(square, triangles, unit);
  const auto moments = phimis::analysis::gamma_moments(on, 1, fractions{{0, 1}});
  check(moments[1], 1.0 / 3);              // E_{p_2}[f/p_2] = μ
  check(moments[0], 0.5 - 1.0 / 3);        // ∫ x²/(2x) 2(1 − x)
}

TEST_CASE("Variances are those of the closed form") {
  const problem on(square, triangles, unit);
  check(on.mean(), 1.0 / 3);
  CHECK(on.size() == Approx(1.0 / 3).epsilon(1e-14));
  {
    // p = 1: V[ℱ] = 1/5 − 1/9, μ'_1 = 1/6, μ'_2 = 1/2.
    const auto at = phimis::analysis::variance(on, fractions{{0.5, 0.5}});
    check(at.one_sample, 1.0 / 5 - 1.0 / 9);
    check(at.multi_sample, 1.0 / 5 - 0.5 * (1.0 / 36 + 1.0 / 4));
    check(at.difference, 0.5 * (1.0 / 36 + 1.0 / 4) - 1.0 / 9);
  }
  {
    // p = a + x, a = 1/2: ∫ x²/p = 1/2 − a + a² L, ∫ x³/p = 1/3 − a/2 + a² − a³ L, ∫ x⁴/p = 1/4 − a/3 + a²/2 − a³ + a⁴ L.
    const double a = 0.5, L = std::log((1 + a) / a);
    const double two = 0.5 - a + a * a * L, three = 1.0 / 3 - a / 2 + a * a - a * a * a * L;
    const double four = 0.25 - a / 3 + a * a / 2 - a * a * a + a * a * a * a * L;
    const double m1 = 2 * (two - three), m2 = 2 * three;
    const auto at = phimis::analysis::variance(on, fractions{{0.25, 0.75}});
    check(at.one_sample, four - 1.0 / 9);
    check(at.multi_sample, four - 0.25 * m1 * m1 - 0.75 * m2 * m2);
  }
  {
    // One technique alone: ∫ x⁴/(2x) − 1/9, and both variances are the same.
    const auto at = phimis::analysis::variance(on, fractions{{0, 1}});
    check(at.one_sample, 1.0 / 8 - 1.0 / 9);
    CHECK(at.multi_sample.value == Approx(1.0 / 8 - 1.0 / 9).epsilon(1e-12));
    CHECK(std::fabs(at.difference.value) <= 1e-15);
  }
}

TEST_CASE("The variance of an integrand that changes sign uses its sign") {
  // f = 2x − 1, p = 1: μ = 0, V[ℱ] = 1/3, μ'_1 = −1/3, μ'_2 = 1/3.
  const problem on([](double x) { return 2 * x - 1; }, triangles, unit, {0.5});
  CHECK(std::fabs(on.mean().value) <= 1e-15);
  CHECK(on.size() == Approx(0.5).epsilon(1e-14));
  const auto at = phimis::analysis::variance(on, fractions{{0.5, 0.5}});
  check(at.one_sample, 1.0 / 3);
  check(at.multi_sample, 1.0 / 3 - 1.0 / 9);
}

TEST_CASE("A mixture without variance has none to all digits") {
  const auto f = [](double x) { return 5 * (0.3 * 2 * (1 - x) + 0.7 * 2 * x); };
  const auto at = phimis::analysis::variance(problem(f, triangles, unit), fractions{{0.3, 0.7}});
  CHECK(std::fabs(at.one_sample.value) <= 1e-28);
  CHECK(std::fabs(at.multi_sample.value) <= 1e-28);
}

TEST_CASE("A fraction of 0 where only that technique reaches f makes the variance infinite") {
  const phimis::technique_set halves(phimis::density([](double x) { return x < 0.5 ? 1.0 : 0.0; }, unit, {0.5}),
                                     phimis::density([](double) { return 1.0; }, unit));
  const problem on(square, halves, unit, {0.5});
  CHECK(phimis::analysis::variance(on, fractions{{1, 0}}).one_sample.value == infinity);
  // The γ-moment of the first technique, which never sees what it does not reach: E_{p_1}[f/p_1] = ∫_0^½ x².
  const auto moments = phimis::analysis::gamma_moments(on, 1, fractions{{1, 0}});
  check(moments[0], 1.0 / 24);
  CHECK(moments[1].value == infinity);
  CHECK(std::isfinite(phimis::analysis::variance(on, fractions{{0.9, 0.1}}).one_sample.value));
}

TEST_CASE("Divergences are those of the closed form") {
  // g = 3x² and p = 1.
  const problem on(square, triangles, unit);
  const fractions equal{{0.5, 0.5}};
  using phimis::analysis::divergence_at;
  const double log3 = std::log(3.0);
  check(divergence_at(phimis::kullback_leibler{}, on, equal), log3 - 2.0 / 3, 1e-8);
  check(divergence_at(phimis::chi_squared{}, on, equal), 4.0 / 5);
  check(divergence_at(phimis::hellinger{}, on, equal), 1 - std::sqrt(3.0) / 2);
  check(divergence_at(phimis::tsallis{3}, on, equal), (27.0 / 7 - 1) / 2);
  check(divergence_at(phimis::reversed{phimis::hellinger{}}, on, equal), 1 - std::sqrt(3.0) / 2);
  check(divergence_at(phimis::pearson_vajda{2}, on, equal), 4.0 / 5);
  // ½ ∫ |3x² − 1| = 2/(3√3), with the crossing as an edge.
  check(phimis::analysis::divergence_between_kinks(phimis::total_variation{}, on, equal), 2 / (3 * std::sqrt(3.0)));
  check(phimis::analysis::divergence_between_kinks(phimis::pearson_vajda{1}, on, equal), 4 / (3 * std::sqrt(3.0)));
  // V[ℱ] = μ² χ².
  const auto variance = phimis::analysis::variance(on, equal);
  CHECK(divergence_at(phimis::one_sample_variance{}, on, equal).value / 9 ==
        Approx(variance.one_sample.value).epsilon(1e-13));
}

TEST_CASE("The error estimate of a singular integrand bounds its error") {
  // ∫ log x: the reversed divergence ∫ p log(p/g) = 2 − log 3 has a logarithmic singularity at 0.
  const problem on(square, triangles, unit);
  const measured reversed = phimis::analysis::divergence_at(phimis::reversed{phimis::kullback_leibler{}}, on, fractions{{0.5, 0.5}});
  CHECK(std::fabs(reversed.value - (2 - std::log(3.0))) <= reversed.error);
  for (const double power : {0.3, 1.7, 2.5}) {
    const problem rough([power](double x) { return std::pow(std::fabs(x - 0.37), power); }, triangles, unit, {0.37});
    const double wanted = (std::pow(0.37, power + 1) + std::pow(0.63, power + 1)) / (power + 1);
    check(rough.mean(), wanted, 1e-10);
  }
}

TEST_CASE("A defective pdf loses samples, which count as zeros") {
  // p_1 = 1 − x has half its mass. At α: p = α(1 − x) + (1 − α) 2x; V[ℱ] = ∫ f²/p − μ², V[F] = ∫ f²/p − Σ α μ'².
  const phimis::technique_set lossy(polynomial{1, 0, 1}, polynomial{2, 1, 0});
  const problem on(square, lossy, unit, {}, normalisation::defective);
  CHECK(on.missing_mass()[0] == Approx(0.5).epsilon(1e-14));
  CHECK(std::fabs(on.missing_mass()[1]) <= 1e-15);
  for (const double a : {0.2, 0.5, 0.9}) {
    const auto p = [a](double x) { return a * (1 - x) + (1 - a) * 2 * x; };
    const double second = by_tanh_sinh([&](double x) { return square(x) * square(x) / p(x); });
    const double m1 = by_tanh_sinh([&](double x) { return square(x) * (1 - x) / p(x); });
    const double m2 = by_tanh_sinh([&](double x) { return square(x) * 2 * x / p(x); });
    const auto at = phimis::analysis::variance(on, fractions{{a, 1 - a}});
    CHECK(at.one_sample.value == Approx(second - 1.0 / 9).epsilon(1e-12));
    CHECK(at.multi_sample.value == Approx(second - a * m1 * m1 - (1 - a) * m2 * m2).epsilon(1e-12));
  }
}

namespace {

double interior(double x) { return 0.5 + x * x; }

/// ζ/λ at the optimum, by the second quadrature.
template <class Divergence>
void check_optimum(const char* name, const Divergence& divergence) {
  INFO(name);
  const auto found = phimis::analysis::optimum(divergence, problem(interior, triangles, unit));
  const double a = found.alpha[0], mu = 5.0 / 6;
  CHECK((a > 0.01 && a < 0.49));
  CHECK(std::fabs(found.alpha[0] + found.alpha[1] - 1) <= 1e-15);
  CHECK_FALSE(found.local);
  CHECK(found.residual <= 1e-14);
  CHECK(found.error <= 1e-12);
  const auto score = [&](double x) {
    return phimis::score_at(divergence, interior(x) / mu / (a * 2 * (1 - x) + (1 - a) * 2 * x)).value;
  };
  const double zeta = by_tanh_sinh([&](double x) { return (2 - 4 * x) * score(x); });
  const double size = by_tanh_sinh([&](double x) { return 2 * std::fabs(score(x)); });
  CHECK(std::fabs(zeta) <= 1e-13 * size);
}

}  // namespace

TEST_CASE("The optimum satisfies its condition by another quadrature") {
  check_optimum("Kullback-Leibler", phimis::kullback_leibler{});
  check_optimum("chi squared", phimis::chi_squared{});
  check_optimum("Hellinger", phimis::hellinger{});
  check_optimum("Tsallis .1", phimis::tsallis{0.1});
  check_optimum("Tsallis 6", phimis::tsallis{6});
  check_optimum("reversed Kullback-Leibler", phimis::reversed{phimis::kullback_leibler{}});
  check_optimum("reversed chi squared", phimis::reversed{phimis::chi_squared{}});
  check_optimum("Pearson-Vajda 2", phimis::pearson_vajda{2});
  check_optimum("Jensen-Shannon", phimis::phi_divergence([](auto t) {
                  return t * log(t) - (1.0 + t) * log((1.0 + t) / 2.0);
                }));
}

TEST_CASE("Near the optimum nothing is better, for step scores and for the multi-sample variance too") {
  const problem on(interior, triangles, unit);
  const auto total = phimis::analysis::optimum(phimis::total_variation{}, on);
  const auto local = phimis::analysis::optimum(phimis::multi_sample_variance{}, on);
  CHECK(local.local);
  for (const double step : {-1e-2, -1e-4, 1e-4, 1e-2}) {
    const auto moved = [step](const fractions& alpha) { return fractions{{alpha[0] + step, alpha[1] - step}}; };
    using phimis::analysis::divergence_between_kinks;
    CHECK(divergence_between_kinks(phimis::total_variation{}, on, total.alpha).value <
          divergence_between_kinks(phimis::total_variation{}, on, moved(total.alpha)).value);
    CHECK(phimis::analysis::variance(on, local.alpha).multi_sample.value <
          phimis::analysis::variance(on, moved(local.alpha)).multi_sample.value);
  }
}

TEST_CASE("The optimum of a mixture is that mixture, of a pdf that pdf, and floors hold") {
  const auto mix = [](double x) { return 0.3 * 2 * (1 - x) + 0.7 * 2 * x; };
  const problem on(mix, triangles, unit);
  CHECK(phimis::analysis::optimum(phimis::chi_squared{}, on).alpha[0] == Approx(0.3).epsilon(1e-13));
  CHECK(phimis::analysis::optimum(phimis::tsallis{0.1}, on).alpha[0] == Approx(0.3).epsilon(1e-13));
  CHECK(phimis::analysis::optimum(phimis::multi_sample_variance{}, on).alpha[0] == Approx(0.3).epsilon(1e-7));
  const auto floored = phimis::analysis::optimum(phimis::chi_squared{}, on, {.floors = {{0.4, 0.1}}});
  CHECK(floored.alpha[0] == 0.4);
  CHECK(floored.error == 0);
  const problem one([](double x) { return 2 * x; }, triangles, unit);
  CHECK(phimis::analysis::optimum(phimis::kullback_leibler{}, one).alpha[0] <= 1e-15);
  CHECK(phimis::analysis::optimum(phimis::kullback_leibler{}, one, {.floors = {{0.05, 0}}}).alpha[0] == 0.05);
}

TEST_CASE("The unit of f changes no optimum and scales the variance by its square") {
  const problem plain(interior, triangles, unit);
  for (const double scale : {1e-100, 1e100}) {
    const problem scaled([scale](double x) { return scale * interior(x); }, triangles, unit);
    for (const double gamma : {0.5, 3.0}) {
      CHECK(phimis::analysis::optimum(phimis::tsallis{gamma}, scaled).alpha[0] ==
            Approx(phimis::analysis::optimum(phimis::tsallis{gamma}, plain).alpha[0]).epsilon(1e-12));
    }
    CHECK(phimis::analysis::variance(scaled, fractions{{0.5, 0.5}}).one_sample.value / (scale * scale) ==
          Approx(phimis::analysis::variance(plain, fractions{{0.5, 0.5}}).one_sample.value).epsilon(1e-12));
  }
}

TEST_CASE("The rows of a problem are observations of its nodes") {
  const problem on(square, triangles, unit);
  const auto rows = on.rows();
  CHECK(rows.size() == static_cast<std::ptrdiff_t>(on.nodes().size()));
  double mass = 0, mean = 0;
  for (std::ptrdiff_t j = 0; j < rows.size(); ++j) {
    mass += rows[j].w * rows[j].y[0];
    mean += rows[j].w * rows[j].u;
  }
  CHECK(mass == Approx(1).epsilon(1e-14));
  CHECK(mean == Approx(1.0 / 3).epsilon(1e-14));
}

TEST_CASE("Three techniques have variances and moments like two") {
  const phimis::technique_set three(polynomial{2, 0, 1}, polynomial{2, 1, 0}, polynomial{1, 0, 0});
  const problem on(square, three, unit);
  // A third that is the mean of the others: p = 1 again, μ'_3 = 1/3.
  const phimis::fractions<double, 3> alpha{{0.25, 0.25, 0.5}};
  check(phimis::analysis::variance(on, alpha).one_sample, 1.0 / 5 - 1.0 / 9);
  check(phimis::analysis::variance(on, alpha).multi_sample, 1.0 / 5 - 0.25 * (1.0 / 36 + 1.0 / 4) - 0.5 / 9);
  check(phimis::analysis::gamma_moments(on, 2, alpha)[2], 1.0 / 5);
}
