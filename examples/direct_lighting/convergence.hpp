// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_DIRECT_LIGHTING_CONVERGENCE_HPP
#define PHIMIS_EXAMPLES_DIRECT_LIGHTING_CONVERGENCE_HPP

#include <direct_lighting/table.hpp>
#include <papers/gnuplot.hpp>
#include <papers/report.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <string>
#include <utility>
#include <vector>

// Errors against samples and seconds, both axes logarithmic.

namespace direct_lighting {

/// What a figure shows of one configuration.
struct convergence_point {
  double samples, seconds;
  double rmse, root_relmse;  ///< both fall as the root of the samples
};

struct convergence_curve {
  const char* title;
  const char* colour;
  int techniques;
  const char* method;
  std::vector<convergence_point> points{};
};

/// One figure: `y` against `x`, a line of slope −1/2 beside it.
inline papers::captioned_figure convergence_figure(const std::string& name, const std::string& title,
                                                   const std::string& caption,
                                                   const std::vector<convergence_curve>& curves, const char* x_title,
                                                   double convergence_point::*x, const char* y_title,
                                                   double convergence_point::*y) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  papers::figure figure{.title = title,
                        .x_title = x_title,
                        .y_title = y_title,
                        .x = {infinity, 0},
                        .y = {infinity, 0},
                        .x_scale = papers::axis_scale::logarithmic,
                        .y_scale = papers::axis_scale::logarithmic};
  std::string csv = "techniques,method,x,error\n";
  for (const convergence_curve& c : curves) {
    papers::plot_series series{c.title, "linespoints linewidth 2 pointtype 7 pointsize 0.6", c.colour, {}};
    for (const convergence_point& p : c.points) {
      series.points.emplace_back(p.*x, p.*y);
      figure.x = {std::min(figure.x.lower, p.*x), std::max(figure.x.upper, p.*x)};
      figure.y = {std::min(figure.y.lower, p.*y), std::max(figure.y.upper, p.*y)};
      char line[200];
      std::snprintf(line, sizeof line, "%d,%s,%.6g,%.6g\n", c.techniques, c.method, p.*x, p.*y);
      csv += line;
    }
    figure.series.push_back(std::move(series));
  }
  const double left = figure.x.lower, right = figure.x.upper, top = 1.1 * figure.y.upper;
  figure.series.push_back({"slope −1/2",
                           "lines linewidth 1.5 dashtype (10,6)",
                           papers::colour::grey,
                           {{left, top}, {right, top * std::sqrt(left / right)}}});
  figure.x = {left / 1.1, right * 1.1};
  figure.y = {figure.y.lower / 1.1, 1.1 * top};
  return {name, caption, figure, csv};
}

/// Four figures for each sampler. Runs are for 50 samples; with others, as many as take the same time, at least two.
inline std::vector<papers::captioned_figure> convergence_figures(const study& plates) {
  std::vector<papers::captioned_figure> figures;
  for (const std::string sampler : {"area", "cone"}) {
    std::vector<convergence_curve> curves{{"equal counts, 2 techniques", papers::colour::black, 2, "equal"},
                                          {"Tsallis γ = 0.1, 2 techniques", papers::colour::orange, 2, "tsallis:0.1"},
                                          {"Tsallis γ = 2, 2 techniques", papers::colour::green, 2, "tsallis:2"},
                                          {"default, 2 techniques", papers::colour::blue, 2, "default"},
                                          {"default, 5 techniques", papers::colour::vermillion, 5, "default"}};
    for (const std::int64_t samples : {10, 20, 50, 100, 200, 500, 1000}) {
      std::vector<configuration> wanted;
      for (const convergence_curve& c : curves) wanted.push_back({sampler, c.techniques, c.method, samples});
      study at = plates;
      at.runs = std::max(2, static_cast<int>(plates.runs * 50 / samples));
      const auto measured = at.measure(wanted, sampler + ", " + std::to_string(samples) + " samples");
      for (std::size_t i = 0; i < curves.size(); ++i) {
        const render::image_error error = measured[i].error();
        curves[i].points.push_back(
            {static_cast<double>(samples), measured[i].seconds, error.rmse, std::sqrt(error.relmse)});
      }
    }
    const std::string title =
        "Direct lighting, " + sampler + " sampling: errors fall alike, five techniques start lower";
    const auto draw = [&](const std::string& error, const char* file, const char* y_title,
                          double convergence_point::*y) {
      const std::string name = "direct_lighting_" + sampler + '_' + file;
      const std::string caption = error + " with " + sampler + " sampling, against ";
      figures.push_back(convergence_figure(name + "_samples", title, caption + "samples per pixel", curves,
                                           "samples per pixel", &convergence_point::samples, y_title, y));
      figures.push_back(convergence_figure(name + "_seconds", title, caption + "the time of an image", curves,
                                           "time of an image  (s)", &convergence_point::seconds, y_title, y));
    };
    draw("RMSE", "rmse", "RMSE  (radiance, √ of the sum over pixels)", &convergence_point::rmse);
    draw("√ relMSE", "relmse", "√ relMSE  (no unit)", &convergence_point::root_relmse);
  }
  return figures;
}

}  // namespace direct_lighting

#endif  // PHIMIS_EXAMPLES_DIRECT_LIGHTING_CONVERGENCE_HPP
