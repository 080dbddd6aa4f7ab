// SPDX-License-Identifier: MIT
// One technique has no second equation.
// expect: linear_heuristic needs two techniques to choose from
#include <phimis/core.hpp>

phimis::linear_heuristic<double, 1> rule;
