// SPDX-License-Identifier: MIT
// The factories of the sigma, inverse-variance and second-order rules: what they refuse, and in integrate().
#include "catch.hpp"
#include "refuses.hpp"

#include <phimis/phimis.hpp>

#include <cmath>
#include <limits>
#include <string>
#include <type_traits>

namespace {

using phimis::rule_options;
using phimis::rule_status;

constexpr double infinity = std::numeric_limits<double>::infinity();
const double not_a_number = std::numeric_limits<double>::quiet_NaN();
using options3 = rule_options<double, 3>;

template <class Make>
void check_refusals(const Make& make) {
  const auto refuses = [&](const options3& options, const char* parameter, const char* rule, const char* value) {
    ::refuses([&] { make(options); }, parameter, rule, value);
  };
  refuses({.costs = {{1, -2, 1}}}, "costs", "must be finite and greater than 0", "-2");
  refuses({.costs = {{0, 1, 1}}}, "costs", "must be finite and greater than 0", "0");
  refuses({.costs = {{1, 1, not_a_number}}}, "costs", "must be finite and greater than 0", "nan");
  refuses({.costs = {{1, infinity, 1}}}, "costs", "must be finite and greater than 0", "inf");
  refuses({.floors = {{0.5, 0.5, 0.25}}}, "floors", "must sum to at most 1", "1.25");
  refuses({.floors = {{-0.5, 0.5, 0.25}}}, "floors", "must be finite and not negative", "-0.5");
  refuses({.start = {{0.5, 0.5, 0.5}}}, "start", "must sum to 1", "1.5");
  refuses({.prior = -1}, "prior", "must be finite and not negative", "-1");
  CHECK_NOTHROW(make(options3{.floors = {{0.25, 0.25, 0.5}}, .costs = {{1e-300, 1, 1e300}}}));
}

/// x², and three techniques, one of which has most of it.
double square(double x) { return x * x; }
const phimis::interval unit(0, 1);
const phimis::technique_set three(phimis::density([](double) { return 1.0; }, unit),
                                  phimis::density([](double x) { return x; }, unit),
                                  phimis::density([](double x) { return 1 - x; }, unit));

template <class Rule, class... Policies>
void check_run(const Rule& rule, double largest_third, const Policies&... policies) {
  static_assert(phimis::rule<Rule>);
  static_assert(std::is_trivially_copyable_v<Rule>);
  const auto run = phimis::integrate(square, three, {.budget = 3000, .iterations = 6}, rule, policies...);
  CHECK(run.rule.status() == rule_status::updated);
  CHECK(run.rule.counters().observations == 3000);
  CHECK(std::fabs(run.estimate - 1.0 / 3) <= 5 * run.standard_error);
  CHECK(run.standard_error < 0.02);
  CHECK(run.fractions[2] < largest_third);
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    CHECK(run.fractions[k] >= 0.02 / 3 - 1e-16);
    sum += run.fractions[k];
  }
  CHECK(sum == Approx(1).epsilon(1e-14));
}

}  // namespace

TEST_CASE("The sigma rule refuses bad options") {
  check_refusals([](const options3& options) { phimis::sigma_rule<3>(options); });
}

TEST_CASE("The sigma rule refuses a bad heuristic") {
  CHECK_THROWS_WITH(phimis::sigma_rule<3>({}, phimis::cutoff{2}),
                    contains_text("threshold must lie in [0, 1], got 2"));
  CHECK_THROWS_WITH(phimis::sigma_rule<3>({}, phimis::count_independent{phimis::power{-1}}),
                    contains_text("beta must be finite and not negative, got -1"));
  CHECK_THROWS_WITH(phimis::integrate(square, three, phimis::count_independent{phimis::cutoff{2}}),
                    contains_text("threshold must lie in [0, 1], got 2"));
}

TEST_CASE("The inverse-variance rule refuses bad options") {
  check_refusals([](const options3& options) { phimis::inverse_variance_rule<3>(options); });
}

TEST_CASE("The second-order rule refuses bad options") {
  check_refusals([](const options3& options) { phimis::second_order_rule<3>(options); });
}

TEST_CASE("The sigma rule runs in integrate() with the weights it is made for") {
  check_run(phimis::sigma_rule<3>(), 0.4, phimis::count_independent{});
  check_run(phimis::sigma_rule<3>({}, phimis::power{2}), 0.4, phimis::count_independent{phimis::power{2}});
  check_run(phimis::sigma_rule<3>({.costs = {{1, 1, 50}}}), 0.1, phimis::count_independent{});
}

TEST_CASE("The inverse-variance rule runs in integrate()") { check_run(phimis::inverse_variance_rule<3>(), 0.05); }

TEST_CASE("The second-order rule runs in integrate()") { check_run(phimis::second_order_rule<3>(), 0.05); }

TEST_CASE("Fewer observations than are needed leave the fractions of every allocation rule") {
  // Three samples for three techniques: one each.
  const phimis::integrate_options few{.budget = 3, .iterations = 1};
  const auto third = 1.0 / 3;
  const auto sigma = phimis::integrate(square, three, few, phimis::sigma_rule<3>(), phimis::count_independent{});
  CHECK(sigma.rule.status() == rule_status::no_information);
  CHECK(sigma.fractions[1] == third);
  const auto inverse = phimis::integrate(square, three, few, phimis::inverse_variance_rule<3>());
  CHECK(inverse.rule.status() == rule_status::no_information);
  CHECK(inverse.fractions[1] == third);
  const auto zero = phimis::integrate([](double) { return 0.0; }, three, few, phimis::second_order_rule<3>());
  CHECK(zero.rule.status() == rule_status::no_information);
  CHECK(zero.fractions[1] == third);
}
