// SPDX-License-Identifier: MIT
// A host of phimis::core: learns the fractions of f = x² + 1 under p_1 = 3x² and p_2 = 1 on [0, 1]. The mixture at
// α = (¼, ¾) is f/μ, so that every divergence has its optimum there, whatever the sample.
#include <phimis/core.hpp>

#include <cmath>
#include <cstdio>

int main() {
  phimis::exact_minimiser<phimis::kullback_leibler, phimis::fixed_table<double, 2, 64>> exact;
  phimis::newton_raphson<phimis::kullback_leibler> newton;
  for (int j = 0; j < 64; ++j) {
    const bool first = j % 2 == 0;
    const double u = (j + 0.5) / 64;
    const double x = first ? std::cbrt(u) : u;
    const phimis::observation<double, 2> sample{x * x + 1, {{3 * x * x, 1}}, (3 * x * x + 1) / 2, first ? 0 : 1};
    exact.observe(sample);
    newton.observe(sample);
  }
  const bool updated =
      exact.update() == phimis::rule_status::updated && newton.update() == phimis::rule_status::updated;
  const bool right = std::fabs(exact.fractions()[0] - 0.25) < 1e-6 && std::fabs(newton.fractions()[0] - 0.25) < 0.05;
  std::printf("exact %.9f, one Newton step %.4f\n", exact.fractions()[0], newton.fractions()[0]);
  return updated && right ? 0 : 1;
}
