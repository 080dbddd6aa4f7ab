// SPDX-License-Identifier: MIT
// Control variates are fitted to the variance of the balance heuristic: another weight heuristic is refused.
// expect: control variates go with the balance heuristic
#include <phimis/estimator/control_variates.hpp>
#include <phimis/phimis.hpp>

void run() {
  const phimis::technique_set two(phimis::gaussian(0, 1), phimis::gaussian(1, 1));
  phimis::integrate([](double x) { return x; }, two, phimis::power{}, phimis::pooled_control_variates{});
}
