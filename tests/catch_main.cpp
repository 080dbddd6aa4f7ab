// SPDX-License-Identifier: MIT
// For a Catch2 2.13 that was installed without its compiled main; every other Catch2 brings its own.
#define CATCH_CONFIG_MAIN
#include <catch2/catch.hpp>
