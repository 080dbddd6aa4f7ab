// SPDX-License-Identifier: MIT
// Newton-Raphson on γ-moments has no step for a divergence whose score is not a power.
// expect: power family
#include <phimis/core.hpp>

phimis::newton_raphson<phimis::total_variation> rule;
