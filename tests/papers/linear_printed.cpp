// SPDX-License-Identifier: MIT
// The numbers that Sbert & Szirmay-Kalos 2023 prints for its examples with three and four techniques.
#include "catch.hpp"
#include "linear_data.hpp"

#include <papers/comparison.hpp>

#include <cmath>
#include <map>
#include <string>

namespace {

using namespace papers_test;
using phimis::analysis::optimum;
using phimis::analysis::variance;

template <int M>
std::map<std::string, phimis::measured> quantities(const phimis::analysis::problem<M>& on) {
  const auto equal = variance(on, phimis::equal_fractions<double, M>());
  const auto best = optimum(phimis::multi_sample_variance{}, on);
  std::map<std::string, phimis::measured> all{{"mean", on.mean()},
                                              {"equal multi_sample_variance", equal.multi_sample},
                                              {"equal one_sample_variance", equal.one_sample},
                                              {"least multi_sample_variance", variance(on, best.alpha).multi_sample}};
  for (int k = 0; k < M; ++k) {
    all["alpha_" + std::to_string(k + 1) + " of least multi_sample_variance"] = {best.alpha[k], best.error};
  }
  return all;
}

double mass(double mean, double sigma) {
  const phimis::gaussian whole(mean, sigma);
  return whole.invert(3) - whole.invert(-3);
}

}  // namespace

TEST_CASE("The linear heuristic's examples have the values that the paper prints") {
  int agree = 0;
  for (const auto& row : read_data("linear_examples.csv")) {
    const int n = std::stoi(row.at("example"));
    const std::string& quantity = row.at("quantity");
    const std::string& printed = row.at("printed");
    CAPTURE(n, quantity);
    if (quantity.find("normalisation") == 0) continue;
    with_linear_example(n, [&](const auto& on) {
      static std::map<int, std::map<std::string, phimis::measured>> known;
      if (known[n].empty()) known[n] = quantities(on);
      const phimis::measured computed = known[n].at(quantity);
      const double truth = number(row.at("value"));
      const bool fraction = quantity.find("alpha_") == 0;
      CHECK(std::fabs(computed.value - truth) <= (fraction ? 1e-9 * (truth > 0) : 1e-12 * truth));
      if (!fraction) CHECK(within_error(computed, truth, truth));
      if (printed.empty()) return;
      const papers::agreement found = papers::compare(printed, computed.value);
      const bool rounded_twice = n == 6 && quantity == "mean";
      CHECK((found == papers::agreement::none) == rounded_twice);
      agree += found == papers::agreement::none ? 0 : 1;
    });
  }
  CHECK(agree == 11);
}

TEST_CASE("The pdfs of the linear heuristic's examples are normalised on the domain") {
  const auto z = papers::variance_setting::normalisations();
  const std::map<std::string, double> computed{{"4 1", mass(-1.5, 1)},
                                               {"4 2", mass(1.5, 0.75)},
                                               {"4 3", mass(-0.5, 1)},
                                               {"5 1", mass(-1.5, 1)},
                                               {"5 2", mass(1.5, 0.75)},
                                               {"5 3", mass(-0.5, 1)},
                                               {"5 4", mass(0.5, 1)},
                                               {"6 1", z[0]},
                                               {"6 2", z[1]},
                                               {"6 3", z[2]}};
  int compared = 0;
  for (const auto& row : read_data("linear_examples.csv")) {
    if (row.at("quantity").find("normalisation ") != 0) continue;
    const std::string key = row.at("example") + ' ' + row.at("quantity").back();
    CAPTURE(key);
    CHECK(computed.at(key) == Approx(number(row.at("value"))).epsilon(1e-14));
    ++compared;
  }
  CHECK(compared == 10);
}
