// SPDX-License-Identifier: MIT
// A number is no divergence: gamma belongs in tsallis{gamma}.
// expect: satisf[a-z]* (of )?[^a-z]*divergence
#include <phimis/solver/rules.hpp>

auto rule = phimis::exact_rule(0.5);
