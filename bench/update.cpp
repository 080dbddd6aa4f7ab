// SPDX-License-Identifier: MIT
// How long does an update take? Beside each a limit: a loop that reads the same columns once and divides once a row.
// `ratio` is the time over that limit's, medians of repetitions in turn.
//
// Names are rule/gamma/real/m/n. `evaluation` is the optimality condition of all techniques at one α (of two, with its
// slope); `exact` an update after a fifth more observations; the others observe n samples and update.

#include <phimis/core.hpp>
#include <phimis/core/mixture_sums.hpp>
#include <phimis/solver/rules.hpp>

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <functional>
#include <memory>
#include <random>
#include <vector>

namespace {

using index = std::ptrdiff_t;

/// Samples of the equal mixture of M Gaussians on [0, 10], and a smooth integrand.
template <class Real, int M>
struct samples {
  std::vector<phimis::observation<Real, M>> observations;
  phimis::table<Real, M> rows;

  explicit samples(index n) {
    std::mt19937_64 engine(7);
    for (index j = 0; j < n; ++j) {
      const double x = 10 * phimis::uniform(engine());
      phimis::observation<Real, M> sample{static_cast<Real>(std::sqrt(x) + 1), {}, 0, static_cast<int>(j % M)};
      double q = 0;
      for (int k = 0; k < M; ++k) {
        const double width = 1 + k % 3;
        const double z = (x - 10 * (k + 0.5) / M) / width;
        const double pdf = std::exp(-z * z / 2) / width + 1e-3;
        sample.pdfs[k] = static_cast<Real>(pdf);
        q += pdf / M;
      }
      sample.q = static_cast<Real>(q);
      observations.push_back(sample);
      phimis::row<Real, M> row;
      if (phimis::to_row(sample, row)) rows.push(row);
    }
  }

  index size() const { return rows.size(); }
  phimis::column_pointers<Real> pointers() const {
    const phimis::columns<Real, M> view = rows.view();
    std::copy_n(view.y, M, columns_);
    return {view.u, view.w, columns_, view.n, M};
  }

 private:
  mutable const Real* columns_[M];
};

/// One set is kept: they are made anew for the next size.
template <class Real, int M>
const samples<Real, M>& some_samples(index n) {
  static std::unique_ptr<samples<Real, M>> kept;
  if (!kept || kept->size() != n) {
    kept.reset();
    kept = std::make_unique<samples<Real, M>>(n);
  }
  return *kept;
}

/// The least that any update must do.
template <class Real, int M>
struct limit_terms {
  static constexpr bool packed = true;
  phimis::columns<Real, M> rows;
  template <class V>
  void add(index j, V (&sums)[1]) const noexcept {
    using phimis::detail::load;
    V p = load<V>(rows.y[0] + j);
    for (int k = 1; k < M; ++k) p += load<V>(rows.y[k] + j);
    sums[0] += load<V>(rows.w + j) * load<V>(rows.u + j) / p;
  }
};

template <class Real, int M>
double read_and_divide(const phimis::columns<Real, M>& rows) {
  double total[1] = {};
  phimis::detail::sum_rows<1, Real>(0, rows.n, limit_terms<Real, M>{rows}, total);
  return total[0];
}

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<index>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

template <class Work>
double seconds_of(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// So many repetitions that a clock can time them.
index repeats_of(index n, int m) { return std::max<index>(1, 40000 / (n * m)); }

/// Times work(prepare()) in turns with the limit.
template <class Real, int M, class Prepare, class Work>
void measure(benchmark::State& state, index n, const Prepare& prepare, const Work& work, const int& evaluations) {
  const auto& on = some_samples<Real, M>(n);
  const index repeats = repeats_of(n, M);
  std::vector<double> times;
  std::vector<double> limits;
  for (auto _ : state) {
    auto prepared = prepare();
    times.push_back(seconds_of([&] { work(prepared); }));
    limits.push_back(seconds_of([&] {
      for (index i = 0; i < repeats; ++i) benchmark::DoNotOptimize(read_and_divide(on.rows.view()));
    }));
  }
  const double time = median(times);
  state.counters["ns_per_row"] = 1e9 * time / static_cast<double>(repeats * n);
  state.counters["ratio"] = time / median(limits);
  state.counters["gb_per_s"] = static_cast<double>(repeats * n) * (M + 2) * sizeof(Real) / time / 1e9;
  state.counters["evaluations"] = evaluations;
}

template <class Real, int M, class Divergence>
void evaluation(benchmark::State& state, const Divergence& divergence, index n) {
  const auto& on = some_samples<Real, M>(n);
  const index repeats = repeats_of(n, M);
  measure<Real, M>(
      state, n, [] { return 0; },
      [&](int) {
        for (index i = 0; i < repeats; ++i) {
          if constexpr (M == 2) {
            const phimis::pair_point<Real> at{{Real(0.3), Real(0.7)}, {1, 1}, Real(0.1), 1};
            benchmark::DoNotOptimize(phimis::sum_pair(divergence, on.rows.view(), at));
          } else {
            std::vector<double> beta(M, 1.0 / M);
            std::vector<double> sums(2 * M + 1);
            const auto rows = on.pointers();
            phimis::with_mixture_sums(divergence, rows, beta.data(), 0.1, true, 1,
                                      [&](const auto& at) { at.gradient(sums.data()); });
            benchmark::DoNotOptimize(sums.data());
          }
        }
      },
      1);
}

/// A whole update of the exact minimiser, whose last saw four fifths of the observations.
template <class Real, int M, class Divergence>
void exact(benchmark::State& state, const Divergence& divergence, index n) {
  const auto& on = some_samples<Real, M>(n);
  auto rule = phimis::exact_rule<M, Divergence, Real>(divergence);
  for (index j = 0; j < n; ++j) {
    if (j == n * 4 / 5) rule.update();
    rule.observe(on.observations[static_cast<std::size_t>(j)]);
  }
  const std::vector before(static_cast<std::size_t>(repeats_of(n, M)), rule);
  int evaluations = 0;
  measure<Real, M>(
      state, n, [&] { return before; },
      [&](auto& rules) {
        for (auto& each : rules) benchmark::DoNotOptimize(each.update());
        evaluations = rules.front().evaluations();
      },
      evaluations);
}

/// Every observation, then the update.
template <class Real, int M, class Rule>
void streaming(benchmark::State& state, const Rule& fresh, index n) {
  const auto& on = some_samples<Real, M>(n);
  measure<Real, M>(
      state, n, [&] { return fresh; },
      [&](Rule& rule) {
        for (index i = 0; i < repeats_of(n, M); ++i) {
          for (const auto& sample : on.observations) rule.observe(sample);
          benchmark::DoNotOptimize(rule.update());
        }
      },
      0);
}

/// rule/gamma/real/m/n
void add(const char* rule, const char* gamma, const char* real, int m, index n,
         const std::function<void(benchmark::State&)>& run) {
  char name[128];
  std::snprintf(name, sizeof name, "%s/%s/%s/%d/%td", rule, gamma, real, m, n);
  // A tenth of a second or less each, but for the largest.
  const index work = std::max<index>(n, 1000) * m;
  const auto iterations = std::clamp<index>(4000000 / work, 3, 200);
  benchmark::RegisterBenchmark(name, run)->Iterations(iterations);
}

template <class Real, int M>
void register_rules(const char* real, index most) {
  for (index n = 10; n <= most; n *= 10) {
    for (const double gamma : {0.5, 1.0, 2.0, 1.5}) {
      char text[16];
      std::snprintf(text, sizeof text, "%g", gamma);
      const phimis::tsallis divergence{gamma};
      add("evaluation", text, real, M, n, [=](auto& state) { evaluation<Real, M>(state, divergence, n); });
      add("exact", text, real, M, n, [=](auto& state) { exact<Real, M>(state, divergence, n); });
      add("streaming_newton", text, real, M, n, [=](auto& state) {
        streaming<Real, M>(state, phimis::streaming_rule<M, phimis::tsallis, Real>(divergence), n);
      });
      if constexpr (M == 2) {
        add("newton_raphson", text, real, M, n, [=](auto& state) {
          streaming<Real, M>(state, phimis::newton_rule<phimis::tsallis, Real>(divergence), n);
        });
      }
    }
    const auto add_plain = [&](const char* name, const auto& rule) {
      add(name, "-", real, M, n, [=](auto& state) { streaming<Real, M>(state, rule, n); });
    };
    if constexpr (M < 31) {  // its faces are the bits of an int
      add_plain("linear_heuristic", phimis::linear_rule<M, phimis::negative_fractions::drop_most_negative, Real>());
    }
    add_plain("sigma_proportional", phimis::sigma_rule<M, Real>());
    add_plain("inverse_variance", phimis::inverse_variance_rule<M, Real>());
    add_plain("second_order", phimis::second_order_rule<M, Real>());
  }
}

template <class Real>
void register_all(const char* real) {
  register_rules<Real, 2>(real, 1000000);
  register_rules<Real, 5>(real, 1000000);
  register_rules<Real, 16>(real, 1000000);
  register_rules<Real, 64>(real, 100000);
}

}  // namespace

int main(int argc, char** argv) {
  register_all<double>("double");
  register_all<float>("float");
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
}
