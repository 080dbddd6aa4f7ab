// SPDX-License-Identifier: MIT
#ifndef PHIMIS_ERROR_HPP
#define PHIMIS_ERROR_HPP

#include <sstream>
#include <stdexcept>
#include <string_view>

namespace phimis {

/// Throws std::invalid_argument that names the parameter, the rule and the value, unless the rule holds.
///
///     require(gamma > 0, "gamma", "must be greater than 0", gamma);
///     phimis: gamma must be greater than 0, got -1
template <class Value>
void require(bool holds, std::string_view parameter, std::string_view rule, const Value& value) {
  if (holds) return;
  std::ostringstream message;
  message.precision(17);
  message << "phimis: " << parameter << ' ' << rule << ", got " << value;
  throw std::invalid_argument(message.str());
}

}  // namespace phimis

#endif  // PHIMIS_ERROR_HPP
