// SPDX-License-Identifier: MIT
#include "catch.hpp"
#include "colour.hpp"
#include "random.hpp"

#include <phimis/analysis/confidence_interval.hpp>
#include <phimis/estimator/control_variates.hpp>
#include <phimis/phimis.hpp>

#include <cmath>
#include <cstddef>
#include <limits>

namespace {

using phimis::analysis::confidence_factor;
using phimis::analysis::confidence_interval;

struct slope {
  double exponent;
  double pdf(double x) const { return x < 0 || x > 1 ? 0 : (exponent + 1) * std::pow(x, exponent); }
  template <phimis::uniform_source Next>
  double sample(Next&& next) const {
    return std::pow(1 - next(), 1 / (exponent + 1));
  }
};
const phimis::technique_set two(slope{0}, slope{2});
double f(double x) { return std::exp(x); }

}  // namespace

TEST_CASE("A confidence factor is the quantile of Student's t, and of the normal distribution without end") {
  // Of tables.
  CHECK(confidence_factor(0.95, 1) == Approx(12.70620474));
  CHECK(confidence_factor(0.95, 4) == Approx(2.776445105));
  CHECK(confidence_factor(0.95, 10) == Approx(2.228138852));
  CHECK(confidence_factor(0.99, 30) == Approx(2.749995654));
  CHECK(confidence_factor(0.95, 1e7) == Approx(1.959964).epsilon(1e-6));
  CHECK(confidence_factor(0.95, std::numeric_limits<double>::infinity()) == Approx(1.959963985));
  CHECK(confidence_factor(0.95, 0.5) == confidence_factor(0.95, 1));
  CHECK(confidence_factor(0.5, 3) == Approx(0.7648923284));
}

TEST_CASE("A confidence interval reaches that many standard errors to each side") {
  const auto run = phimis::integrate(f, two, {.budget = 60, .iterations = 3, .seed = 4});
  const auto bounds = confidence_interval(run);
  const double reach = confidence_factor(0.95, run.degrees_of_freedom) * run.standard_error;
  CHECK(bounds.lower == Approx(run.estimate - reach));
  CHECK(bounds.upper == Approx(run.estimate + reach));
  const auto wide = confidence_interval(run, 0.999);
  CHECK(wide.lower < bounds.lower);
  CHECK(wide.upper > bounds.upper);
}

TEST_CASE("The degrees of freedom of a run are Satterthwaite's of its iterations") {
  for (const double growth : {1.0, 16.0}) {
    const auto run =
        phimis::integrate(f, two, {.budget = 90, .iterations = 4, .growth = growth}, phimis::square_root{});
    double sum = 0, squares = 0, most = 0;
    for (std::size_t b = 0; b < run.trace.size(); ++b) {
      const auto& line = run.trace[b];
      CHECK(line.degrees_of_freedom > 0);
      CHECK(line.degrees_of_freedom <= static_cast<double>(line.samples - 2) + 1e-9);
      const double weight = static_cast<double>(line.samples) * std::sqrt(static_cast<double>(b + 1));
      const double variance = std::pow(weight * line.standard_error, 2);
      sum += variance;
      squares += variance * variance / line.degrees_of_freedom;
      most += line.degrees_of_freedom;
    }
    CHECK(run.degrees_of_freedom == Approx(sum * sum / squares).epsilon(1e-12));
    CHECK(run.degrees_of_freedom <= most);
  }
}

TEST_CASE("Degrees of freedom have no scale, in the sampling models and combinations") {
  const auto scaled = [](double scale, const auto& combination, phimis::sampling_model model) {
    const auto integrand = [scale](double x) { return scale * f(x); };
    return phimis::integrate(integrand, two, {.budget = 100, .iterations = 5, .model = model}, combination)
        .degrees_of_freedom;
  };
  const auto check = [&](const auto& combination) {
    for (const auto model : {phimis::sampling_model::multi_sample, phimis::sampling_model::one_sample}) {
      const double one = scaled(1, combination, model);
      CHECK(one > 1);
      CHECK(one < 100);
      CHECK(scaled(1e-300, combination, model) == Approx(one).epsilon(1e-6));
      CHECK(scaled(1e300, combination, model) == Approx(one).epsilon(1e-6));
    }
  };
  check(phimis::by_count{});
  check(phimis::pooled{});
  check(phimis::cross_fitted_control_variates{});
  check(phimis::pooled_control_variates{});
}

TEST_CASE("A fit to its own samples takes degrees of freedom") {
  phimis::estimator<double, 2> of;
  random_numbers random(3);
  for (int j = 0; j < 21; ++j) of.add(j % 2, random());
  const auto model = phimis::sampling_model::one_sample;
  CHECK(phimis::fitted_degrees_of_freedom(of, model, 0) == 20);
  CHECK(phimis::fitted_degrees_of_freedom(of, model, 1) == 20);
  CHECK(phimis::fitted_degrees_of_freedom(of, model, 3) == Approx(18));
  CHECK(phimis::fitted_degrees_of_freedom(of, model, 21) == 0);
}

TEST_CASE("A colour's interval is by component") {
  const auto grey = [](double x) { return colour<double>{{f(x), 2 * f(x), 0.5 * f(x)}}; };
  const auto run = phimis::integrate(grey, two, {.budget = 60, .iterations = 3, .seed = 4});
  const auto number = phimis::integrate(f, two, {.budget = 60, .iterations = 3, .seed = 4});
  const auto bounds = confidence_interval(run);
  const auto single = confidence_interval(number);
  CHECK(run.degrees_of_freedom == Approx(number.degrees_of_freedom));
  CHECK(bounds.lower[0] == Approx(single.lower));
  CHECK(bounds.lower[1] == Approx(2 * single.lower));
  CHECK(bounds.upper[2] == Approx(0.5 * single.upper));
}

TEST_CASE("Without variance the interval is the estimate, without information the whole line") {
  const auto flat = phimis::integrate([](double) { return 3.0; }, phimis::technique_set(slope{0}), {.budget = 50});
  const auto exact = confidence_interval(flat);
  CHECK(exact.lower == Approx(3).epsilon(1e-14));
  CHECK(exact.upper == Approx(3).epsilon(1e-14));
  CHECK(flat.degrees_of_freedom > 40);
  const auto nothing = phimis::integrate([](double) { return 0.0; }, two, {.budget = 50});
  CHECK(nothing.degrees_of_freedom == 0);
  const auto all = confidence_interval(nothing);
  CHECK(all.lower == -std::numeric_limits<double>::infinity());
  CHECK(all.upper == std::numeric_limits<double>::infinity());
  const auto single = phimis::integrate(f, two, {.budget = 1, .iterations = 1});
  CHECK(single.degrees_of_freedom == 0);
  CHECK(confidence_interval(single).upper == std::numeric_limits<double>::infinity());
}

TEST_CASE("A level outside (0, 1) is refused") {
  for (const double level : {0.0, 1.0, -0.5, 95.0, std::nan("")}) {
    CHECK_THROWS_WITH(confidence_factor(level, 10), contains_text("confidence level"));
  }
  CHECK_THROWS_WITH(confidence_factor(0.95, 0), contains_text("degrees_of_freedom"));
}
