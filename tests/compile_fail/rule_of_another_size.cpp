// SPDX-License-Identifier: MIT
// A rule of three fractions for two techniques.
// expect: the rule must be for as many techniques as there are
#include <phimis/phimis.hpp>

void run() {
  const phimis::technique_set two(phimis::gaussian(0, 1), phimis::gaussian(1, 1));
  phimis::integrate([](double x) { return x; }, two, {.budget = 100}, phimis::fixed_rule<3>());
}
