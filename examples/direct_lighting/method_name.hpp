// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_DIRECT_LIGHTING_METHOD_NAME_HPP
#define PHIMIS_EXAMPLES_DIRECT_LIGHTING_METHOD_NAME_HPP

#include <render/method.hpp>
#include <render/method_name.hpp>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace direct_lighting {

/// Its setting is how points of a light are drawn, area or cone; techniques are 2 or 5.
using render::configuration;

/// Whether fractions are learnt.
inline bool learns(const std::string& method) { return method != "brdf" && method != "light" && method != "equal"; }

using render::method_name;

/// Errors std::invalid_argument where no method has that name.
inline method_name parse_method(const std::string& text) {
  return render::parse_method(text, {"brdf", "light", "equal", "linear", "default", "variance"}, {"tsallis", "newton"});
}

/// Errors std::invalid_argument where nothing can render this, in one line.
inline void check(const configuration& what) {
  const std::string family = parse_method(what.method).family;
  const bool of_two = family == "tsallis" || family == "newton" || family == "linear";
  if (of_two && what.techniques != 2)
    throw std::invalid_argument("--method " + what.method + " is for two techniques");
  if (what.samples_per_pixel < what.techniques) throw std::invalid_argument("--samples: fewer than --techniques");
  if (family == "tsallis" && what.samples_per_pixel > render::most_samples_of_tsallis) {
    throw std::invalid_argument("--method tsallis keeps every sample of a pixel: at most " +
                                std::to_string(render::most_samples_of_tsallis) + " --samples");
  }
}

/// What is compared where nothing else is said: T's Table 1, and more. γ = 2 is the papers' "variance minimisation".
inline std::vector<std::string> methods_of(int techniques) {
  if (techniques == 5) return {"equal", "default"};
  return {"brdf",      "light",       "equal",     "tsallis:0.01", "tsallis:0.1", "tsallis:0.5",
          "tsallis:1", "tsallis:1.5", "tsallis:2", "tsallis:2.5",  "linear",      "default"};
}

}  // namespace direct_lighting

#endif  // PHIMIS_EXAMPLES_DIRECT_LIGHTING_METHOD_NAME_HPP
