// SPDX-License-Identifier: MIT
#ifndef MIDDLE_HPP
#define MIDDLE_HPP

#include <phimis/core.hpp>

phimis::fractions<double, 2> middle_fractions();

#endif  // MIDDLE_HPP
