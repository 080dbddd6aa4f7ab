// SPDX-License-Identifier: MIT
// joint_minimiser.hpp: the coefficients at the learnt fractions, by their own equations.
#include "catch.hpp"
#include "two_triangles.hpp"

#include <phimis/solver/joint_minimiser.hpp>

#include <cmath>

namespace {

double waves(double x) { return std::sin(9 * x) + 0.4 * x; }  // of either sign

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
