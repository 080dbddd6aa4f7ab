// SPDX-License-Identifier: MIT
// A technique must say with which density it samples: the concept is named.
// expect: technique<Techniques>|satisfy [^a-z]*technique
#include <phimis/technique/technique_set.hpp>

struct sampler {
  template <phimis::uniform_source Next>
  double sample(Next&& next) const {
    return next();
  }
};

phimis::technique_set<sampler> set{sampler{}};
