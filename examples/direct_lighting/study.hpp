// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_DIRECT_LIGHTING_STUDY_HPP
#define PHIMIS_EXAMPLES_DIRECT_LIGHTING_STUDY_HPP

#include <render/image.hpp>
#include <render/metrics.hpp>
#include <render/rgb.hpp>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

namespace direct_lighting {

/// What is said of one configuration.
struct measured_method {
  std::string sampler;
  int techniques;
  std::string method;
  std::int64_t samples_per_pixel;
  int runs;
  render::image_error error;  ///< mean over the runs
  double seconds;             ///< of one image, mean over the runs

  render::image<render::rgb> first_run;
  render::image<float> error_map;  ///< (I−R)²/(R² + 0.01), mean over the runs
};

/// Renders picture(run) for run = 0, 1, ... and compares each with the reference.
template <class Picture>
void measure(measured_method& of, const render::image<render::rgb>& reference, const Picture& picture) {
  of.error = {};
  of.seconds = 0;
  of.error_map = render::image<float>(reference.width, reference.height);
  for (int run = 0; run < of.runs; ++run) {
    const auto begin = std::chrono::steady_clock::now();
    render::image<render::rgb> current = picture(static_cast<std::uint32_t>(run));
    of.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    of.error += render::compare(current, reference);
    const render::image<float> errors = render::relative_error_map(current, reference);
    for (std::size_t i = 0; i < errors.pixels.size(); ++i) {
      of.error_map.pixels[i] += errors.pixels[i] / static_cast<float>(of.runs);
    }
    if (run == 0) of.first_run = std::move(current);
  }
  of.error = of.error / of.runs;
  of.seconds /= of.runs;
}

/// One line per method, with ratios to `baseline`: equal counts of two techniques with the same light sampler.
inline std::string to_csv(const std::vector<measured_method>& methods, const measured_method& baseline) {
  std::string csv =
      "sampler,techniques,method,samples_per_pixel,runs,rmse,rmse_ratio,relmse,relmse_ratio,seconds,time_ratio\n";
  for (const measured_method& m : methods) {
    char line[400];
    std::snprintf(line, sizeof line, "%s,%d,%s,%lld,%d,%.6g,%.4f,%.6g,%.4f,%.4g,%.3f\n", m.sampler.c_str(),
                  m.techniques, m.method.c_str(), static_cast<long long>(m.samples_per_pixel), m.runs, m.error.rmse,
                  m.error.rmse / baseline.error.rmse, m.error.relmse, m.error.relmse / baseline.error.relmse,
                  m.seconds, m.seconds / baseline.seconds);
    csv += line;
  }
  return csv;
}

inline void print_table(const std::vector<measured_method>& methods, const measured_method& baseline) {
  std::puts(
      "| techniques | method | RMSE | ratio | per channel | relMSE | trimmed | seconds "
      "|\n|---|---|---|---|---|---|---|---|");
  for (const measured_method& m : methods) {
    std::printf("| %d | %s | %.2f | %.3f | %.4f | %.4g | %.4g | %.3f |\n", m.techniques, m.method.c_str(),
                m.error.rmse, m.error.rmse / baseline.error.rmse, m.error.rmse_per_channel, m.error.relmse,
                m.error.relmse_trimmed, m.seconds);
  }
}

}  // namespace direct_lighting

#endif  // PHIMIS_EXAMPLES_DIRECT_LIGHTING_STUDY_HPP
