// SPDX-License-Identifier: MIT
// Measured errors beside the papers': what noise may decide, and what it may not.
#include "catch.hpp"

#include <direct_lighting/printed.hpp>

#include <utility>
#include <vector>

namespace {

using namespace direct_lighting;
using papers::expectation;

/// Runs with these RMSE.
measured_method with_rmse(const std::vector<double>& rmse) {
  measured_method m;
  for (const double e : rmse) m.errors.push_back({.rmse = e});
  return m;
}

const measured_method one = with_rmse({1, 1, 1, 1});

/// Whether the ratio of `m` agrees with 1, and whether that is as it should be.
std::pair<bool, bool> ratio_to_one(const measured_method& m, expectation expected) {
  papers::comparisons table("T");
  add_ratio(table, "item", "1", 1, {m, one, &render::image_error::rmse}, expected, "a reason");
  const papers::comparison& row = table.rows().front();
  if (row.as_expected()) CHECK(row.note.empty() == (row.agrees() == "yes"));
  return {row.agrees() == "yes", row.as_expected()};
}

std::pair<bool, bool> is_larger(const measured_method& m, expectation expected) {
  papers::comparisons table("T");
  const measured_method half = with_rmse({0.5, 0.5, 0.5, 0.6});
  add_order(table, "item", "larger", "", {{&one, &half}, {&m, &one}}, expected, "a reason");
  return {table.rows().front().agrees() == "yes", table.rows().front().as_expected()};
}

using outcome = std::pair<bool, bool>;

}  // namespace

TEST_CASE("A ratio agrees within 5 %, and what is further off by more than noise fails") {
  // Standard errors: 0.001 and 0.05.
  const auto quiet = [](double mean) {
    return with_rmse({mean - 0.00173, mean + 0.00173, mean - 0.00173, mean + 0.00173});
  };
  const auto noisy = [](double mean) {
    return with_rmse({mean - 0.0866, mean + 0.0866, mean - 0.0866, mean + 0.0866});
  };
  for (const double sign : {-1, 1}) {
    CHECK(ratio_to_one(quiet(1 + sign * 0.04), expectation::agrees) == outcome{true, true});
    CHECK(ratio_to_one(quiet(1 + sign * 0.06), expectation::agrees) == outcome{false, false});
    CHECK(ratio_to_one(quiet(1 + sign * 0.06), expectation::differs) == outcome{false, true});
    CHECK(ratio_to_one(quiet(1 + sign * 0.04), expectation::differs) == outcome{true, false});
    CHECK(ratio_to_one(noisy(1 + sign * 0.06), expectation::agrees) == outcome{false, true});
    CHECK(ratio_to_one(noisy(1 + sign * 0.04), expectation::differs) == outcome{true, true});
    CHECK(ratio_to_one(noisy(1 + sign * 0.25), expectation::agrees) == outcome{false, false});
  }
}

TEST_CASE("An order of errors holds where every pair does, and fails where one is reversed by more than noise") {
  CHECK(is_larger(with_rmse({1.1, 1.1, 1.1, 1.2}), expectation::agrees) == outcome{true, true});
  CHECK(is_larger(with_rmse({0.9, 0.9, 0.9, 0.8}), expectation::agrees) == outcome{false, false});
  CHECK(is_larger(with_rmse({0.9, 0.9, 0.9, 0.8}), expectation::differs) == outcome{false, true});
  CHECK(is_larger(with_rmse({0.9, 0.8, 0.9, 1.2}), expectation::agrees) == outcome{false, true});
}
