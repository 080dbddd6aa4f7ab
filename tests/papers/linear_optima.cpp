// SPDX-License-Identifier: MIT
// The optima of the examples with three and four techniques of Sbert & Szirmay-Kalos 2023, which its figures are held
// against, and what its heuristic finds with infinitely many samples.
#include "catch.hpp"
#include "linear_data.hpp"

#include <papers/linear_study.hpp>

#include <cmath>
#include <string>
#include <type_traits>

namespace {

using namespace papers_test;
using phimis::analysis::optimum;
using phimis::analysis::variance;

template <int M>
auto optimum_of(const std::string& objective, const phimis::analysis::problem<M>& on) {
  if (objective == "multi_sample_variance") return optimum(phimis::multi_sample_variance{}, on);
  if (objective == "one_sample_variance") return optimum(phimis::one_sample_variance{}, on);
  return optimum(phimis::tsallis{std::stod(objective.substr(objective.find(' ')))}, on);
}

}  // namespace

TEST_CASE("Optima of three and four techniques are the reference") {
  const auto rows = read_data("linear_optima.csv");
  REQUIRE(rows.size() == 27);
  for (const auto& row : rows) {
    const int n = std::stoi(row.at("example"));
    const std::string& objective = row.at("objective");
    CAPTURE(n, objective);
    with_linear_example(n, [&](const auto& on) {
      constexpr int M = std::decay_t<decltype(on)>::pdfs::size();
      const auto found = optimum_of(objective, on);
      const auto truth = alphas<M>(row);
      INFO("alpha_1 " << found.alpha[0] << " alpha_2 " << found.alpha[1]);
      CHECK(same_fractions(found.alpha, truth, 1e-9));
      CHECK(found.residual <= 1e-10);
      CHECK(found.local == (objective == "multi_sample_variance"));
      const auto at = variance(on, found.alpha);
      const double multi = number(row.at("multi_sample_variance"));
      const double one = number(row.at("one_sample_variance"));
      CHECK(std::fabs(at.multi_sample.value - multi) <= 1e-8 * multi);
      CHECK(std::fabs(at.one_sample.value - one) <= 1e-8 * one);
    });
  }
}

TEST_CASE("Treatments of negative solutions have their reference limits with infinitely many samples") {
  const auto rows = read_data("linear_limits.csv");
  REQUIRE(rows.size() == 9);
  for (const auto& row : rows) {
    const int n = std::stoi(row.at("example"));
    const std::string& treatment = row.at("treatment");
    CAPTURE(n, treatment);
    with_linear_example(n, [&](const auto& on) {
      constexpr int M = std::decay_t<decltype(on)>::pdfs::size();
      const auto limit = papers::limit_of(on);
      const auto& found = treatment == "none"                 ? limit.solution
                          : treatment == "drop_most_negative" ? limit.dropped
                                                              : limit.best_face;
      INFO("alpha_1 " << found[0] << " alpha_2 " << found[1]);
      // The solution of example 6 is ill-conditioned: its pdfs are nearly dependent.
      CHECK(same_fractions(found, alphas<M>(row), treatment == "none" && n == 6 ? 1e-10 : 1e-12));
      if (treatment == "none") return;
      const double truth = number(row.at("multi_sample_variance"));
      CHECK(std::fabs(papers::variance_at(on, found) - truth) <= 1e-12 * truth);
    });
  }
}

TEST_CASE("With infinitely many samples the projection beats both treatments of the paper") {
  const double least[] = {3.0453634766568966307, 1.7217212956926121549, 4.1944867529034286381};
  // How far above the least V[F]: what was found when it was written, rounded up.
  const double excess[] = {0.0183, 0.0507, 0.0001};
  for (const int n : {4, 5, 6}) {
    CAPTURE(n);
    with_linear_example(n, [&](const auto& on) {
      const auto limit = papers::limit_of(on);
      const double ours = papers::variance_at(on, limit.projected);
      CHECK(ours < papers::variance_at(on, limit.dropped));
      CHECK(ours < papers::variance_at(on, limit.best_face));
      CHECK(ours / least[n - 4] <= 1 + excess[n - 4]);
    });
  }
}
