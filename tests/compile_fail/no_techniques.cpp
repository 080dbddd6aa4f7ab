// SPDX-License-Identifier: MIT
// Nothing to combine.
// expect: at least one technique is needed
#include <phimis/technique/technique_set.hpp>

phimis::technique_set<> none;
