// SPDX-License-Identifier: MIT
// The optima of every divergence of Sbert & Szirmay-Kalos 2022, Sec. 5, on the paper's examples.
#include "catch.hpp"
#include "tsallis_data.hpp"

#include <functional>
#include <map>
#include <string>

namespace {

using namespace papers_test;
using phimis::analysis::divergence_between_kinks;
using phimis::analysis::optimum;
using pair_optimum = phimis::analysis::optimal_fractions<2>;
using phimis::analysis::variance;

/// A divergence without its type.
struct named_divergence {
  std::function<pair_optimum(const problem&)> minimise;
  std::function<phimis::measured(const problem&, const fractions&)> value;
};

template <class Divergence>
named_divergence named(const Divergence& divergence) {
  return {[=](const problem& on) { return optimum(divergence, on); },
          [=](const problem& on, const fractions& alpha) {
            if constexpr (std::is_same_v<Divergence, phimis::multi_sample_variance>) {
              return variance(on, alpha).multi_sample;
            } else {
              return divergence_between_kinks(divergence, on, alpha);
            }
          }};
}

const std::map<std::string, named_divergence>& divergences() {
  using namespace phimis;
  static const std::map<std::string, named_divergence> all{
      {"multi_sample_variance", named(multi_sample_variance{})},
      {"one_sample_variance", named(one_sample_variance{})},
      {"hellinger", named(hellinger{})},
      {"kullback_leibler", named(kullback_leibler{})},
      {"chi_squared", named(chi_squared{})},
      {"reversed hellinger", named(reversed<hellinger>{})},
      {"reversed kullback_leibler", named(reversed<kullback_leibler>{})},
      {"reversed chi_squared", named(reversed<chi_squared>{})},
      {"total_variation", named(total_variation{})},
      {"pearson_vajda 2", named(pearson_vajda{2})},
      {"pearson_vajda 3", named(pearson_vajda{3})},
      {"pearson_vajda 4", named(pearson_vajda{4})},
      {"reversed pearson_vajda 2", named(reversed<pearson_vajda>{{2}})},
      {"reversed pearson_vajda 3", named(reversed<pearson_vajda>{{3}})},
      {"reversed pearson_vajda 4", named(reversed<pearson_vajda>{{4}})}};
  return all;
}

}  // namespace

TEST_CASE("The optimum of every divergence agrees with the reference") {
  const auto rows = read_data("tsallis_optima.csv");
  REQUIRE(rows.size() == 3 * divergences().size());
  for (const auto& row : rows) {
    const int n = std::stoi(row.at("example"));
    const std::string& name = row.at("divergence");
    CAPTURE(n, name);
    const problem& on = example(n);
    const named_divergence& divergence = divergences().at(name);
    const double alpha = number(row.at("alpha"));
    const pair_optimum found = divergence.minimise(on);
    CHECK(std::fabs(found.alpha[0] - alpha) <= 1e-9);
    CHECK(std::fabs(found.alpha[0] - alpha) <= found.error + 1e-13);
    CHECK(found.alpha[0] + found.alpha[1] == Approx(1).epsilon(1e-15));
    CHECK(found.residual <= 1e-10);
    CHECK(found.local == (name == "multi_sample_variance"));

    const double truth_multi = number(row.at("multi_sample_variance"));
    const double truth_one = number(row.at("one_sample_variance"));
    const auto at = variance(on, found.alpha);
    CHECK(std::fabs(at.multi_sample.value - truth_multi) <= 1e-8 * truth_multi + 1e-20);
    CHECK(std::fabs(at.one_sample.value - truth_one) <= 1e-8 * truth_one + 1e-20);

    const std::string& truth_value = row.at("divergence_value");
    if (!truth_value.empty()) {
      const phimis::measured value = divergence.value(on, found.alpha);
      CHECK(std::fabs(value.value - number(truth_value)) <= 1e-13);
      CHECK(within_error(value, number(truth_value), 1));
    }
  }
}

TEST_CASE("Every divergence finds the mixture of zero variance from any start") {
  // g = p(α) at α = Z_1/(Z_1 + 2 Z_2), Z_k the probability of the whole-line Gaussians inside the domain.
  const problem& on = example(2);
  const double alpha = 0.33204571668509524083;
  CHECK(variance(on, fractions{{alpha, 1 - alpha}}).one_sample.value <= 1e-20);
  for (const double start : {0.001, 0.3, 0.999}) {
    CAPTURE(start);
    const phimis::rule_options<double, 2> options{.start = {{start, 1 - start}}};
    CHECK(std::fabs(optimum(phimis::tsallis{0.01}, on, options).alpha[0] - alpha) <= 1e-9);
    CHECK(std::fabs(optimum(phimis::kullback_leibler{}, on, options).alpha[0] - alpha) <= 1e-9);
    CHECK(std::fabs(optimum(phimis::total_variation{}, on, options).alpha[0] - alpha) <= 1e-9);
    CHECK(std::fabs(optimum(phimis::multi_sample_variance{}, on, options).alpha[0] - alpha) <= 1e-9);
    CHECK(std::fabs(optimum(phimis::pearson_vajda{4}, on, options).alpha[0] - alpha) <= 1e-9);
  }
}
