// SPDX-License-Identifier: MIT
// Bad data at construction: std::invalid_argument that names the parameter, the rule and the value.
#include "catch.hpp"
#include "refuses.hpp"

#include <phimis/analysis/optimum.hpp>
#include <phimis/analysis/problem.hpp>
#include <phimis/phimis.hpp>

#include <boost/math/distributions/exponential.hpp>

#include <cmath>
#include <limits>
#include <string>
#include <utility>

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
const double not_a_number = std::numeric_limits<double>::quiet_NaN();
using phimis::interval;
using phimis::rule_options;

template <class Divergence>
void no_rule_takes(const Divergence& divergence, const std::string& parameter, const std::string& rule,
                   const std::string& value) {
  refuses([&] { phimis::exact_rule(divergence); }, parameter, rule, value);
  refuses([&] { phimis::exact_rule(phimis::reversed{divergence}); }, parameter, rule, value);
  if constexpr (phimis::has_exponent<Divergence>::value) {
    refuses([&] { phimis::newton_rule(divergence); }, parameter, rule, value);
  }
}

void no_rule_takes(const rule_options<double, 2>& options, const std::string& parameter, const std::string& rule,
                   const std::string& value) {
  refuses([&] { phimis::fixed_rule<2>(options); }, parameter, rule, value);
  refuses([&] { phimis::exact_rule(phimis::chi_squared{}, options); }, parameter, rule, value);
  refuses([&] { phimis::newton_rule(phimis::chi_squared{}, phimis::newton_form::paper, options); }, parameter, rule,
          value);
}

const phimis::technique_set two(phimis::gaussian(0, 1, {0, 1}), phimis::gaussian(1, 1, {0, 1}));
double one(double) { return 1; }

template <class... Policies>
void run(const phimis::integrate_options& options, Policies&&... policies) {
  phimis::integrate(one, two, options, std::forward<Policies>(policies)...);
}

struct flat {
  double mass = 1;
  double pdf(double x) const { return x < 0 || x > 1 ? 0 : mass; }
  template <phimis::uniform_source Next>
  double sample(Next&& next) const {
    return next();
  }
};

}  // namespace

TEST_CASE("gamma must be greater than 0") {
  no_rule_takes(phimis::tsallis{0}, "gamma", "must be finite and greater than 0", "0");
  no_rule_takes(phimis::tsallis{-0.5}, "gamma", "must be finite and greater than 0", "-0.5");
}

TEST_CASE("gamma must be a number") {
  no_rule_takes(phimis::tsallis{not_a_number}, "gamma", "must be finite and greater than 0", "nan");
  no_rule_takes(phimis::tsallis{infinity}, "gamma", "must be finite and greater than 0", "inf");
}

TEST_CASE("The order of Pearson-Vajda must be at least 1") {
  no_rule_takes(phimis::pearson_vajda{0.5}, "k", "must be finite and at least 1", "0.5");
  no_rule_takes(phimis::pearson_vajda{not_a_number}, "k", "must be finite and at least 1", "nan");
}

TEST_CASE("Floors must not sum past one") {
  no_rule_takes({.floors = {{0.5, 0.75}}}, "floors", "must sum to at most 1", "1.25");
}

TEST_CASE("Floors must not be negative") {
  no_rule_takes({.floors = {{-0.125, 0}}}, "floors", "must be finite and not negative", "-0.125");
  no_rule_takes({.floors = {{0, not_a_number}}}, "floors", "must be finite and not negative", "nan");
}

TEST_CASE("The start must sum to one") {
  no_rule_takes({.start = {{0.5, 0.25}}}, "start", "must sum to 1", "0.75");
  no_rule_takes({.start = {{0.5, 0.75}}}, "start", "must sum to 1", "1.25");
}

TEST_CASE("The start must not be negative") {
  no_rule_takes({.start = {{1.5, -0.5}}}, "start", "must be finite and not negative", "-0.5");
  no_rule_takes({.start = {{not_a_number, 1}}}, "start", "must be finite and not negative", "nan");
}

TEST_CASE("The prior must not be negative") {
  no_rule_takes({.prior = -1}, "prior", "must be finite and not negative", "-1");
  no_rule_takes({.prior = infinity}, "prior", "must be finite and not negative", "inf");
}

TEST_CASE("Rounding of floors and start that sum to one is no fault") {
  rule_options<double, 10> tenths;
  for (int k = 0; k < 10; ++k) tenths.floors[k] = tenths.start[k] = 0.1;
  CHECK_NOTHROW(phimis::fixed_rule<10>(tenths));
  rule_options<float, 3> thirds;
  for (int k = 0; k < 3; ++k) thirds.floors[k] = thirds.start[k] = 1.0f / 3;
  CHECK_NOTHROW(phimis::fixed_rule<3, float>(thirds));
}

TEST_CASE("Edges of the rules are no fault") {
  CHECK_NOTHROW(phimis::exact_rule(phimis::pearson_vajda{1}));
  CHECK_NOTHROW(phimis::exact_rule(phimis::tsallis{1e-3}));
  CHECK_NOTHROW(phimis::fixed_rule<2>({.start = {{1, 0}}, .floors = {{0.25, 0.75}}}));
  CHECK_NOTHROW(phimis::validate(phimis::power{0}));
  CHECK_NOTHROW(phimis::validate(phimis::cutoff{0}));
  CHECK_NOTHROW(phimis::validate(phimis::cutoff{1}));
}

TEST_CASE("The budget must be at least one sample an iteration") {
  refuses([] { run({.budget = 0}); }, "budget", "must be at least one sample for each of 5 iterations", "0");
  refuses([] { run({.budget = 4, .iterations = 5}); }, "budget", "must be at least one sample for each of 5 iterations", "4");
  refuses([] { run({.budget = -10}); }, "budget", "must be at least one sample for each of 5 iterations", "-10");
}

TEST_CASE("There must be an iteration") {
  refuses([] { run({.iterations = 0}); }, "iterations", "must be at least 1", "0");
  refuses([] { run({.iterations = -1}); }, "iterations", "must be at least 1", "-1");
}

TEST_CASE("The exponent of the power heuristic must not be negative") {
  refuses([] { run({}, phimis::power{-1}); }, "beta", "must be finite and not negative", "-1");
  refuses([] { run({}, phimis::power{infinity}); }, "beta", "must be finite and not negative", "inf");
}

TEST_CASE("The threshold of the cutoff heuristic must lie in [0, 1]") {
  refuses([] { run({}, phimis::cutoff{1.5}); }, "threshold", "must lie in [0, 1]", "1.5");
  refuses([] { run({}, phimis::cutoff{-0.5}); }, "threshold", "must lie in [0, 1]", "-0.5");
  refuses([] { run({}, phimis::cutoff{not_a_number}); }, "threshold", "must lie in [0, 1]", "nan");
}

TEST_CASE("integrate() checks a rule that was made without a check") {
  using newton = phimis::newton_raphson<phimis::tsallis>;
  refuses([] { run({}, newton({-2})); }, "gamma", "must be finite and greater than 0", "-2");
  auto options = phimis::without_floors<double, 2>();
  options.prior = -3;
  refuses([&] { run({}, newton({1}, phimis::newton_form::paper, options)); }, "prior",
          "must be finite and not negative", "-3");
}

TEST_CASE("Fixed weights must be given") {
  refuses([] { phimis::fixed_weights({}); }, "fixed_weights", "must hold at least one weight", "0");
}

TEST_CASE("Fixed weights must not be negative and must not end with 0") {
  refuses([] { phimis::fixed_weights({1, -0.5, 1}); }, "fixed_weights", "must be finite and not negative", "-0.5");
  refuses([] { phimis::fixed_weights({not_a_number, 1}); }, "fixed_weights", "must be finite and not negative", "nan");
  refuses([] { phimis::fixed_weights({1, 0}); }, "fixed_weights", "must end with a weight greater than 0", "0");
}

TEST_CASE("A domain must not be empty") {
  refuses([] { interval(2, 1); }, "interval.upper", "must be greater than interval.lower", "1");
  refuses([] { interval(1, 1); }, "interval.upper", "must be greater than interval.lower", "1");
  refuses([] { interval(not_a_number, 1); }, "interval.upper", "must be greater than interval.lower", "1");
  refuses([] { interval(0, not_a_number); }, "interval.upper", "must be greater than interval.lower", "nan");
}

TEST_CASE("sigma must be greater than 0 and the mean a number") {
  refuses([] { phimis::gaussian(0, 0); }, "sigma", "must be finite and greater than 0", "0");
  refuses([] { phimis::gaussian(0, -1); }, "sigma", "must be finite and greater than 0", "-1");
  refuses([] { phimis::gaussian(0, not_a_number); }, "sigma", "must be finite and greater than 0", "nan");
  refuses([] { phimis::gaussian(infinity, 1); }, "mean", "must be finite", "inf");
}

TEST_CASE("A domain must overlap the support of its distribution and hold some probability") {
  refuses([] { phimis::distribution(boost::math::exponential(1), interval(-3, -1)); }, "domain",
          "must overlap the distribution's support", "-1");
  refuses([] { phimis::gaussian(0, 1, {50, 51}); }, "domain", "must hold some of the distribution's probability", "0");
}

TEST_CASE("A density must not be negative, nor 0 everywhere, nor infinite") {
  refuses([] { phimis::density([](double x) { return x; }, interval(-1, 1)); }, "density", "must not be negative", "-");
  refuses([] { phimis::density([](double) { return 0.0; }, interval(-1, 1)); }, "density",
          "must have a positive integral", "0");
  refuses([] { phimis::density([](double x) { return x > 0.3 ? not_a_number : 1; }, interval(0, 1)); }, "function",
          "must be finite", "0.");
  refuses([] { phimis::density([](double) { return infinity; }, interval(0, 1)); }, "function", "must be finite", "0.");
}

TEST_CASE("The domain of a density and of a problem must be bounded") {
  refuses([] { phimis::density([](double) { return 1.0; }, interval(0, infinity)); }, "domain", "must be bounded", "inf");
  refuses([] { phimis::analysis::problem(one, two, interval()); }, "domain", "must be bounded", "inf");
}

TEST_CASE("A pdf must integrate to one where that is promised") {
  const phimis::technique_set half(flat{1}, flat{0.5});
  refuses([&] { phimis::analysis::problem(one, half, interval(0, 1)); }, "pdf 2",
          "must integrate to 1 over the domain", "0.4999");  // and a last digit
  CHECK_NOTHROW(phimis::analysis::problem(one, half, interval(0, 1), {}, phimis::analysis::normalisation::defective));
}

TEST_CASE("The pdf of a problem must not be negative") {
  const phimis::technique_set negative(flat{1}, flat{-1});
  refuses([&] { phimis::analysis::problem(one, negative, interval(0, 1)); }, "pdf 2", "must not be negative", "0.");
}

TEST_CASE("The integrand of a problem must be finite and not 0 everywhere") {
  const phimis::technique_set sound(flat{}, flat{});
  refuses([&] { phimis::analysis::problem([](double) { return 0.0; }, sound, interval(0, 1)); }, "integrand",
          "must not be 0 everywhere", "0");
  refuses([&] { phimis::analysis::problem([](double) { return not_a_number; }, sound, interval(0, 1)); }, "function",
          "must be finite", "0.");
}

TEST_CASE("The optimum of a divergence that is infinite for every mixture does not exist") {
  const phimis::analysis::problem gap([](double x) { return x < 0.5 ? 0.0 : 1.0; }, phimis::technique_set(flat{}, flat{}),
                                      interval(0, 1), {0.5});
  refuses([&] { phimis::analysis::optimum(phimis::reversed{phimis::kullback_leibler{}}, gap); }, "divergence",
          "is infinite where f = 0 < p", "");
  refuses([&] { phimis::analysis::optimum(phimis::tsallis{-1}, gap); }, "gamma", "must be finite and greater than 0",
          "-1");
}

TEST_CASE("floors must leave room for the frozen techniques") {
  rule_options<double, 2> options{.start = {{0.75, 0.25}}, .floors = {{0, 0.5}}};
  options.frozen[0] = true;
  no_rule_takes(options, "floors", "must leave room for the frozen techniques", "1.25");
}

TEST_CASE("integrate refuses costs of a rule built by hand whose divergence knows nothing of costs") {
  using rule = phimis::exact_minimiser<phimis::total_variation, phimis::table<double, 2>>;
  refuses([] { run({}, rule(phimis::total_variation{}, {.costs = {{1, 2}}})); }, "costs", "must be equal", "2");
}

TEST_CASE("A streaming rule takes a retention between 0 and 1, and a positive power") {
  refuses([] { phimis::streaming_rule<2>(phimis::chi_squared{}, {}, -0.5); }, "retention", "must lie in [0, 1]", "-0.5");
  refuses([] { phimis::streaming_rule<2>(phimis::chi_squared{}, {}, 1.5); }, "retention", "must lie in [0, 1]", "1.5");
  refuses([] { phimis::streaming_rule<2>(phimis::reversed{phimis::chi_squared{}}); }, "divergence",
          "must have a positive power of f/p as its score", "-1");
  refuses([] { phimis::streaming_rule<2>(phimis::tsallis{-1}); }, "gamma", "must be finite and greater than 0", "-1");
  refuses([] { phimis::streaming_rule<2>(phimis::chi_squared{}, {.costs = {{1, 2}}}); }, "costs",
          "must be equal for a rule that knows nothing of costs", "2");
}
