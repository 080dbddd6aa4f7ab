// SPDX-License-Identifier: MIT
// One technique leaves nothing to learn.
// expect: exact_minimiser needs two techniques to choose from
#include <phimis/core.hpp>

phimis::exact_minimiser<phimis::chi_squared, phimis::fixed_table<double, 1, 10>> rule;
