// SPDX-License-Identifier: MIT
// A random engine returns bits; what it must be wrapped in is named.
// expect: satisf[a-z]* (of )?[^a-z]*uniform_source
#include <phimis/technique/gaussian.hpp>

#include <random>

std::mt19937_64 engine;
double x = phimis::gaussian(0, 1).sample(engine);
