// SPDX-License-Identifier: MIT
// test:
#include <phimis/phimis.hpp>

#include <cmath>
#include <cstdio>
#include <numbers>

int main(int argc, char**) {
  if (argc > 1) return std::puts("usage: quickstart\nAn integral by two normal densities with learnt fractions."), 0;

  // μ = ∫ √x + sin x dx over [0.01, 3.5π]: each normal density fits a part of it.
  const auto f = [](double x) { return std::sqrt(x) + std::sin(x); };
  const phimis::interval domain(0.01, 3.5 * std::numbers::pi);
  const phimis::technique_set techniques(phimis::gaussian(2, 1, domain), phimis::gaussian(8, 2, domain));

  const auto learnt = phimis::integrate(f, techniques, {.budget = 5000});
  const auto equal = phimis::integrate(f, techniques, {.budget = 5000}, phimis::fixed_rule<2>());

  std::printf("learnt fractions %.3f and %.3f: %.3f +- %.3f\n", learnt.fractions[0], learnt.fractions[1],
              learnt.estimate, learnt.standard_error);
  std::printf("equal fractions  %.3f and %.3f: %.3f +- %.3f\n", equal.fractions[0], equal.fractions[1],
              equal.estimate, equal.standard_error);

  // Its own check: the exact integral is 25.3065 to four decimals.
  const double off = std::fabs(learnt.estimate - 25.3065);
  return off <= 5 * learnt.standard_error && learnt.standard_error < equal.standard_error ? 0 : 1;
}
