// SPDX-License-Identifier: MIT
#include "catch.hpp"
#include "refuses.hpp"

#include <phimis/phimis.hpp>

#include <cmath>
#include <limits>
#include <string>
#include <type_traits>

namespace {

using phimis::linear_rule;
using phimis::negative_fractions;
using phimis::rule_options;

void refuses(const rule_options<double, 3>& options, const std::string& parameter, const std::string& rule,
             const std::string& value) {
  const auto check = [&](auto make) { ::refuses(make, parameter, rule, value); };
  check([&] { linear_rule<3>(options); });
  check([&] { linear_rule<3, negative_fractions::drop_most_negative>(options); });
  check([&] { linear_rule<3, negative_fractions::best_face>(options); });
}

}  // namespace

TEST_CASE("The linear heuristic refuses options that are out of range, and costs") {
  refuses({.floors = {{0.5, 0.75, 0}}}, "floors", "must sum to at most 1", "1.25");
  refuses({.floors = {{-0.125, 0, 0}}}, "floors", "must be finite and not negative", "-0.125");
  refuses({.start = {{0.5, 0.25, 0}}}, "start", "must sum to 1", "0.75");
  refuses({.start = {{1.5, -0.5, 0}}}, "start", "must be finite and not negative", "-0.5");
  refuses({.prior = -1}, "prior", "must be finite and not negative", "-1");
  refuses({.prior = std::numeric_limits<double>::infinity()}, "prior", "must be finite and not negative", "inf");
  refuses({.costs = {{1, 1, 2}}}, "costs", "must be equal for a rule that knows nothing of costs", "2");
  CHECK_NOTHROW(linear_rule<3>({.costs = {{2, 2, 2}}, .frozen = {{true, false, false}}}));
}

TEST_CASE("Every linear heuristic is a rule that integrate() takes") {
  static_assert(phimis::rule<decltype(linear_rule<2>())>);
  static_assert(phimis::rule<decltype(linear_rule<5, negative_fractions::drop_most_negative, float>())>);
  static_assert(phimis::rule<decltype(linear_rule<3, negative_fractions::best_face>())>);
  static_assert(std::is_trivially_copyable_v<decltype(linear_rule<4>())>);
  static_assert(!std::is_trivially_copyable_v<decltype(linear_rule<4, negative_fractions::best_face>())>);

  const phimis::interval domain(0, 1);
  const phimis::technique_set techniques(phimis::density([](double) { return 1.0; }, domain),
                                         phimis::density([](double x) { return x; }, domain),
                                         phimis::density([](double x) { return x * x; }, domain));
  const auto f = [](double x) { return std::exp(x); };
  const auto equal = phimis::integrate(f, techniques, {.budget = 2000}, phimis::fixed_rule<3>());
  const auto check = [&](const auto& rule) {
    const auto learnt = phimis::integrate(f, techniques, {.budget = 2000}, rule);
    CHECK(learnt.rule.status() == phimis::rule_status::updated);
    CHECK(std::fabs(learnt.estimate - (std::exp(1) - 1)) <= 5 * learnt.standard_error);
    CHECK(learnt.standard_error < 0.7 * equal.standard_error);
  };
  check(linear_rule<3>());
  check(linear_rule<3, negative_fractions::drop_most_negative>());
  check(linear_rule<3, negative_fractions::best_face>());
}
