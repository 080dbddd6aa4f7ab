// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_DIRECT_LIGHTING_CONVERGENCE_HPP
#define PHIMIS_EXAMPLES_DIRECT_LIGHTING_CONVERGENCE_HPP

#include <direct_lighting/table.hpp>
#include <papers/log_log_figure.hpp>
#include <papers/report.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstddef>
#include <string>
#include <vector>

// Errors against samples and seconds, both axes logarithmic.

namespace direct_lighting {

/// What is compared.
struct convergence_curve {
  const char* title;
  const char* colour;
  int techniques;
  const char* method;
};

/// Four figures for each sampler. Runs are for 50 samples; with others, as many as take the same time, at least two.
inline std::vector<papers::captioned_figure> convergence_figures(const study& plates) {
  std::vector<papers::captioned_figure> figures;
  const convergence_curve curves[] = {{"equal counts, 2 techniques", papers::colour::black, 2, "equal"},
                                      {"Tsallis γ = 0.1, 2 techniques", papers::colour::orange, 2, "tsallis:0.1"},
                                      {"Tsallis γ = 2, 2 techniques", papers::colour::green, 2, "tsallis:2"},
                                      {"default, 2 techniques", papers::colour::blue, 2, "default"},
                                      {"default, 5 techniques", papers::colour::vermillion, 5, "default"}};
  for (const std::string sampler : {"area", "cone"}) {
    // Errors that fall as the root of the samples; of each, against samples and against seconds.
    std::array<std::vector<papers::log_log_curve>, 4> of;
    for (const convergence_curve& c : curves) {
      for (auto& one : of) one.push_back({std::to_string(c.techniques) + ',' + c.method, c.title, c.colour});
    }
    for (const std::int64_t samples : {10, 20, 50, 100, 200, 500, 1000}) {
      std::vector<configuration> wanted;
      for (const convergence_curve& c : curves) wanted.push_back({sampler, c.techniques, c.method, samples});
      study at = plates;
      at.runs = std::max(2, static_cast<int>(plates.runs * 50 / samples));
      const auto measured = at.measure(wanted, sampler + ", " + std::to_string(samples) + " samples");
      for (std::size_t i = 0; i < measured.size(); ++i) {
        const render::image_error error = measured[i].error();
        const double errors[] = {error.rmse, std::sqrt(error.relmse)};
        for (std::size_t e = 0; e < 2; ++e) {
          of[2 * e][i].points.emplace_back(static_cast<double>(samples), errors[e]);
          of[2 * e + 1][i].points.emplace_back(measured[i].seconds, errors[e]);
        }
      }
    }
    const char* const names[][3] = {{"RMSE", "rmse", "RMSE  (radiance, √ of the sum over pixels)"},
                                    {"√ relMSE", "relmse", "√ relMSE  (no unit)"}};
    for (std::size_t e = 0; e < 4; ++e) {
      const auto& [error, file, y_title] = names[e / 2];
      const bool time = e % 2 == 1;
      figures.push_back(papers::log_log_figure{
          .name = "direct_lighting_" + sampler + '_' + file + (time ? "_seconds" : "_samples"),
          .title = "Direct lighting, " + sampler + " sampling: errors fall alike, five techniques start lower",
          .caption = error + (" with " + sampler) + " sampling, against " +
                     (time ? "the time of an image" : "samples per pixel"),
          .x_title = time ? "time of an image  (s)" : "samples per pixel",
          .y_title = y_title,
          .slope = -0.5,
          .slope_title = "slope −1/2",
          .csv_header = "techniques,method,x,error"}(of[e]));
    }
  }
  return figures;
}

}  // namespace direct_lighting

#endif  // PHIMIS_EXAMPLES_DIRECT_LIGHTING_CONVERGENCE_HPP
