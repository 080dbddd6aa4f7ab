// SPDX-License-Identifier: MIT
// How long does an update take? Beside it a limit: a loop that reads the same four columns once and divides once a row.
// `ratio` is the time of one evaluation over that limit's: medians of interleaved repetitions in this run.

#include <phimis/core.hpp>
#include <phimis/solver/rules.hpp>

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <random>
#include <string>
#include <vector>

namespace {

/// Rows of two Gaussians and a smooth integrand.
template <class Real>
phimis::table<Real, 2> some_rows(std::ptrdiff_t n) {
  std::mt19937_64 engine(7);
  phimis::table<Real, 2> rows;
  for (std::ptrdiff_t j = 0; j < n; ++j) {
    const double x = 10 * phimis::uniform(engine());
    const double p1 = std::exp(-(x - 2) * (x - 2) / 2) / 2.5;
    const double p2 = std::exp(-(x - 8) * (x - 8) / 8) / 5;
    phimis::observation<Real, 2> sample{static_cast<Real>(std::sqrt(x) + 1),
                                        {{static_cast<Real>(p1), static_cast<Real>(p2)}},
                                        static_cast<Real>((p1 + p2) / 2),
                                        0};
    phimis::row<Real, 2> row;
    if (phimis::to_row(sample, row)) rows.push(row);
  }
  return rows;
}

/// The least that any update must do.
template <class Real>
struct limit_terms {
  static constexpr bool packed = true;
  phimis::columns<Real, 2> rows;
  template <class V>
  void add(std::ptrdiff_t j, V (&sums)[1]) const noexcept {
    using phimis::detail::load;
    sums[0] += load<V>(rows.w + j) * load<V>(rows.u + j) / (load<V>(rows.y[0] + j) + load<V>(rows.y[1] + j));
  }
};

template <class Real>
double read_and_divide(const phimis::columns<Real, 2>& rows) {
  double total[1] = {};
  phimis::detail::sum_rows<1, Real>(rows.n, limit_terms<Real>{rows}, total);
  return total[0];
}

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The same counters from every benchmark: csv wants them so.
void report(benchmark::State& state, double seconds, double limit, int evaluations, std::ptrdiff_t rows) {
  state.counters["ns_per_row"] = 1e9 * seconds / static_cast<double>(rows);
  state.counters["ratio"] = limit > 0 ? seconds / limit : 0;
  state.counters["evaluations"] = evaluations;
}

template <class Real>
phimis::observation<Real, 2> as_observation(const phimis::row<Real, 2>& row) {
  return {row.u, {{row.y[0], row.y[1]}}, 1 / row.w, 0};
}

/// One evaluation of the optimality condition and its slope, interleaved with the limit; medians of both.
template <class Real>
void one_evaluation(benchmark::State& state, double gamma) {
  using clock = std::chrono::steady_clock;
  const auto rows = some_rows<Real>(state.range(0));
  const phimis::pair_point<Real> at{{Real(0.3), Real(0.7)}, {1, 1}, Real(0.1), 1};
  const auto repeats = std::max<std::ptrdiff_t>(1, 20000 / rows.size());
  std::vector<double> ours;
  std::vector<double> limit;
  for (auto _ : state) {
    const auto start = clock::now();
    for (std::ptrdiff_t i = 0; i < repeats; ++i) {
      benchmark::DoNotOptimize(phimis::sum_pair(phimis::tsallis{gamma}, rows.view(), at));
    }
    const auto middle = clock::now();
    for (std::ptrdiff_t i = 0; i < repeats; ++i) benchmark::DoNotOptimize(read_and_divide(rows.view()));
    const auto end = clock::now();
    ours.push_back(std::chrono::duration<double>(middle - start).count());
    limit.push_back(std::chrono::duration<double>(end - middle).count());
  }
  report(state, median(ours), median(limit), 1, repeats * rows.size());
}

/// Rules whose last update saw four fifths of the rows, in many copies so that a clock can time them.
template <class Rule, class Real>
std::vector<Rule> rules_before_their_update(const Rule& fresh, const phimis::table<Real, 2>& rows) {
  Rule rule = fresh;
  for (std::ptrdiff_t j = 0; j < rows.size(); ++j) {
    if (j == rows.size() * 4 / 5) rule.update();
    rule.observe(as_observation(rows[j]));
  }
  return std::vector<Rule>(static_cast<std::size_t>(std::max<std::ptrdiff_t>(1, 20000 / rows.size())), rule);
}

/// A whole update of the exact minimiser, after a fifth more observations.
template <class Real>
void exact_update(benchmark::State& state, double gamma) {
  using clock = std::chrono::steady_clock;
  const auto rows = some_rows<Real>(state.range(0));
  const auto before = rules_before_their_update(phimis::exact_rule<phimis::tsallis, Real>({gamma}), rows);
  std::vector<double> times;
  int evaluations = 0;
  for (auto _ : state) {
    auto rules = before;
    const auto start = clock::now();
    for (auto& rule : rules) benchmark::DoNotOptimize(rule.update());
    times.push_back(std::chrono::duration<double>(clock::now() - start).count());
    evaluations = rules.front().evaluations();
  }
  report(state, median(times), 0, evaluations, static_cast<std::ptrdiff_t>(before.size()) * rows.size());
}

/// A Newton–Raphson batch: every observation, then the step.
template <class Real>
void newton_update(benchmark::State& state, double gamma) {
  using clock = std::chrono::steady_clock;
  const auto rows = some_rows<Real>(state.range(0));
  const auto repeats = std::max<std::ptrdiff_t>(1, 20000 / rows.size());
  auto rule = phimis::newton_rule<phimis::tsallis, Real>({gamma});
  std::vector<double> times;
  for (auto _ : state) {
    const auto start = clock::now();
    for (std::ptrdiff_t i = 0; i < repeats; ++i) {
      for (std::ptrdiff_t j = 0; j < rows.size(); ++j) rule.observe(as_observation(rows[j]));
      benchmark::DoNotOptimize(rule.update());
    }
    times.push_back(std::chrono::duration<double>(clock::now() - start).count());
  }
  report(state, median(times), 0, 0, repeats * rows.size());
}

template <class Real>
void register_all(const std::string& real) {
  for (const double gamma : {0.5, 1.0, 2.0, 1.5}) {
    const std::string of = "/" + real + "/gamma:" + std::to_string(gamma).substr(0, 3);
    for (const auto n : {10, 100, 1000, 1000000}) {
      benchmark::RegisterBenchmark(("one_evaluation" + of).c_str(), one_evaluation<Real>, gamma)->Arg(n);
      benchmark::RegisterBenchmark(("exact_update" + of).c_str(), exact_update<Real>, gamma)->Arg(n);
      benchmark::RegisterBenchmark(("newton_update" + of).c_str(), newton_update<Real>, gamma)->Arg(n);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  register_all<double>("double");
  register_all<float>("float");
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
}
