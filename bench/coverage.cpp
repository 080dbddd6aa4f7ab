// SPDX-License-Identifier: MIT
// Do 95 % intervals hold, and how biased is each combination?
//
//     bench_coverage [--csv FILE] [--runs RUNS] [--threads T] [--only PROBLEM]      Markdown tables
//
// RUNS (100000) runs of the default rule with by_count and with square_root, a tenth of it with the other combinations.
// "1.96" is the share of runs whose estimate lies within 1.96 standard errors of the integral, "t" the share of those whose
// analysis::confidence_interval holds it; "below" and "above" are runs whose whole interval lies there. At RUNS = 100000 a
// coverage has a standard error of .07 %. ν is the mean of the degrees of freedom, "claimed" the mean claimed variance over
// the true one; z is the bias in standard errors of the mean over runs. What is wrong by less than 1e-12 of the integral is
// right; where all runs are, "claimed" is 1. Runs are spread over threads in blocks of fixed seeds: the result does not
// depend on the number of threads.
#include "problems.hpp"

#include <phimis/analysis/confidence_interval.hpp>
#include <phimis/core/moments.hpp>
#include <phimis/estimator/control_variates.hpp>
#include <phimis/phimis.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <thread>
#include <vector>

namespace {

std::int64_t runs_wanted = 100000;
unsigned threads = 2;
std::FILE* csv = nullptr;

struct plan {
  std::int64_t budget;
  double growth;
};
constexpr std::array<plan, 4> plans{{{500, 1}, {500, 16}, {50, 1}, {50, 16}}};
constexpr int iterations = 5;

/// What happened in some runs.
struct tally {
  std::int64_t normal = 0;  // held by 1.96 standard errors
  std::int64_t below = 0;   // of those of Student's t
  std::int64_t above = 0;
  phimis::moments<double> off, claimed, cubes, freedom;

  void merge(const tally& other) {
    normal += other.normal;
    below += other.below;
    above += other.above;
    off.merge(other.off);
    claimed.merge(other.claimed);
    cubes.merge(other.cubes);
    freedom.merge(other.freedom);
  }
};

template <int M, class Combination>
tally measure(const bench::problem<M>& on, const plan& of, std::int64_t runs, const Combination& combination) {
  const auto one = [&](tally& to, std::uint64_t seed) {
    const auto run = phimis::integrate(
        on.f, on.techniques, {.budget = of.budget, .iterations = iterations, .growth = of.growth, .seed = seed},
        combination);
    const double slack = 1e-12 * std::fabs(on.mean);
    const double exact = run.estimate - on.mean;
    const double off = std::fabs(exact) <= slack ? 0 : exact;
    const auto bounds = phimis::analysis::confidence_interval(run);
    if (std::fabs(off) <= 1.959963984540054 * run.standard_error) ++to.normal;
    if (bounds.upper < on.mean - slack) ++to.below;
    if (bounds.lower > on.mean + slack) ++to.above;
    to.off.add(off);
    to.claimed.add(run.standard_error * run.standard_error);
    to.cubes.add(off * off * off);
    to.freedom.add(run.degrees_of_freedom);
  };
  constexpr std::int64_t blocks = 64;
  std::vector<tally> of_block(blocks);
  std::atomic<std::int64_t> next = 0;
  const auto work = [&] {
    for (std::int64_t block = next++; block < blocks; block = next++) {
      tally own;
      for (std::int64_t run = block * runs / blocks; run < (block + 1) * runs / blocks; ++run) {
        one(own, static_cast<std::uint64_t>(run) + 1);
      }
      of_block[static_cast<std::size_t>(block)] = own;
    }
  };
  {
    std::vector<std::jthread> others;
    for (unsigned t = 1; t < threads; ++t) others.emplace_back(work);
    work();
  }
  tally total;
  for (const tally& own : of_block) total.merge(own);
  return total;
}

template <int M, class Combination>
void line(const bench::problem<M>& on, const plan& of, std::int64_t runs, const char* name,
          const Combination& combination) {
  const tally found = measure(on, of, runs, combination);
  const auto count = static_cast<double>(runs);
  const auto percent = [&](std::int64_t n) { return 100 * static_cast<double>(n) / count; };
  const double variance = found.off.variance();
  const double skewness = variance > 0 ? found.cubes.mean / std::pow(variance, 1.5) : 0;
  const double z = variance > 0 ? found.off.mean / std::sqrt(variance / count) : 0;
  const double claimed = variance > 0 ? found.claimed.mean / variance : 1;
  std::printf("| %d×%lld | %g | %s | %.2f | %.2f | %.2f | %.2f | %.0f | %.3f | %+.2f | %+.4f %% | %+.1f |\n",
              iterations, static_cast<long long>(of.budget / iterations), of.growth, name, percent(found.normal),
              100 - percent(found.below + found.above), percent(found.below), percent(found.above),
              found.freedom.mean, claimed, skewness, 100 * found.off.mean / on.mean, z);
  std::fflush(stdout);
  if (!csv) return;
  std::fprintf(csv, "%s,%d,%lld,%g,%s,%lld,%.6g,%.6g,%.6g,%.6g,%.4g,%.4g,%.3g,%.4g,%.3g\n", on.name, iterations,
               static_cast<long long>(of.budget), of.growth, name, static_cast<long long>(runs),
               percent(found.normal) / 100, 1 - percent(found.below + found.above) / 100, percent(found.below) / 100,
               percent(found.above) / 100, found.freedom.mean, claimed, skewness, found.off.mean / on.mean, z);
  std::fflush(csv);
}

template <int M>
void table(const bench::problem<M>& on) {
  std::printf("\n### %s\n\n", on.name);
  std::puts("| samples | growth | combination | 1.96 | t | below | above | ν | claimed | skewness | bias | z |");
  std::puts("|---|---|---|---|---|---|---|---|---|---|---|---|");
  const std::int64_t fewer = std::max<std::int64_t>(2, runs_wanted / 10);
  for (const plan& of : plans) {
    line(on, of, runs_wanted, "by_count", phimis::by_count{});
    line(on, of, runs_wanted, "square_root", phimis::square_root{});
    line(on, of, fewer, "fixed_weights .15 .8 1", phimis::fixed_weights({.15, .8, 1}));
    line(on, of, fewer, "inverse_variance", phimis::inverse_variance{});
    line(on, of, fewer, "pooled", phimis::pooled{});
    line(on, of, fewer, "progressive_control_variates", phimis::progressive_control_variates{});
    line(on, of, fewer, "cross_fitted_control_variates", phimis::cross_fitted_control_variates{});
    line(on, of, fewer, "pooled_control_variates", phimis::pooled_control_variates{});
  }
}

int usage() {
  std::puts("usage: bench_coverage [--csv FILE] [--runs RUNS] [--threads T] [--only PROBLEM]");
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  std::string_view only;
  for (int i = 1; i < argc; i += 2) {
    const std::string_view option = argv[i];
    if (i + 1 == argc) return usage();
    if (option == "--csv") {
      csv = std::fopen(argv[i + 1], "w");
      if (csv == nullptr) return std::perror(argv[i + 1]), 1;
    } else if (option == "--runs") {
      runs_wanted = std::atoll(argv[i + 1]);
    } else if (option == "--threads") {
      threads = static_cast<unsigned>(std::atoi(argv[i + 1]));
    } else if (option == "--only") {
      only = argv[i + 1];
    } else {
      return usage();
    }
  }
  if (runs_wanted < 2 || threads < 1) return usage();
  if (csv) {
    std::fputs(
        "problem,iterations,samples,growth,combination,runs,covered_by_196,covered_by_t,below,above,freedom,"
        "claimed_over_true,skewness,relative_bias,bias_z\n",
        csv);
  }
  const auto receive = [&](const auto& on) {
    if (only.empty() || only == on.name) table(on);
  };
  receive(bench::tsallis_1());
  receive(bench::tsallis_2());
  receive(bench::tsallis_3());
  receive(bench::linear_4());
  receive(bench::linear_5());
  auto linear_6 = bench::variance_2();
  linear_6.name = "L6";
  receive(linear_6);
  if (csv) std::fclose(csv);
}
