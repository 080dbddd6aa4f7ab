// SPDX-License-Identifier: MIT
// How much error for how much time? N·MSE, bias and seconds of every rule and combination, of peers and of oracle fractions.
//
//     bench_error [--csv FILE] [--runs RUNS] [--most SAMPLES] [--threads T] [--only PROBLEM]      Markdown tables
//
// RUNS (2000) runs of 50 and of 500 samples, a tenth and a hundredth of it, at least 50, of 5000 and 50000; rules and
// combinations that are neither default nor recommended get a fifth, and no 50000; nothing has more than SAMPLES. N·MSE is
// printed in units of the oracle's, V[F] at its counts, which is exact; where that vanishes in units of V[F] at equal
// counts, and where that does, too, as it is. Its standard error is that of the mean over runs. Runs are spread over threads
// in blocks of fixed seeds: the result does not depend on the number of threads. Seconds are processor time of a thread
// alone, the median of several groups of runs.
#include "methods.hpp"

#include <phimis/core/moments.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <limits>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace {

constexpr std::array<std::int64_t, 4> budgets{50, 500, 5000, 50000};
std::int64_t runs_wanted = 2000;
std::int64_t most = 50000;
unsigned threads = 2;
std::FILE* csv = nullptr;

/// Of the runs of one method on one problem with one budget.
struct result {
  std::int64_t runs = 0;
  double n_mse = std::numeric_limits<double>::quiet_NaN();
  double n_mse_error = 0;
  double bias_z = 0;
  double seconds = 0;
};

std::int64_t runs_of(std::int64_t budget, bench::kind of) {
  if (budget > most) return 0;
  const std::int64_t least = std::min<std::int64_t>(runs_wanted, 50);
  if (of == bench::kind::other) return budget > 5000 ? 0 : std::max(least, runs_wanted / (budget > 500 ? 50 : 5));
  return std::max(least, runs_wanted / (budget > 5000 ? 100 : budget > 500 ? 10 : 1));
}

/// Processor time of this thread.
double now() {
  std::timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

template <int M>
double seconds_of(const bench::method<M>& by, const bench::problem<M>& on, std::int64_t budget) {
  constexpr std::size_t groups = 5;
  std::array<double, groups> times{};
  const auto each = std::max<std::int64_t>(1, 10000 / budget);
  std::uint64_t seed = 0;
  volatile double sink = 0;
  for (double& time : times) {
    const double start = now();
    for (std::int64_t i = 0; i < each; ++i) sink = by.run(on, budget, ++seed);
    time = (now() - start) / static_cast<double>(each);
  }
  static_cast<void>(sink);
  std::nth_element(times.begin(), times.begin() + groups / 2, times.end());
  return times[groups / 2];
}

template <int M>
result measure(const bench::method<M>& by, const bench::problem<M>& on, std::int64_t budget) {
  struct sums {
    phimis::moments<double> off, squares;
  };
  const std::int64_t runs = runs_of(budget, by.of);
  if (runs == 0) return {};
  constexpr std::int64_t blocks = 64;
  std::vector<sums> of_block(blocks);
  std::atomic<std::int64_t> next = 0;
  const auto work = [&] {
    for (std::int64_t block = next++; block < blocks; block = next++) {
      sums own;
      for (std::int64_t run = block * runs / blocks; run < (block + 1) * runs / blocks; ++run) {
        const double off = by.run(on, budget, static_cast<std::uint64_t>(run) + 1) - on.mean;
        own.off.add(off);
        own.squares.add(static_cast<double>(budget) * off * off);
      }
      of_block[static_cast<std::size_t>(block)] = own;
    }
  };
  {
    std::vector<std::jthread> others;
    for (unsigned t = 1; t < threads; ++t) others.emplace_back(work);
    work();
  }
  sums total;
  for (const sums& own : of_block) {
    total.off.merge(own.off);
    total.squares.merge(own.squares);
  }
  const auto count = static_cast<double>(runs);
  const double spread = std::sqrt(total.off.variance() / count);
  return {runs, total.squares.mean, std::sqrt(total.squares.variance() / count),
          spread > 0 ? total.off.mean / spread : 0, seconds_of(by, on, budget)};
}

/// V[F] at the counts that the oracle's fractions become.
template <int M>
double oracle_of(const bench::problem<M>& on, std::int64_t budget) {
  const auto counts = phimis::split_largest_remainder(on.best, budget);
  phimis::fractions<double, M> alpha{};
  for (int k = 0; k < M; ++k) alpha[k] = static_cast<double>(counts[k]) / static_cast<double>(budget);
  return on.variance(alpha);
}

std::string in_units(const result& of, double unit) {
  if (of.runs == 0) return "–";
  const double ratio = of.n_mse / unit;
  const double error = of.n_mse_error / unit;
  char text[64];
  if (!(ratio < 1000) || ratio < 0.01) {
    std::snprintf(text, sizeof text, "%.2g ± %.1g", ratio, error);
  } else {
    std::snprintf(text, sizeof text, "%.3f ± %.3f", ratio, error);
  }
  return text;
}

/// Without commas, for readers that know no quotes.
std::string in_csv(std::string name) {
  std::replace(name.begin(), name.end(), ',', ';');
  return name;
}

template <int M>
void table(const bench::problem<M>& on) {
  const double equal = on.variance(phimis::equal_fractions<double, M>());
  const bool vanishes = !(on.least > 0);
  std::printf("\n### %s\n\n", on.name);
  std::printf("%d technique%s, %d dimension%s; μ = %.6g, V[F] of equal counts %.4g, least V[F] %.4g, at", M,
              M > 1 ? "s" : "", on.dimensions, on.dimensions > 1 ? "s" : "", on.mean, equal, on.least);
  for (const double a : on.best) std::printf(" %.4f", a);
  std::printf(". N·MSE %s; z is the bias in standard errors.\n\n", vanishes && !(equal > 0) ? "as it is"
                                                                   : vanishes ? "in units of equal counts'"
                                                                              : "in units of the oracle's");
  std::puts("| method | 50 | 500 | 5000 | 50000 | z at 50 | at 500 | at 5000 | μs at 500 |");
  std::puts("|---|---|---|---|---|---|---|---|---|");
  for (const auto& by : bench::methods<M>()) {
    std::printf("| %s |", by.name.c_str());
    std::array<result, budgets.size()> found;
    for (std::size_t i = 0; i < budgets.size(); ++i) {
      found[i] = measure(by, on, budgets[i]);
      const double oracle = oracle_of(on, budgets[i]);
      std::printf(" %s |", in_units(found[i], !vanishes ? oracle : equal > 0 ? equal : 1).c_str());
      if (csv && found[i].runs > 0) {
        std::fprintf(csv, "%s,%s,%lld,%lld,%.5g,%.5g,%.3g,%.4g\n", on.name, in_csv(by.name).c_str(),
                     static_cast<long long>(budgets[i]), static_cast<long long>(found[i].runs), found[i].n_mse,
                     oracle > 0 ? found[i].n_mse / oracle : std::numeric_limits<double>::infinity(), found[i].bias_z,
                     found[i].seconds);
        std::fflush(csv);
      }
    }
    std::printf(" %+.1f | %+.1f | %+.1f | %.1f |\n", found[0].bias_z, found[1].bias_z, found[2].bias_z,
                1e6 * found[1].seconds);
    std::fflush(stdout);
  }
}

int usage() {
  std::puts("usage: bench_error [--csv FILE] [--runs RUNS] [--most SAMPLES] [--threads T] [--only PROBLEM]");
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
    } else if (option == "--most") {
      most = std::atoll(argv[i + 1]);
    } else if (option == "--threads") {
      threads = static_cast<unsigned>(std::atoi(argv[i + 1]));
    } else if (option == "--only") {
      only = argv[i + 1];
    } else {
      return usage();
    }
  }
  if (runs_wanted < 2 || threads < 1) return usage();
  if (csv) std::fputs("problem,method,samples,runs,n_mse,ratio_to_oracle,bias_z,seconds\n", csv);
  bench::for_each_problem([&](const auto& on) {
    if (only.empty() || only == on.name) table(on);
  });
  if (csv) std::fclose(csv);
}
