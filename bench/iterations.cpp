// SPDX-License-Identifier: MIT
// How should a budget be spread over iterations, and how should these be weighted, without looking at data?
//
//     bench_iterations [--csv FILE] [--runs RUNS]      a Markdown table on standard output
//
// N·MSE of the default rule in units of the oracle's least V[F]; the geometric mean and the worst of the problems whose least
// V[F] is not 0. Given its fractions, an iteration has the variance V[F](α_b)/n_b exactly, and weights that look at no data
// keep iterations uncorrelated: a run gives N Σ w_b² V[F](α_b)/n_b / (Σ w_b)², whose mean over runs is N·MSE, with a hundredth
// of the noise of squared errors.
#include "problems.hpp"

#include <phimis/core/moments.hpp>
#include <phimis/phimis.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <random>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

namespace {

struct plan {
  int iterations;
  double growth;
};
constexpr std::array<plan, 10> plans{
    {{5, 1}, {10, 1}, {25, 1}, {5, 4}, {5, 16}, {5, 64}, {8, 8}, {8, 16}, {8, 64}, {10, 16}}};

/// The weight of a sample of iteration b.
struct weighting {
  const char* name;
  double (*weight)(std::size_t b);
};
constexpr std::array<weighting, 3> weightings{
    {{"by_count", [](std::size_t) { return 1.0; }},
     {"square_root", [](std::size_t b) { return std::sqrt(static_cast<double>(b + 1)); }},
     {"fixed_weights .5, 1", [](std::size_t b) { return b == 0 ? 0.5 : 1.0; }}}};
constexpr std::array<std::int64_t, 3> budgets{50, 500, 5000};

/// Of one plan: N·MSE for each weighting.
template <int M>
std::array<phimis::moments<double>, weightings.size()> measure(const bench::problem<M>& on, std::int64_t budget,
                                                               const plan& of, int runs) {
  const std::vector<std::int64_t> sizes = phimis::iteration_sizes(budget, of.iterations, of.growth, M);
  std::array<phimis::moments<double>, weightings.size()> found;
  for (int run = 0; run < runs; ++run) {
    std::mt19937_64 engine(static_cast<std::uint64_t>(run) + 1);
    auto next = [&] { return phimis::uniform(engine()); };
    auto rule = phimis::exact_rule<M>(phimis::chi_squared{}, {.prior = 1});
    std::array<double, weightings.size()> weights{}, variances{};
    for (std::size_t b = 0; b < sizes.size(); ++b) {
      const auto n = static_cast<double>(sizes[b]);
      const auto drawn = phimis::draw_batch(on.f, on.techniques, rule.fractions(), {sizes[b]}, phimis::balance{},
                                            next, [&](const auto& sample) { rule.observe(sample.observed); });
      rule.update();
      const double variance = on.variance(drawn.fractions);
      for (std::size_t w = 0; w < weightings.size(); ++w) {
        const double weight = n * weightings[w].weight(b);
        weights[w] += weight;
        variances[w] += weight * weight * variance / n;
      }
    }
    for (std::size_t w = 0; w < weightings.size(); ++w) {
      found[w].add(static_cast<double>(budget) * variances[w] / (weights[w] * weights[w]));
    }
  }
  return found;
}

}  // namespace

int main(int argc, char** argv) {
  int runs = 300;
  std::FILE* csv = nullptr;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string_view option = argv[i];
    if (option == "--runs") runs = std::atoi(argv[i + 1]);
    if (option == "--csv") csv = std::fopen(argv[i + 1], "w");
    if (option == "--csv" && csv == nullptr) return std::perror(argv[i + 1]), 1;
  }
  if (runs < 2 || argc % 2 == 0) return std::puts("usage: bench_iterations [--csv FILE] [--runs RUNS]"), 2;
  if (csv) std::fputs("problem,samples,iterations,growth,combination,ratio_to_oracle,standard_error\n", csv);

  struct summary {
    double logarithms = 0;
    int problems = 0;
    double worst = 0;
    std::string where{};
  };
  std::map<std::tuple<std::size_t, std::size_t, std::int64_t>, summary> all;
  bench::for_each_problem([&](const auto& on) {
    if (!(on.least > 0)) return;
    for (const std::int64_t budget : budgets) {
      for (std::size_t p = 0; p < plans.size(); ++p) {
        if (budget / plans[p].iterations < on.best.size()) continue;  // then V[F] is not the variance
        const auto found = measure(on, budget, plans[p], runs);
        for (std::size_t w = 0; w < weightings.size(); ++w) {
          const double ratio = found[w].mean / on.least;
          summary& of = all[{p, w, budget}];
          of.logarithms += std::log(ratio);
          ++of.problems;
          if (ratio > of.worst) of.worst = ratio, of.where = on.name;
          if (csv) {
            std::fprintf(csv, "%s,%lld,%d,%g,\"%s\",%.5g,%.2g\n", on.name, static_cast<long long>(budget),
                         plans[p].iterations, plans[p].growth, weightings[w].name, ratio,
                         std::sqrt(found[w].variance() / runs) / on.least);
          }
        }
      }
    }
  });
  std::puts("| iterations | growth | combination | 50: mean | worst | 500: mean | worst | 5000: mean | worst |");
  std::puts("|---|---|---|---|---|---|---|---|---|");
  int problems = 0;
  for (const auto& [key, of] : all) problems = std::max(problems, of.problems);
  for (std::size_t p = 0; p < plans.size(); ++p) {
    for (std::size_t w = 0; w < weightings.size(); ++w) {
      std::printf("| %d | %g | %s |", plans[p].iterations, plans[p].growth, weightings[w].name);
      for (const std::int64_t budget : budgets) {
        const summary& of = all[{p, w, budget}];
        if (of.problems < problems) {
          std::printf(" – | – |");
        } else {
          std::printf(" %.3f | %.3f (%s) |", std::exp(of.logarithms / of.problems), of.worst, of.where.c_str());
        }
      }
      std::puts("");
    }
  }
  if (csv) std::fclose(csv);
}
