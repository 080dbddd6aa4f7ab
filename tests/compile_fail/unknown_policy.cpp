// SPDX-License-Identifier: MIT
// A policy that integrate() does not know is refused, not ignored: here the divergence in place of a rule.
// expect: a policy of integrate\(\) is a rule, a weight heuristic
#include <phimis/phimis.hpp>

void run() {
  const phimis::technique_set two(phimis::gaussian(0, 1), phimis::gaussian(1, 1));
  phimis::integrate([](double x) { return x; }, two, {.budget = 100}, phimis::chi_squared{});
}
