// SPDX-License-Identifier: MIT
#ifndef PHIMIS_TESTS_REFUSES_HPP
#define PHIMIS_TESTS_REFUSES_HPP

#include "catch.hpp"

#include <stdexcept>
#include <string>

/// That an action throws std::invalid_argument with the parameter, the rule that it broke, and its value.
template <class Action>
void refuses(const Action& action, const std::string& parameter, const std::string& rule, const std::string& value) {
  std::string message = "nothing was thrown";
  try {
    action();
  } catch (const std::invalid_argument& error) {
    message = error.what();
  }
  INFO(message);
  const std::string wanted = "phimis: " + parameter + " " + rule;
  CHECK(message.substr(0, wanted.size()) == wanted);
  CHECK(message.find(", got " + value) != std::string::npos);
}

#endif  // PHIMIS_TESTS_REFUSES_HPP
