// SPDX-License-Identifier: MIT
// Which rule? One integrand, every rule: N·MSE of 500 samples in 5 iterations in units of the least V[F], the fraction of
// technique 1 that was learnt, what a sample then costs where technique 2 costs three times as much as technique 1, and
// cost × N·MSE, whose inverse is the efficiency.
//
// test: 200
#include "papers/tsallis_problems.hpp"

#include <phimis/analysis/optimum.hpp>
#include <phimis/phimis.hpp>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

using problem = papers::tsallis_3;
constexpr phimis::per_technique<double, 2> costs{{1, 3}};
int runs = 4000;
bool unbiased = true;

template <class Rule, class Heuristic = phimis::balance>
void measure(const char* name, const Rule& rule, const Heuristic& heuristic = {}) {
  static const phimis::analysis::problem oracle(problem::f, problem::techniques(), problem::domain());
  static const auto best = phimis::analysis::optimum(phimis::multi_sample_variance{}, oracle).alpha;
  static const double least = phimis::analysis::variance(oracle, best).multi_sample.value;
  const double mu = oracle.mean().value;
  const auto techniques = problem::techniques();
  phimis::moments<double> estimates, squares, first, cost;
  for (int run = 0; run < runs; ++run) {
    const auto result =
        phimis::integrate(problem::f, techniques, {.seed = static_cast<std::uint64_t>(run)}, rule, heuristic);
    estimates.add(result.estimate);
    squares.add((result.estimate - mu) * (result.estimate - mu));
    first.add(result.fractions[0]);
    double spent = 0;
    for (const auto& it : result.trace) {
      for (int k = 0; k < 2; ++k) spent += costs[k] * static_cast<double>(it.counts[k]);
    }
    cost.add(spent / static_cast<double>(result.samples));
  }
  const double mse = static_cast<double>(squares.mean) * 500 / least;
  std::printf("| %s | %.3f | %.3f | %.3f | %.3f |\n", name, first.mean, mse, cost.mean, mse * cost.mean);
  const double z = (estimates.mean - mu) / std::sqrt(estimates.variance() / runs);
  if (std::fabs(z) > 4.5) unbiased = false;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 2 || (argc == 2 && (std::strcmp(argv[1], "--help") == 0 || std::atoi(argv[1]) < 2))) {
    std::puts("usage: which_rule [RUNS]   N·MSE, fractions and cost of every rule, over RUNS >= 2 runs (4000)");
    return argc == 2 && std::strcmp(argv[1], "--help") == 0 ? 0 : 2;
  }
  if (argc == 2) runs = std::atoi(argv[1]);
  using namespace phimis;
  std::puts("| rule | α_1 | N·MSE | cost a sample | cost × N·MSE |\n|---|---|---|---|---|");
  measure("fixed_rule, equal counts", fixed_rule<2>());
  measure("inverse_variance_rule", inverse_variance_rule<2>());
  measure("sigma_rule, count_independent weights", sigma_rule<2>(), count_independent<balance>{});
  measure("second_order_rule", second_order_rule<2>());
  measure("newton_rule, Kullback–Leibler, the paper's", newton_rule(kullback_leibler{}, newton_form::paper));
  measure("newton_rule, Kullback–Leibler", newton_rule(kullback_leibler{}));
  measure("newton_rule, χ²", newton_rule(chi_squared{}));
  measure("streaming_rule, Kullback–Leibler", streaming_rule<2>(kullback_leibler{}));
  measure("streaming_rule, χ²", streaming_rule<2>(chi_squared{}));
  measure("linear_rule", linear_rule<2>());
  measure("exact_rule, Kullback–Leibler", exact_rule(kullback_leibler{}));
  measure("exact_rule, χ², prior 1", exact_rule(chi_squared{}, {.prior = 1}));
  measure("exact_rule, V[F]", exact_rule(multi_sample_variance{}));
  measure("inverse_variance_rule with costs", inverse_variance_rule<2>({.costs = costs}));
  measure("sigma_rule with costs, count_independent weights", sigma_rule<2>({.costs = costs}),
          count_independent<balance>{});
  measure("exact_rule, χ² with costs", exact_rule(chi_squared{}, {.prior = 1, .costs = costs}));
  measure("exact_rule, V[ℱ] with costs", exact_rule(one_sample_variance{}, {.costs = costs}));
  measure("exact_rule, V[F] with costs", exact_rule(multi_sample_variance{}, {.costs = costs}));
  return unbiased ? 0 : 1;
}
