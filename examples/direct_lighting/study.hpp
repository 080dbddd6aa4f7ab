// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_DIRECT_LIGHTING_STUDY_HPP
#define PHIMIS_EXAMPLES_DIRECT_LIGHTING_STUDY_HPP

#include <direct_lighting/methods.hpp>
#include <render/metrics.hpp>
#include <render/progress.hpp>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

namespace direct_lighting {

/// What is measured of one configuration.
struct measured_method {
  configuration of;
  std::vector<render::image_error> errors{};  ///< of each run
  double seconds = 0;                         ///< of one image, mean over the runs

  rendering first_run{};
  render::image<float> error_map{};  ///< (I−R)²/(R² + 0.01), mean over the runs

  /// Once they are written: those of all methods would take much memory.
  void forget_images() { first_run = {}, error_map = {}; }

  render::image_error error() const {
    render::image_error sum;
    for (const render::image_error& e : errors) sum += e;
    return sum / static_cast<double>(errors.size());
  }
};

/// Seconds that f() takes, and its result.
template <class F>
auto timed(const F& f) {
  const auto begin = std::chrono::steady_clock::now();
  auto result = f();
  return std::pair(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(),
                   std::move(result));
}

/// What all configurations share in a study.
struct study {
  view of;
  const render::image<render::rgb>& reference;
  int runs;
  std::uint64_t seed;
  int threads;

  /// Renders each configuration in turn, run after run: a machine that slows down slows all of them.
  std::vector<measured_method> measure(const std::vector<configuration>& wanted, const std::string& label) const {
    std::vector<method> methods;
    std::vector<measured_method> measured;
    for (const configuration& one : wanted) {
      methods.push_back(make_method(of, one));
      measured.push_back({one});
      measured.back().error_map = render::image<float>(reference.width, reference.height);
    }
    render::progress bar(label, std::int64_t{runs} * static_cast<std::int64_t>(wanted.size()) *
                                    render::tile_count(reference.width, reference.height));
    for (int run = 0; run < runs; ++run) {
      const render::random_stream random(seed, static_cast<std::uint32_t>(run));
      for (std::size_t m = 0; m < methods.size(); ++m) {
        auto [seconds, current] = timed([&] { return methods[m](random, threads, [&] { bar.advance(); }); });
        measured[m].seconds += seconds / runs;
        measured[m].errors.push_back(render::compare(current.picture, reference));
        const render::image<float> errors = render::relative_error_map(current.picture, reference);
        for (std::size_t i = 0; i < errors.pixels.size(); ++i) {
          measured[m].error_map.pixels[i] += errors.pixels[i] / static_cast<float>(runs);
        }
        if (run == 0) measured[m].first_run = std::move(current);
      }
    }
    return measured;
  }
};

/// The ratio of two means over the same runs, and its standard error.
///
///     R = ā/b̄,   se² = Σ (a_i − R b_i)² / (n (n−1) b̄²)
struct mean_ratio {
  mean_ratio(const measured_method& of, const measured_method& to, double render::image_error::*which) {
    const double b = to.error().*which;
    ratio = of.error().*which / b;
    double squares = 0;
    for (std::size_t i = 0; i < of.errors.size(); ++i) {
      const double off = of.errors[i].*which - ratio * (to.errors[i].*which);
      squares += off * off;
    }
    const auto n = static_cast<double>(of.errors.size());
    if (n > 1) standard_error = std::sqrt(squares / (n * (n - 1))) / b;
  }

  double ratio;
  double standard_error = 0;  ///< 0 of a single run, which does not tell it
};

inline constexpr const char* csv_header =
    "sampler,techniques,method,samples_per_pixel,runs,rmse,rmse_ratio,relmse,relmse_ratio,seconds,time_ratio\n";

/// A line of either table, with ratios to `baseline`.
inline std::string csv_row(const measured_method& m, const measured_method& baseline) {
  const render::image_error error = m.error();
  char line[400];
  std::snprintf(line, sizeof line, "%s,%d,%s,%lld,%d,%.6g,%.4f,%.6g,%.4f,%.4g,%.3f\n", m.of.sampler.c_str(),
                m.of.techniques, m.of.method.c_str(), static_cast<long long>(m.of.samples_per_pixel),
                static_cast<int>(m.errors.size()), error.rmse,
                mean_ratio(m, baseline, &render::image_error::rmse).ratio, error.relmse,
                mean_ratio(m, baseline, &render::image_error::relmse).ratio, m.seconds, m.seconds / baseline.seconds);
  return line;
}

inline void print_table(const std::vector<measured_method>& methods, const measured_method& baseline) {
  std::printf(
      "\n%s sampling, %lld samples per pixel, %zu runs; ratios to equal counts of two techniques\n\n"
      "| techniques | method | RMSE | ratio | s.e. | at equal time | per channel | relMSE | ratio | trimmed | "
      "seconds |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|\n",
      baseline.of.sampler.c_str(), static_cast<long long>(baseline.of.samples_per_pixel), baseline.errors.size());
  for (const measured_method& m : methods) {
    const render::image_error error = m.error();
    const mean_ratio rmse(m, baseline, &render::image_error::rmse);
    const mean_ratio relmse(m, baseline, &render::image_error::relmse);
    std::printf("| %d | %s | %.2f | %.3f | %.3f | %.3f | %.4f | %.4g | %.3f | %.4g | %.3f |\n", m.of.techniques,
                m.of.method.c_str(), error.rmse, rmse.ratio, rmse.standard_error,
                rmse.ratio * std::sqrt(m.seconds / baseline.seconds), error.rmse_per_channel, error.relmse,
                relmse.ratio, error.relmse_trimmed, m.seconds);
  }
}

}  // namespace direct_lighting

#endif  // PHIMIS_EXAMPLES_DIRECT_LIGHTING_STUDY_HPP
