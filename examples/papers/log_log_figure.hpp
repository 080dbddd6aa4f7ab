// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_PAPERS_LOG_LOG_FIGURE_HPP
#define PHIMIS_EXAMPLES_PAPERS_LOG_LOG_FIGURE_HPP

#include <papers/gnuplot.hpp>
#include <papers/report.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace papers {

/// One line of a figure. The key is its name in the data.
struct log_log_curve {
  std::string key;
  std::string title;
  const char* colour;
  std::vector<std::pair<double, double>> points{};
};

/// How errors fall: both axes logarithmic, as wide as the data, and a line of the slope that is to be expected.
struct log_log_figure {
  std::string name, title, caption;
  std::string x_title, y_title;
  double slope;
  std::string slope_title;
  std::string csv_header;
  double y_most = std::numeric_limits<double>::infinity();  ///< what is above is said to be, and not drawn

  captioned_figure operator()(const std::vector<log_log_curve>& curves) const {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    figure drawing{.title = title,
                   .x_title = x_title,
                   .y_title = y_title,
                   .x = {infinity, 0},
                   .y = {infinity, 0},
                   .x_scale = axis_scale::logarithmic,
                   .y_scale = axis_scale::logarithmic};
    std::string csv = csv_header + '\n';
    for (const log_log_curve& c : curves) {
      plot_series series{c.title, "linespoints linewidth 2 pointtype 7 pointsize 0.6", c.colour, {}};
      for (const auto& [x, y] : c.points) {
        drawing.x = {std::min(drawing.x.lower, x), std::max(drawing.x.upper, x)};
        if (y <= y_most) {
          drawing.y = {std::min(drawing.y.lower, y), std::max(drawing.y.upper, y)};
          series.points.emplace_back(x, y);
        }
        char line[200];
        std::snprintf(line, sizeof line, "%s,%.6g,%.6g\n", c.key.c_str(), x, y);
        csv += line;
      }
      if (series.points.size() < c.points.size()) series.title += series.points.empty() ? ", above" : ", partly above";
      if (series.points.empty()) series.points.emplace_back(1, 0);  // an entry of the legend alone
      drawing.series.push_back(std::move(series));
    }
    const double left = drawing.x.lower, right = drawing.x.upper, top = 1.1 * drawing.y.upper;
    drawing.series.push_back({slope_title,
                              "lines linewidth 1.5 dashtype (10,6)",
                              colour::grey,
                              {{left, top}, {right, top * std::pow(right / left, slope)}}});
    drawing.x = {left / 1.1, right * 1.1};
    drawing.y = {std::min(drawing.y.lower, top * std::pow(right / left, slope)) / 1.1, 1.1 * top};
    return {name, caption, drawing, csv};
  }
};

}  // namespace papers

#endif  // PHIMIS_EXAMPLES_PAPERS_LOG_LOG_FIGURE_HPP
