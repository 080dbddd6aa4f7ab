// SPDX-License-Identifier: MIT
// Fractions of no techniques do not sum to one.
// expect: at least one technique is needed
#include <phimis/core.hpp>

phimis::fractions<double, 0> none;
