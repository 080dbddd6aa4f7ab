// SPDX-License-Identifier: MIT
// A host of phimis::phimis: integrates x² + 1 on [0, 1], which is 4/3 times the mixture (¼, ¾) of 3x² and 1.
#include <phimis/phimis.hpp>

#include <boost/math/distributions/beta.hpp>
#include <boost/math/distributions/uniform.hpp>

#include <cmath>
#include <cstdio>

int main() {
  const phimis::technique_set techniques(phimis::distribution(boost::math::beta_distribution<>(3, 1)),
                                         phimis::distribution(boost::math::uniform_distribution<>(0, 1)));
  const auto f = [](double x) { return x * x + 1; };
  const auto result = phimis::integrate(f, techniques, {.budget = 5000, .iterations = 5, .seed = 1});
  const double distance = std::fabs(result.estimate - 4.0 / 3);
  std::printf("%.9f ± %.1e at (%.3f, %.3f)\n", result.estimate, result.standard_error, result.fractions[0],
              result.fractions[1]);
  return distance < 5 * result.standard_error && std::fabs(result.fractions[0] - 0.25) < 0.01 ? 0 : 1;
}
