// SPDX-License-Identifier: MIT
// The numbers that Sbert, Havran & Szirmay-Kalos 2016 print in App. A.
#include "catch.hpp"
#include "variance_data.hpp"

#include <papers/comparison.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

using namespace papers_test;

namespace {

/// Whether a quantity depends on V[G_3] of examples 3 and 4, cut off at the double nearest to π: the reference takes the
/// cut that gives the printed 9586.73 exactly.
bool depends_on_cut(const std::string& example, const std::string& name) {
  return (example == "V3" || example == "V4") &&
         (name.find("1/V ") == 0 || name.find("1/cV ") == 0 || name == "quotient of efficiencies");
}

}  // namespace

TEST_CASE("Every number of the variance paper's examples is the reference") {
  for (const auto& row : read_data("variance_numbers.csv")) {
    const std::string& example = row.at("example");
    const std::string& name = row.at("quantity");
    const int k = row.at("technique").empty() ? 0 : std::stoi(row.at("technique")) - 1;
    INFO(example << ' ' << name << ' ' << k + 1);
    const double truth = number(row.at("value"));
    const phimis::measured computed = quantity(variance_example(example), name, k);
    if (!phimis::is_finite(truth)) {
      CHECK(computed.value == truth);
    } else {
      const double digits = depends_on_cut(example, name) ? 1e-6 : 1e-13;
      CHECK(std::fabs(computed.value - truth) <= computed.error + digits * std::fabs(truth));
      CHECK(computed.error <= 1e-12 * std::fabs(truth) + 1e-20);
    }
  }
}

TEST_CASE("The report of the variance paper has every printed number, and says of each whether it is right") {
  const papers::four_studies studies = papers::variance_studies();
  const papers::comparisons table = papers::variance_comparisons(studies);
  std::vector<papers::comparison> left = table.rows();
  for (const auto& row : read_data("variance_printed.csv")) {
    const std::string& printed = row.at("printed");
    const double truth = number(row.at("value"));
    const std::string wanted = row.at("reproduces") == "cut" ? "yes (last digit cut)" : row.at("reproduces");
    INFO(row.at("item") << ", printed " << printed << ", is " << truth);
    const auto found = std::find_if(left.begin(), left.end(), [&](const papers::comparison& one) {
      if (one.printed != printed || one.computed.find_first_not_of("0123456789.e+-inf") != std::string::npos)
        return false;
      const double computed = number(one.computed);
      if (!phimis::is_finite(truth)) return computed == truth;
      return one.agrees() == wanted && std::fabs(computed - truth) <= 1e-6 * std::fabs(truth) + 1e-20;
    });
    REQUIRE(found != left.end());
    CHECK(found->agrees() == wanted);
    CHECK(found->as_expected());
    CHECK((wanted != "no" || !found->note.empty()));
    left.erase(found);
  }
  // What is left: the cut V[G_3], and statements.
  for (const papers::comparison& one : left) {
    INFO(one.item << ": " << one.computed);
    CHECK(one.as_expected());
    CHECK((one.printed == "9586.73" || one.expected == papers::expectation::differs));
  }
}

TEST_CASE(
    "V[G_3] of examples 3 and 4 is infinite, and what is printed is the integral up to the double nearest to pi") {
  for (const char* const name : {"V3", "V4"}) {
    const auto& of = variance_example(name);
    CHECK_FALSE(phimis::is_finite(of.alone[2].value));
    CHECK(phimis::is_finite(of.alone[1].value));
    CHECK(of.by_true_variance.alpha[2] == 0);
  }
  CHECK(std::fabs(variance_example("V3").alone_as_printed[2] - 9586.73) <= 0.005);
  CHECK(variance_example("V4").alone_as_printed[2] == Approx(183.941844802254634).epsilon(1e-6));
  // It grows by f(π)² Z for every factor e by which the cut comes nearer to π.
  const auto cut_at = [](double distance) {
    const phimis::interval domain(distance, papers::up_to_rounded_pi::length);
    using namespace papers::up_to_rounded_pi;
    const phimis::analysis::problem<3> on(
        papers::variance_3::f_from_pi,
        phimis::technique_set(phimis::density(linear, domain), phimis::density(quadratic, domain),
                              phimis::density(sine, domain)),
        domain, decades());
    return phimis::analysis::variance_alone(on)[2].value;
  };
  const double z = papers::variance_setting::normalisations()[2];
  const double f = papers::variance_3::f(papers::variance_setting::pi);
  CHECK(cut_at(1e-14) - cut_at(1e-13) == Approx(f * f * z * std::log(10.0)).epsilon(1e-9));
}
