// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_PAPERS_INTEGRAND_FIGURE_HPP
#define PHIMIS_EXAMPLES_PAPERS_INTEGRAND_FIGURE_HPP

#include <papers/gnuplot.hpp>
#include <papers/report.hpp>

#include <phimis/analysis/problem.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace papers {

/// f/μ superimposed on the pdfs of an example.
template <int M>
captioned_figure integrand_figure(const phimis::analysis::problem<M>& on, const std::string& name,
                                  const std::string& caption, const std::string& title,
                                  const std::vector<std::string>& pdf_titles) {
  static_assert(M <= 4, "there are four styles of pdfs");
  const char* const styles[] = {"dashtype (12,5)", "dashtype (3,4)", "dashtype (12,4,3,4)", "dashtype (20,3)"};
  const char* const colours[] = {colour::vermillion, colour::green, colour::purple, colour::orange};
  const auto domain = on.domain();
  std::vector<plot_series> series{{"f / μ", "lines linewidth 4", colour::blue, {}}};
  std::string csv = "x,f_over_mu";
  for (std::size_t k = 0; k < M; ++k) {
    const std::string number = std::to_string(k + 1);
    csv += ",pdf_" + number;
    series.push_back(
        {"p_" + number + ": " + pdf_titles[k], std::string("lines linewidth 2.5 ") + styles[k], colours[k], {}});
  }
  csv += '\n';
  double highest = 0;
  constexpr int steps = 240;
  for (int i = 0; i <= steps; ++i) {
    const double x = std::min(domain.lower() + domain.length() * i / steps, domain.upper());
    const auto pdfs = on.pdfs_at(x);
    std::vector<double> values{x, on.f(x) / on.mean().value};
    values.insert(values.end(), pdfs.begin(), pdfs.end());
    for (std::size_t s = 0; s < series.size(); ++s) {
      series[s].points.emplace_back(x, values[s + 1]);
      highest = std::max(highest, values[s + 1]);
    }
    csv += csv_line(values);
  }
  captioned_figure result;
  result.name = name;
  result.caption = caption;
  result.csv = csv;
  result.drawing = {
      .title = title,
      .x_title = "x  (no unit)",
      .y_title = "density  (1 / unit of x)",
      .x = {std::floor(domain.lower()), domain.upper()},
      .y = {0, 1.08 * highest},
      .series = series,
  };
  return result;
}

}  // namespace papers

#endif  // PHIMIS_EXAMPLES_PAPERS_INTEGRAND_FIGURE_HPP
