// SPDX-License-Identifier: MIT
#include "middle.hpp"

phimis::fractions<double, 2> middle_fractions() { return phimis::equal_fractions<double, 2>(); }
