// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_PAPERS_GNUPLOT_HPP
#define PHIMIS_EXAMPLES_PAPERS_GNUPLOT_HPP

#include <papers/output_folder.hpp>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

// Figures as SVG, drawn by gnuplot.

namespace papers {

struct plot_range {
  double lower;
  double upper;
};

/// One entry of the legend and its points.
struct plot_series {
  std::string title;
  std::string style;  ///< in gnuplot's words: "lines linewidth 2", "points pointtype 7"
  const char* colour;
  std::vector<std::pair<double, double>> points;
};

enum class axis_scale { linear, logarithmic };

struct figure {
  std::string title;  ///< what one should see
  std::string x_title;
  std::string y_title;
  plot_range x{};
  plot_range y{};
  axis_scale x_scale = axis_scale::linear;
  axis_scale y_scale = axis_scale::linear;
  std::vector<plot_series> series{};
};

/// Colours that stay apart for colour-blind eyes.  Source Okabe & Ito 2008
namespace colour {
inline constexpr const char* blue = "#0072B2";
inline constexpr const char* vermillion = "#D55E00";
inline constexpr const char* green = "#009E73";
inline constexpr const char* purple = "#CC79A7";
inline constexpr const char* orange = "#E69F00";
inline constexpr const char* grey = "#757575";
inline constexpr const char* black = "#000000";
}  // namespace colour

/// Errors cannot_run where there is no gnuplot.
inline void require_gnuplot() {
  if (std::system("gnuplot --version >/dev/null 2>&1") != 0) {
    throw cannot_run("gnuplot is missing: install it (Debian, Ubuntu: apt-get install gnuplot-nox)");
  }
}

namespace detail {

/// A string for gnuplot, in single quotes.
inline std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    result += c;
    if (c == '\'') result += c;
  }
  return result + "'";
}

/// A logarithmic axis, with tics at 1, 2, 5, 10, … where it spans few decades, and else at powers of ten.
inline std::string logarithmic(char axis, const plot_range& of) {
  std::ostringstream out;
  out << "set logscale " << axis << "\nunset m" << axis << "tics\n";
  const double first = std::floor(std::log10(of.lower)), last = std::ceil(std::log10(of.upper));
  if (last - first > 4) {
    out << "set format " << axis << " '10^{%T}'\n";
    return out.str();
  }
  out << "set format " << axis << " '%g'\nset " << axis << "tics";
  const char* separator = " (";
  for (double decade = first; decade <= last; ++decade) {
    for (const double step : {1, 2, 5}) {
      out << separator << step * std::pow(10, decade);
      separator = ", ";
    }
  }
  out << ")\n";
  return out.str();
}

/// The dots above the range, moved to its upper edge as triangles.
inline plot_series above(const figure& of, const plot_series& series) {
  plot_series result{"", "points pointtype 8 pointsize 0.8 linewidth 1.5", series.colour, {}};
  if (series.style.find("points") != 0) return result;
  const double margin = of.y_scale == axis_scale::linear ? 0.012 * (of.y.upper - of.y.lower) : 0;
  for (const auto& [x, y] : series.points) {
    if (!(y <= of.y.upper)) result.points.emplace_back(x, of.y.upper - margin);
  }
  result.title =
      std::to_string(result.points.size()) + " of " + std::to_string(series.points.size()) + " dots lie above";
  return result;
}

inline std::string script(const figure& of, const std::filesystem::path& output) {
  std::ostringstream out;
  out.precision(15);
  std::vector<plot_series> all = of.series;
  for (const plot_series& series : of.series) {
    const plot_series high = above(of, series);
    if (!high.points.empty()) all.push_back(high);
  }
  const std::size_t legend_lines = (all.size() + 1) / 2;
  out << "set encoding utf8\n"
         "set terminal svg size 960,620 dynamic enhanced font 'DejaVu Sans,17' background '#ffffff'\n"
      << "set output " << quoted(output.string()) << "\n"
      << "set title \"" << of.title << "\" font ',18'\n"
      << "set xlabel \"" << of.x_title << "\"\nset ylabel \"" << of.y_title << "\"\n"
      << "set xrange [" << of.x.lower << ':' << of.x.upper << "]\n"
      << "set yrange [" << of.y.lower << ':' << of.y.upper
      << "]\n"
         "set grid linecolor rgb '#dddddd' linetype 1\n"
         "set border 3\nset tics nomirror\n"
         "set key bmargin center Left reverse maxcols 2 maxrows "
      << legend_lines << " width -4 spacing 1.25 samplen 3 font ',16'\n"
      << "set bmargin " << 4 + 1.5 * static_cast<double>(legend_lines) << "\n";
  if (of.x_scale == axis_scale::logarithmic) out << logarithmic('x', of.x);
  if (of.y_scale == axis_scale::logarithmic) out << logarithmic('y', of.y);
  for (std::size_t i = 0; i < all.size(); ++i) {
    out << "$data" << i << " << EOD\n";
    for (const auto& [x, y] : all[i].points) out << x << ' ' << y << '\n';
    out << "EOD\n";
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    out << (i == 0 ? "plot " : ", ") << "$data" << i << " using 1:2 title \"" << all[i].title << "\" with "
        << all[i].style << " linecolor rgb '" << all[i].colour << "'";
  }
  out << "\nunset output\n";
  return out.str();
}

}  // namespace detail

/// Writes a figure as NAME.svg.
inline void plot(const figure& what, const output_folder& folder, const std::string& name) {
  folder.produce(name + ".svg", [&](const std::filesystem::path& file) {
    std::FILE* const gnuplot = popen("gnuplot >/dev/null", "w");
    if (gnuplot == nullptr) return false;
    const std::string text = detail::script(what, file);
    const bool written = std::fwrite(text.data(), 1, text.size(), gnuplot) == text.size();
    return pclose(gnuplot) == 0 && written;
  });
}

}  // namespace papers

#endif  // PHIMIS_EXAMPLES_PAPERS_GNUPLOT_HPP
