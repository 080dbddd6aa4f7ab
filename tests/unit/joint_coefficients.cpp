// SPDX-License-Identifier: MIT
// joint_minimiser.hpp, joint_optimum.hpp: the coefficients at the learnt fractions, by their own equations; in reach of these
// fractions only.
#include "catch.hpp"
#include "two_triangles.hpp"

#include <phimis/analysis/joint_optimum.hpp>
#include <phimis/solver/joint_minimiser.hpp>
#include <phimis/technique/technique_set.hpp>

#include <cmath>
#include <limits>

namespace {

double waves(double x) { return std::sin(9 * x) + 0.4 * x; }  // of either sign

/// Even on a part of [0, 1].
struct part {
  double lower, upper;
  double pdf(double x) const { return x < lower || x >= upper ? 0 : 1 / (upper - lower); }
  template <phimis::uniform_source Next>
  double sample(Next&& next) const {
    return lower + (upper - lower) * next();
  }
};

}  // namespace

TEST_CASE("Coefficients solve the normal equations at the learnt fractions, of an f that changes sign") {
  for (const auto variate : {phimis::control_variate::on, phimis::control_variate::off}) {
    const auto all = two_triangles::observe(waves, 0.5, 80, 3);
    auto rule = phimis::joint_rule<2>(phimis::joint_options<2>(), variate);
    for (const auto& o : all) rule.observe(o);
    REQUIRE(rule.update() == phimis::rule_status::updated);
    CHECK(rule.residual() <= 1e-10);
    CHECK(rule.evaluations() <= 12);
    // Σ_j p_kj (f_j − Σ_l β_l p_lj)/(q_j p(α, x_j)) = 0
    long double rest[2] = {};
    long double size[2] = {};
    for (const auto& o : all) {
      const long double p = phimis::mixture(rule.fractions(), o.pdfs);
      long double r = o.f;
      for (int k = 0; k < 2; ++k) r -= static_cast<long double>(rule.coefficients()[k]) * o.pdfs[k];
      for (int k = 0; k < 2; ++k) {
        rest[k] += o.pdfs[k] * r / (o.q * p);
        size[k] += std::fabs(o.pdfs[k] * static_cast<long double>(o.f) / (o.q * p));
      }
    }
    for (int k = 0; k < 2; ++k) CHECK(std::fabs(rest[k]) <= 1e-12L * size[k]);
  }
}

TEST_CASE(
    "Without the technique that alone reaches a part of f the controlled variance is infinite, of f = 0 it is not") {
  const phimis::technique_set techniques(part{0, 0.5}, part{0.5, 1});
  const phimis::fractions<double, 2> first_alone{{1, 0}};
  const auto variance_of = [&](double (*f)(double)) {
    const phimis::analysis::problem<2> on(f, techniques, phimis::interval(0, 1), {0.5});
    return phimis::analysis::best_control_variates(on, first_alone).variance.value;
  };
  CHECK(variance_of([](double x) { return 1 + x; }) == std::numeric_limits<double>::infinity());
  // 1 + x on [0, ½] with p = 2, less what a constant explains: ∫ (x − ¼)²/2 dx.
  CHECK(variance_of([](double x) { return x < 0.5 ? 1 + x : 0; }) == Approx(1.0 / 192));
}
