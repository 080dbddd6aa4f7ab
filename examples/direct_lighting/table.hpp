// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_DIRECT_LIGHTING_TABLE_HPP
#define PHIMIS_EXAMPLES_DIRECT_LIGHTING_TABLE_HPP

#include <render/metrics.hpp>
#include <render/study.hpp>

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

// Measured methods as lines of a file and as a table.

namespace direct_lighting {

using render::mean_ratio, render::measured_method, render::rendering, render::study, render::timed;

inline constexpr const char* csv_header =
    "sampler,techniques,method,samples_per_pixel,runs,rmse,rmse_ratio,relmse,relmse_ratio,seconds,time_ratio\n";

/// A line of either table, with ratios to `baseline`.
inline std::string csv_row(const measured_method& m, const measured_method& baseline) {
  const render::image_error error = m.error();
  char line[400];
  std::snprintf(line, sizeof line, "%s,%d,%s,%lld,%d,%.6g,%.4f,%.6g,%.4f,%.4g,%.3f\n", m.of.setting.c_str(),
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
      baseline.of.setting.c_str(), static_cast<long long>(baseline.of.samples_per_pixel), baseline.errors.size());
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

#endif  // PHIMIS_EXAMPLES_DIRECT_LIGHTING_TABLE_HPP
