// SPDX-License-Identifier: MIT
// How should iterations become one estimate? Bias and N·MSE of every combination on the three 1-D examples of the
// Tsallis paper, 500 samples a run, in units of the least variance V[F] (example 2: of equal counts).
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

int runs = 4000;
bool unbiased = true;

template <class Paper, class Combination>
void measure(const char* name, const Combination& combination, int iterations, double growth, bool claims_unbiased) {
  const phimis::analysis::problem oracle(Paper::f, Paper::techniques(), Paper::domain());
  const auto variance = [&](auto alpha) { return phimis::analysis::variance(oracle, alpha).multi_sample.value; };
  const double least = variance(phimis::analysis::optimum(phimis::multi_sample_variance{}, oracle).alpha);
  const double unit = least > 1e-20 ? least : variance(phimis::equal_fractions<double, 2>());
  const double mu = oracle.mean().value;
  const auto techniques = Paper::techniques();
  phimis::moments<double> estimates, squares;
  for (int run = 0; run < runs; ++run) {
    const auto seed = static_cast<std::uint64_t>(run);
    const auto result = phimis::integrate(Paper::f, techniques,
                                          {.iterations = iterations, .growth = growth, .seed = seed}, combination);
    estimates.add(result.estimate);
    squares.add((result.estimate - mu) * (result.estimate - mu));
  }
  const double error = std::sqrt(estimates.variance() / runs);
  const double z = (estimates.mean - mu) / error;
  std::printf("| %s | %d | %g | %s | %+.3f %% | %+.1f | %.3f |\n", Paper::name, iterations, growth, name,
              100 * (estimates.mean / mu - 1), z, 500 * squares.mean / unit);
  if (claims_unbiased && std::fabs(z) > 4.5) unbiased = false;
}

template <class Paper>
void measure_all() {
  struct plan {
    int iterations;
    double growth;
  };
  for (const auto& [iterations, growth] : {plan{5, 16}, plan{5, 1}, plan{25, 1}}) {
    measure<Paper>("by_count", phimis::by_count{}, iterations, growth, true);
    measure<Paper>("square_root", phimis::square_root{}, iterations, growth, true);
    measure<Paper>("fixed_weights .15, .8, 1", phimis::fixed_weights({.15, .8, 1}), iterations, growth, true);
    measure<Paper>("inverse_variance", phimis::inverse_variance{}, iterations, growth, false);
    measure<Paper>("pooled", phimis::pooled{}, iterations, growth, false);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 2 || (argc == 2 && (std::strcmp(argv[1], "--help") == 0 || std::atoi(argv[1]) < 2))) {
    std::puts("usage: combinations [RUNS]   bias and N·MSE of every combination, over RUNS >= 2 runs (4000)");
    return argc == 2 && std::strcmp(argv[1], "--help") == 0 ? 0 : 2;
  }
  if (argc == 2) runs = std::atoi(argv[1]);
  std::printf(
      "| example | iterations | growth | combination | bias | in standard errors | N·MSE |\n"
      "|---|---|---|---|---|---|---|\n");
  measure_all<papers::tsallis_1>();
  measure_all<papers::tsallis_2>();
  measure_all<papers::tsallis_3>();
  return unbiased ? 0 : 1;
}
