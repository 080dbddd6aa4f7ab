// SPDX-License-Identifier: MIT
// How much faster do two threads of the host find the best fractions? A Markdown table on standard output: medians of
// repetitions in turn, to rounding. Both give the same fractions to the last bit, or this ends with 1.

#include "bumps.hpp"

#include <phimis/solver/minimise.hpp>

#include <unsupported/Eigen/CXX11/ThreadPool>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <functional>
#include <vector>

namespace {

/// This thread and one of a pool take parts as they come.
void two_threads(int count, const std::function<void(int)>& part) {
  static Eigen::ThreadPool pool(1);
  std::atomic<int> next{0};
  const auto take = [&] {
    for (int i = next++; i < count; i = next++) part(i);
  };
  Eigen::Barrier ended(1);
  pool.Schedule([&] {
    take();
    ended.Notify();
  });
  take();
  ended.Wait();
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

int main() {
  std::puts("| n | m | one thread, ms | two threads, ms | × |");
  std::puts("|---|---|---|---|---|");
  for (const int n : {100000, 1000000}) {
    for (const int m : {2, 5, 16}) {
      const problem on = some_problem(n, m, 1);
      std::vector<double> times[2];
      Eigen::VectorXd found[2];
      for (int i = 0; i < 11; ++i) {
        for (int s = 0; s < 2; ++s) {
          phimis::minimise_options options;
          if (s == 1) options.run = two_threads;
          const auto start = std::chrono::steady_clock::now();
          found[s] = phimis::minimise(phimis::kullback_leibler{}, on.f, on.pdfs, on.q, options).fractions;
          times[s].push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
        }
      }
      if (found[0] != found[1]) return std::puts("fractions differ"), 1;
      const double one = median(times[0]);
      const double two = median(times[1]);
      std::printf("| %d | %d | %.2f | %.2f | %.2f |\n", n, m, 1e3 * one, 1e3 * two, one / two);
      std::fflush(stdout);
    }
  }
}
