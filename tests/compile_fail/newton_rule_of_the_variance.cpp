// SPDX-License-Identifier: MIT
// V[F] has no γ-moment.
// expect: power family
#include <phimis/solver/rules.hpp>

auto rule = phimis::newton_rule(phimis::multi_sample_variance{});
