// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_DIRECT_LIGHTING_METHOD_NAME_HPP
#define PHIMIS_EXAMPLES_DIRECT_LIGHTING_METHOD_NAME_HPP

#include <render/method.hpp>

#include <charconv>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

namespace direct_lighting {

/// Its setting is how points of a light are drawn, area or cone; techniques are 2 or 5.
using render::configuration;

/// Whether fractions are learnt.
inline bool learns(const std::string& method) { return method != "brdf" && method != "light" && method != "equal"; }

/// "tsallis:0.5" is of the family tsallis, with γ = 0.5.
struct method_name {
  std::string family;
  double gamma = 0;
};

/// Errors std::invalid_argument where no method has that name.
inline method_name parse_method(const std::string& text) {
  for (const char* const family : {"brdf", "light", "equal", "linear", "default", "variance"}) {
    if (text == family) return {text};
  }
  for (const std::string family : {"tsallis", "newton"}) {
    if (text.rfind(family + ':', 0) != 0) continue;
    method_name name{family};
    const char* const end = text.data() + text.size();
    const auto read = std::from_chars(text.data() + family.size() + 1, end, name.gamma);
    if (read.ec == std::errc() && read.ptr == end && name.gamma > 0 && std::isfinite(name.gamma)) return name;
    throw std::invalid_argument("--method " + text + ": " + family + ":G needs a number G > 0");
  }
  throw std::invalid_argument("--method " + text +
                              ": not one of brdf, light, equal, tsallis:G, newton:G, linear, default, variance");
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
