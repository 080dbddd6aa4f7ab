// SPDX-License-Identifier: MIT
// The exact minimiser solves for two techniques.
// expect: exact_minimiser solves for two techniques
#include <phimis/core.hpp>

phimis::exact_minimiser<phimis::chi_squared, phimis::fixed_table<double, 3, 10>> rule;
