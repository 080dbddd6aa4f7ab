// SPDX-License-Identifier: MIT
// test:
#include <phimis/analysis/optimum.hpp>
#include <phimis/divergence/phi_divergence.hpp>
#include <phimis/phimis.hpp>

#include <cmath>
#include <cstdio>
#include <numbers>

// A divergence of your own: one generic lambda φ, convex with φ(1) = 0, that calls log, exp, pow without std::, so
// that it can be differentiated. Here the Jensen-Shannon divergence of f/μ and the mixture p(α),
//
//     JS = ∫ p φ(f/(μ p)) dx,   φ(t) = ½ (t log t − (1 + t) log((1 + t)/2))
//
int main(int argc, char**) {
  if (argc > 1) {
    std::puts("usage: custom_divergence\nLearns fractions by a divergence of the user's own.");
    return 0;
  }
  const phimis::phi_divergence jensen_shannon([](auto t) { return (t * log(t) - (1 + t) * log((1 + t) / 2)) / 2; });

  const auto f = [](double x) { return std::sqrt(x) + std::sin(x); };
  const phimis::interval domain(0.01, 3.5 * std::numbers::pi);
  const phimis::technique_set techniques(phimis::gaussian(2, 1, domain), phimis::gaussian(8, 2, domain));

  // Learnt from samples, and the same on exact integrals.
  const auto learnt = phimis::integrate(f, techniques, {.budget = 20000},
                                        phimis::exact_rule(jensen_shannon));
  const phimis::analysis::problem on(f, techniques, domain);
  const auto exact = phimis::analysis::optimum(jensen_shannon, on);

  const auto report = [&](const char* name, const phimis::fractions<double, 2>& alpha) {
    const double divergence = phimis::analysis::divergence_at(jensen_shannon, on, alpha).value;
    const double variance = phimis::analysis::variance(on, alpha).multi_sample.value;
    std::printf("%-20s  %.4f   %.6f   %.3f\n", name, alpha[0], divergence, variance);
    return divergence;
  };
  std::printf("fractions             first    JS         V[F]\n");
  const double at_learnt = report("learnt from samples", learnt.fractions);
  const double at_exact = report("exact", exact.alpha);
  const double at_equal = report("equal", phimis::equal_fractions<double, 2>());
  std::printf("estimate %.3f +- %.3f, exact %.3f\n", learnt.estimate, learnt.standard_error, on.mean().value);

  // Its own checks. φ is its own mirror image, t φ(1/t) = φ(t), so the reversed divergence has the same optimum.
  const auto mirrored = phimis::analysis::optimum(phimis::reversed{jensen_shannon}, on);
  const bool symmetric = std::fabs(mirrored.alpha[0] - exact.alpha[0]) < 1e-9;
  const bool least = at_exact <= at_learnt && at_learnt < at_exact + 0.01 * (at_equal - at_exact);
  const bool right = std::fabs(learnt.estimate - on.mean().value) <= 5 * learnt.standard_error;
  return symmetric && least && right ? 0 : 1;
}
