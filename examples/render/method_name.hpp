// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_RENDER_METHOD_NAME_HPP
#define PHIMIS_EXAMPLES_RENDER_METHOD_NAME_HPP

#include <charconv>
#include <cmath>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

namespace render {

/// "tsallis:0.5" is of the family tsallis, with γ = 0.5.
struct method_name {
  std::string family;
  double gamma = 0;
};

/// The name of a method among families without and with a γ.
///
/// Errors std::invalid_argument where no method has that name.
inline method_name parse_method(const std::string& text, const std::vector<std::string>& plain,
                                const std::vector<std::string>& of_gamma) {
  std::string known;
  for (const std::string& family : plain) {
    if (text == family) return {text};
    known += (known.empty() ? "" : ", ") + family;
  }
  for (const std::string& family : of_gamma) {
    known += ", " + family + ":G";
    if (text.rfind(family + ':', 0) != 0) continue;
    method_name name{family};
    const char* const end = text.data() + text.size();
    const auto read = std::from_chars(text.data() + family.size() + 1, end, name.gamma);
    if (read.ec == std::errc() && read.ptr == end && name.gamma > 0 && std::isfinite(name.gamma)) return name;
    throw std::invalid_argument("--method " + text + ": " + family + ":G needs a number G > 0");
  }
  throw std::invalid_argument("--method " + text + ": not one of " + known);
}

}  // namespace render

#endif  // PHIMIS_EXAMPLES_RENDER_METHOD_NAME_HPP
