// SPDX-License-Identifier: MIT
// analysis/allocation.hpp
#include "catch.hpp"

#include <phimis/analysis/allocation.hpp>
#include <phimis/analysis/problem.hpp>
#include <phimis/analysis/variance.hpp>
#include <phimis/technique/density.hpp>

#include <cmath>
#include <limits>

namespace {

using phimis::interval;
using phimis::measured;
using namespace phimis::analysis;

constexpr double infinity = std::numeric_limits<double>::infinity();
const interval unit(0, 1);

/// (n + 1) x^n on [0, 1]
struct power_of_x {
  double n;
  double pdf(double x) const { return (n + 1) * std::pow(x, n); }
  template <phimis::uniform_source Next>
  double sample(Next&& next) const {
    return std::pow(next(), 1 / (n + 1));
  }
};

/// Loses half of its samples.
struct lossy {
  double pdf(double) const { return 0.5; }
  template <phimis::uniform_source Next>
  double sample(Next&& next) const {
    return 2 * next();
  }
};

const phimis::technique_set powers(power_of_x{0}, power_of_x{1});

void check(const measured& computed, double wanted, double largest_error = 1e-12) {
  INFO("error " << computed.error << ", off by " << computed.value - wanted);
  CHECK(std::fabs(computed.value - wanted) <= computed.error + 1e-15 * (1 + std::fabs(wanted)));
  CHECK(computed.error <= largest_error);
}

}  // namespace

TEST_CASE("The variance of each technique alone is that of the closed form") {
  const problem on([](double x) { return x * x; }, powers, unit);
  const auto alone = variance_alone(on);
  check(alone[0], 1.0 / 5 - 1.0 / 9);
  check(alone[1], 1.0 / 8 - 1.0 / 9);
}

TEST_CASE("A technique that is proportional to f has no variance alone") {
  const problem on([](double x) { return 6 * x; }, powers, unit);
  const auto alone = variance_alone(on);
  check(alone[0], 36.0 / 3 - 9);
  CHECK(std::fabs(alone[1].value) <= 1e-28);
}

TEST_CASE("A technique whose variance diverges like a logarithm has an infinite variance alone") {
  // ∫ (1 + x)²/x dx at 0; with a mixture as with the other technique alone nothing is infinite.
  const problem on([](double x) { return 1 + x; }, powers, unit);
  const auto alone = variance_alone(on);
  check(alone[0], 7.0 / 3 - 9.0 / 4);
  CHECK(alone[1].value == infinity);
  CHECK(phimis::is_finite(variance(on, {{0.5, 0.5}}).one_sample.value));
  // The same singularity inside the domain, off every half of it, and at the other end.
  const auto inside = [](double x) { return std::fabs(x - 0.3); };
  const auto end = [](double x) { return 1 - x; };
  const problem elsewhere([](double) { return 1.0; },
                          phimis::technique_set(phimis::density(inside, unit, {0.3}), phimis::density(end, unit)),
                          unit, {0.3});
  CHECK(variance_alone(elsewhere)[0].value == infinity);
  CHECK(variance_alone(elsewhere)[1].value == infinity);
}

TEST_CASE("A variance alone is infinite where f diverges faster, and finite where it does so slowly enough") {
  // ∫ x^{2a}/((n + 1) x^n) dx, of which the variance is less μ² = 1/(a + 1)².
  const auto of = [](double a, double n) {
    return variance_alone(problem([a](double x) { return std::pow(x, a); },
                                  phimis::technique_set(power_of_x{n}, power_of_x{0}), unit))[0];
  };
  const auto closed = [](double a, double n) { return 1 / ((n + 1) * (2 * a - n + 1)) - 1 / ((a + 1) * (a + 1)); };
  for (const double s : {0.25, 0.5, 0.75, 0.9}) {  // integrands like x^{−s}
    CAPTURE(s);
    const double n = 2 + s;
    const auto slow = of(1, n);
    CHECK(slow.value == Approx(closed(1, n)).epsilon(s < 0.8 ? 1e-3 : 0.1));
    CHECK(std::fabs(slow.value - closed(1, n)) <= 10 * slow.error);
  }
  for (const double s : {1.0, 1.01, 1.5, 3.0}) {
    CAPTURE(s);
    CHECK(of(1, 2 + s).value == infinity);
  }
}

TEST_CASE("A technique that does not reach f has an infinite variance alone") {
  const auto half = [](double x) { return x < 0.5 ? 1.0 : 0.0; };
  const phimis::technique_set halves(phimis::density(half, unit, {0.5}),
                                     phimis::density([](double) { return 1.0; }, unit));
  CHECK(variance_alone(problem([](double x) { return x; }, halves, unit, {0.5}))[0].value == infinity);
  // f = 0 wherever it does not reach
  const auto alone = variance_alone(problem(half, halves, unit, {0.5}));
  CHECK(std::fabs(alone[0].value) <= 1e-15);
  check(alone[1], 0.5 - 0.25);
}

TEST_CASE("What a defective pdf misses counts in its variance alone") {
  // f = 1: G = 2 or 0, each with probability ½.
  const problem on([](double) { return 1.0; }, phimis::technique_set(lossy{}, lossy{}), unit, {},
                   normalisation::defective);
  check(variance_alone(on)[0], 1);
}

TEST_CASE("Parts under balance weights at equal counts are those of the closed form") {
  // p_1 + p_2 = 1 + 2x, f = (1 + 2x) x: F = x; μ_1 = 1/2, σ_1² = 1/12; μ_2 = 2/3, σ_2² = 1/2 − 4/9.
  const problem on([](double x) { return x * (1 + 2 * x); }, powers, unit);
  const auto parts = moments_of_parts(phimis::balance{}, on);
  check(parts.mean[0], 1.0 / 2);
  check(parts.mean[1], 2.0 / 3);
  check(parts.variance[0], 1.0 / 12);
  check(parts.variance[1], 1.0 / 18);
  check(variance_of_parts(parts.variance, {{0.5, 0.5}}), 1.0 / 6 + 1.0 / 9);
  // At equal counts this is the balance heuristic.
  CHECK(variance(on, {{0.5, 0.5}}).multi_sample.value == Approx(1.0 / 6 + 1.0 / 9).epsilon(1e-13));
  check(variance_of_parts(parts.variance, {{0.75, 0.25}}), 1.0 / 9 + 2.0 / 9);
  const double sum = std::sqrt(1.0 / 12) + std::sqrt(1.0 / 18);
  check(least_inefficiency(parts.variance), sum * sum);
  CHECK(best_fractions(parts.variance)[0] == Approx(std::sqrt(1.0 / 12) / sum).epsilon(1e-13));
}

TEST_CASE("Parts under weights that jump are those of the closed form") {
  // p_1 = 1 > p_2 = 2x below ½. f = 1: the first has w f/p = 1 there, the second 1/(2x) above.
  const problem on([](double) { return 1.0; }, powers, unit);
  const auto parts = moments_of_parts(phimis::maximum{}, on);
  check(parts.mean[0], 0.5);
  check(parts.mean[1], 0.5);
  check(parts.variance[0], 0.25);
  check(parts.variance[1], std::log(2.0) / 2 - 0.25);
  // cutoff a = 0.3: the first drops out where 1 < 0.6 x, never; the second where 2x < 0.3, at no half of the domain.
  const auto cut = moments_of_parts(phimis::cutoff{0.3}, on);
  const double shared = std::log(3 / 1.3) / 2;  // ∫_.15^1 1/(1 + 2x) dx
  constexpr double rounding = 2e-15;            // panels end at the jump
  check(cut.mean[0], 0.15 + shared, rounding);
  check(cut.mean[1], 0.85 - shared, rounding);
}

TEST_CASE("Any callable is a heuristic of parts") {
  const auto alone = [](int k, const auto&, const auto&) { return k == 0 ? 1.0 : 0.0; };
  const problem on([](double x) { return x * x; }, powers, unit);
  const auto parts = moments_of_parts(alone, on);
  check(parts.mean[0], 1.0 / 3);
  check(parts.variance[0], 1.0 / 5 - 1.0 / 9);
  CHECK(parts.variance[1].value == 0);
  CHECK(best_fractions(parts.variance)[0] == 1);
  CHECK(variance_of_parts(parts.variance, {{1, 0}}).value == parts.variance[0].value);
  CHECK(variance_of_parts(parts.variance, {{0, 1}}).value == infinity);
}

TEST_CASE("Costs enter where they should") {
  const phimis::per_technique<measured, 2> variances{{{4, 0}, {1, 0}}};
  const phimis::per_technique<double, 2> costs{{1, 9}};
  CHECK(best_fractions(variances, costs)[0] == Approx(6.0 / 7));  // 2 : 1/3
  CHECK(least_inefficiency(variances, costs).value == Approx(25));
  CHECK(mean_cost<2>({{0.5, 0.5}}, costs) == 5);
  CHECK(efficiency(5, 10) == 0.02);
  CHECK(efficiency(5, 0) == infinity);
}

TEST_CASE("The condition of the least V[F] is its gradient") {
  const problem on([](double x) { return 1 + x * x; }, powers, unit);
  for (const double a : {0.2, 0.5, 0.9}) {
    const auto v = [&](double first, double second) { return variance(on, {{first, second}}).multi_sample.value; };
    const phimis::fractions<double, 2> alpha{{a, 1 - a}};
    const auto condition = multi_sample_condition(on, alpha);
    const double h = 1e-5;
    // Along the simplex.
    CHECK(condition[1] - condition[0] == Approx((v(a + h, 1 - a - h) - v(a - h, 1 - a + h)) / (2 * h)).epsilon(1e-6));
    // V[F] is homogeneous of degree −1.
    CHECK(a * condition[0] + (1 - a) * condition[1] == Approx(v(a, 1 - a)).epsilon(1e-12));
  }
}
