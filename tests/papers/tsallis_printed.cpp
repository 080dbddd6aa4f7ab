// SPDX-License-Identifier: MIT
// The numbers that Sbert & Szirmay-Kalos 2022 prints in Sec. 7.
#include "catch.hpp"
#include "tsallis_data.hpp"

#include <cstdio>
#include <map>
#include <string>

namespace {

using namespace papers_test;
using phimis::analysis::optimum;
using phimis::analysis::variance;

/// A normal density on the whole line, as the paper prints it: what falls outside the domain is lost.
struct whole_gaussian {
  double mean;
  double sigma;
  double pdf(double x) const { return papers::normal_pdf(x, mean, sigma); }
  template <phimis::uniform_source Next>
  double sample(Next&& next) const {
    return phimis::gaussian(mean, sigma).sample(next);
  }
};

/// A function as printed, not normalised. It cannot be sampled.
template <class Function>
struct printed_function {
  Function function;
  double pdf(double x) const { return function(x); }
  template <phimis::uniform_source Next>
  double sample(Next&& next) const {
    return next();
  }
};
template <class Function>
printed_function(Function) -> printed_function<Function>;

template <class Paper, class First, class Second>
problem as_printed(Paper paper, First first, Second second) {
  return problem(paper.f, phimis::technique_set(first, second), paper.domain(), {},
                 phimis::analysis::normalisation::defective);
}

const problem& printed_example(int n) {
  using namespace papers;
  static const problem all[] = {as_printed(tsallis_1{}, whole_gaussian{2, 1}, whole_gaussian{8, 2}),
                                as_printed(tsallis_2{}, whole_gaussian{-1.5, 1}, whole_gaussian{1.5, 0.75}),
                                as_printed(tsallis_3{}, printed_function{[](double x) { return 2 - x; }},
                                           printed_function{[](double x) { return std::sin(x) * std::sin(x); }})};
  return all[n - 1];
}

std::map<std::string, phimis::measured> quantities(const problem& on) {
  const auto equal = variance(on, phimis::equal_fractions<double, 2>());
  const auto multi = optimum(phimis::multi_sample_variance{}, on);
  const auto one = optimum(phimis::one_sample_variance{}, on);
  const auto at_one = variance(on, one.alpha);
  return {{"mean", on.mean()},
          {"equal multi_sample_variance", equal.multi_sample},
          {"equal one_sample_variance", equal.one_sample},
          {"least multi_sample_variance", variance(on, multi.alpha).multi_sample},
          {"alpha of least multi_sample_variance", {multi.alpha[0], multi.error}},
          {"least one_sample_variance", at_one.one_sample},
          {"alpha of least one_sample_variance", {one.alpha[0], one.error}},
          {"multi_sample_variance at least one_sample_variance", at_one.multi_sample}};
}

/// The number with as many decimals as were printed.
std::string as_printed(double value, const std::string& printed) {
  const auto point = printed.find('.');
  const int decimals = point == std::string::npos ? 0 : static_cast<int>(printed.size() - point - 1);
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

}  // namespace

TEST_CASE("The paper's examples have the values that it prints") {
  int printed = 0;
  for (const auto& row : read_data("tsallis_examples.csv")) {
    const int n = std::stoi(row.at("example"));
    const std::string& pdfs = row.at("pdfs");
    const std::string& quantity = row.at("quantity");
    CAPTURE(n, pdfs, quantity);
    if (quantity.find("normalisation") != std::string::npos) continue;
    static std::map<std::string, std::map<std::string, phimis::measured>> known;
    auto& values = known[pdfs + std::to_string(n)];
    if (values.empty()) values = quantities(pdfs == "whole" ? printed_example(n) : example(n));

    const phimis::measured& computed = values.at(quantity);
    const double truth = number(row.at("value"));
    CHECK(std::fabs(computed.value - truth) <= 1e-12 * std::fabs(truth) + 1e-20);
    CHECK(within_error(computed, truth, std::fabs(truth)));
    if (!row.at("printed").empty()) {
      ++printed;
      CHECK(as_printed(computed.value, row.at("printed")) == row.at("printed"));
    }
  }
  CHECK(printed == 9);
}

TEST_CASE("The pdfs of the paper are normalised on the domain") {
  using phimis::interval;
  const auto mass = [](double mean, double sigma, const interval& domain) {
    const phimis::gaussian whole(mean, sigma);
    return whole.invert(domain.upper()) - whole.invert(domain.lower());
  };
  std::map<std::string, double> z;
  const interval first = papers::tsallis_1::domain();
  const interval second = papers::tsallis_2::domain();
  const interval third = papers::tsallis_3::domain();
  z["1 1"] = mass(2, 1, first);
  z["1 2"] = mass(8, 2, first);
  z["2 1"] = mass(-1.5, 1, second);
  z["2 2"] = mass(1.5, 0.75, second);
  z["3 1"] = phimis::density([](double x) { return 2 - x; }, third).normalisation();
  z["3 2"] = phimis::density([](double x) { return std::sin(x) * std::sin(x); }, third).normalisation();
  for (const auto& row : read_data("tsallis_examples.csv")) {
    if (row.at("quantity").find("normalisation ") != 0) continue;
    const std::string key = row.at("example") + ' ' + row.at("quantity").back();
    CAPTURE(key);
    CHECK(z.at(key) == Approx(number(row.at("value"))).epsilon(1e-14));
  }
}
