// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_RENDER_STUDY_HPP
#define PHIMIS_EXAMPLES_RENDER_STUDY_HPP

#include <render/method.hpp>
#include <render/metrics.hpp>
#include <render/progress.hpp>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace render {

/// What is measured of one configuration.
struct measured_method {
  configuration of;
  std::vector<image_error> errors{};  ///< of each run
  double seconds = 0;                 ///< of one image, mean over the runs

  rendering first_run{};
  image<float> error_map{};  ///< (I−R)²/(R² + 0.01), mean over the runs
  image<float> squares{};    ///< (I−R)², mean over the channels and the runs

  /// Once they are written: those of all methods would take much memory.
  void forget_images() { first_run = {}, error_map = {}, squares = {}; }

  image_error error() const {
    image_error sum;
    for (const image_error& e : errors) sum += e;
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
  std::function<method(const configuration&)> make;
  const image<rgb>& reference;
  int runs;
  std::uint64_t seed;
  int threads;

  /// Renders each configuration in turn, run after run: a machine that slows down slows all of them.
  std::vector<measured_method> measure(const std::vector<configuration>& wanted, const std::string& label) const {
    std::vector<method> methods;
    std::vector<measured_method> measured;
    for (const configuration& one : wanted) {
      methods.push_back(make(one));
      measured.push_back({one});
      measured.back().error_map = image<float>(reference.width, reference.height);
      measured.back().squares = measured.back().error_map;
    }
    progress bar(label, std::int64_t{runs} * static_cast<std::int64_t>(wanted.size()) *
                            tile_count(reference.width, reference.height));
    for (int run = 0; run < runs; ++run) {
      const random_stream random(seed, static_cast<std::uint32_t>(run));
      for (std::size_t m = 0; m < methods.size(); ++m) {
        auto [seconds, current] = timed([&] { return methods[m](random, threads, [&] { bar.advance(); }); });
        measured[m].seconds += seconds / runs;
        measured[m].errors.push_back(compare(current.picture, reference));
        add(relative_error_map(current.picture, reference), measured[m].error_map);
        add(squared_error_map(current.picture, reference), measured[m].squares);
        if (run == 0) measured[m].first_run = std::move(current);
      }
    }
    return measured;
  }

 private:
  void add(const image<float>& errors, image<float>& mean) const {
    for (std::size_t i = 0; i < errors.pixels.size(); ++i) {
      mean.pixels[i] += errors.pixels[i] / static_cast<float>(runs);
    }
  }
};

/// The ratio of two means over the same runs, and its standard error.
///
///     R = ā/b̄,   se² = Σ (a_i − R b_i)² / (n (n−1) b̄²)
struct mean_ratio {
  mean_ratio(const measured_method& of, const measured_method& to, double image_error::*which) {
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

}  // namespace render

#endif  // PHIMIS_EXAMPLES_RENDER_STUDY_HPP
