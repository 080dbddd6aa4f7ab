// SPDX-License-Identifier: MIT
#ifndef PHIMIS_TESTS_CATCH_HPP
#define PHIMIS_TESTS_CATCH_HPP

// Catch2, 2.13 or 3.x, under the names of 2.13: TEST_CASE, TEMPLATE_TEST_CASE, CHECK, REQUIRE, Approx, GENERATE, and
// contains_text("...") for CHECK_THROWS_WITH.
#include <string>

#if __has_include(<catch2/catch_test_macros.hpp>)
#include <catch2/catch_approx.hpp>
#include <catch2/catch_template_test_macros.hpp>
#include <catch2/catch_test_macros.hpp>
#include <catch2/generators/catch_generators_all.hpp>
#include <catch2/matchers/catch_matchers.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

using Catch::Approx;

inline auto contains_text(const std::string& text) { return Catch::Matchers::ContainsSubstring(text); }
#else
#include <catch2/catch.hpp>

inline auto contains_text(const std::string& text) { return Catch::Matchers::Contains(text); }
#endif

#endif  // PHIMIS_TESTS_CATCH_HPP
