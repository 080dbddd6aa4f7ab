// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_PAPERS_LINEAR_REPORT_HPP
#define PHIMIS_EXAMPLES_PAPERS_LINEAR_REPORT_HPP

#include <papers/comparison.hpp>
#include <papers/gnuplot.hpp>
#include <papers/integrand_figure.hpp>
#include <papers/linear_study.hpp>
#include <papers/report.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

// The figures and printed numbers of the linear heuristic's paper, from the studies of its six examples.

namespace papers {

/// The studies of examples 1 to 6.
struct linear_studies {
  linear_study<2> first, second, third;
  linear_study<3> fourth;
  linear_study<4> fifth;
  linear_study<3> sixth;

  template <class Receiver>
  void each(const Receiver& receive) const {
    receive(first);
    receive(second);
    receive(third);
    receive(fourth);
    receive(fifth);
    receive(sixth);
  }
};

/// How many runs a figure shows; there may be more for the tables.
inline constexpr std::size_t shown_runs = 100;

namespace detail {

using run_value = double linear_run::*;

template <class Runs>
std::size_t shown(const Runs& runs) {
  return std::min(runs.size(), shown_runs);
}

template <int M>
std::vector<std::pair<double, double>> of_runs(const linear_study<M>& of, run_value value) {
  std::vector<std::pair<double, double>> points;
  for (std::size_t i = 0; i < shown(of.runs); ++i) points.emplace_back(static_cast<double>(i + 1), of.runs[i].*value);
  return points;
}

/// A number of the runs of a study: `share` of them are below.
template <int M>
double quantile(const linear_study<M>& of, run_value value, double share) {
  std::vector<double> all;
  for (const linear_run& run : of.runs) all.push_back(run.*value);
  std::sort(all.begin(), all.end());
  return all[static_cast<std::size_t>(share * static_cast<double>(all.size() - 1) + 0.5)];
}

template <int M>
double share_of_negative(const linear_study<M>& of) {
  const auto n = std::count_if(of.runs.begin(), of.runs.end(), [](const linear_run& run) { return run.negative; });
  return static_cast<double>(n) / static_cast<double>(of.runs.size());
}

inline std::string tuple(const double* begin, const double* end, int digits) {
  std::string text;
  for (; begin != end; ++begin) text += (text.empty() ? "(" : ", ") + with_digits(*begin, digits);
  return text + ")";
}
template <int M>
std::string tuple(const phimis::fractions<double, M>& alpha, int digits) {
  return tuple(alpha.begin(), alpha.end(), digits);
}

constexpr const char* run_axis = "run  (no unit)";
constexpr const char* multi_sample_axis = "V[F] for N = 1  (unit of μ²)";

}  // namespace detail

/// Figs. 2, 5, 8, 11, 13, 15: f/μ superimposed on the pdfs.
template <int M>
captioned_figure linear_integrand(const linear_study<M>& of, const std::string& figure, const std::string& what,
                                  const std::vector<std::string>& pdfs) {
  const std::string n = std::to_string(of.number);
  return integrand_figure(of.problem, "linear_figure_" + figure, "Example " + n + ": f/μ superimposed on the pdfs",
                          "Fig. " + figure + ", example " + n + ": " + what, pdfs);
}

/// V[F] at what each run learnt, between that of equal counts and the least.
struct runs_figure_text {
  std::string figure;
  std::string title;
  std::string caption;
};

/// How much of the axis a figure shows.
enum class runs_range {
  to_equal_counts,
  near_the_least  ///< to twice the least; without the line of equal counts
};

/// One series of dots.
struct run_series {
  std::string title;
  std::string column;  ///< of the data
  detail::run_value value;
  const char* style;
  const char* colour;
};

template <int M>
captioned_figure runs_figure(const linear_study<M>& of, const runs_figure_text& text,
                             const std::vector<run_series>& shown, runs_range range = runs_range::to_equal_counts) {
  captioned_figure result;
  result.name = "linear_" + text.figure;
  result.caption = "Example " + std::to_string(of.number) + ": " + text.caption;
  result.csv = "run";
  const double end = static_cast<double>(detail::shown(of.runs));
  const auto level = [end](double value) {
    return std::vector<std::pair<double, double>>{{0, value}, {end + 1, value}};
  };
  std::vector<plot_series> series{{"least V[F]", "lines linewidth 1.5", colour::grey, level(of.least.value)}};
  if (range == runs_range::to_equal_counts) {
    series.push_back(
        {"V[F] of equal counts", "lines linewidth 2.5 dashtype (14,4,3,4)", colour::green, level(of.equal)});
  }
  for (const run_series& one : shown) {
    series.push_back({one.title, one.style, one.colour, detail::of_runs(of, one.value)});
    result.csv += ',' + one.column;
  }
  result.csv += ",least_V_F,equal_counts_V_F\n";
  for (std::size_t i = 0; i < detail::shown(of.runs); ++i) {
    std::vector<double> line{static_cast<double>(i + 1)};
    for (const run_series& one : shown) line.push_back(of.runs[i].*one.value);
    line.insert(line.end(), {of.least.value, of.equal});
    result.csv += csv_line(line);
  }
  const double margin = 0.1 * (of.equal - of.least.value);
  result.drawing = {
      .title = text.title,
      .x_title = detail::run_axis,
      .y_title = detail::multi_sample_axis,
      .x = {0, end + 1},
      .y = range == runs_range::to_equal_counts
               ? plot_range{std::max(of.least.value - margin, 0.0), of.equal + margin}
               : plot_range{0.95 * of.least.value, 2 * of.least.value},
      .series = series,
  };
  return result;
}

inline constexpr const char* dots = "points pointtype 7 pointsize 0.6";
inline constexpr const char* squares = "points pointtype 4 pointsize 0.6 linewidth 1.5";
inline constexpr const char* circles = "points pointtype 6 pointsize 0.6 linewidth 1.5";

/// The usual figure of one rule.
template <int M>
captioned_figure runs_figure(const linear_study<M>& of, int figure, const std::string& what,
                             const std::string& caption, detail::run_value value) {
  const std::string n = std::to_string(figure);
  return runs_figure(of,
                     {"figure_" + n, "Fig. " + n + ", example " + std::to_string(of.number) + ": " + what,
                      caption + " (triangles: above the picture)"},
                     {{"V[F] of each run", "V_F", value, dots, colour::black}});
}

/// Fig. 1: arithmetic and geometric means of f/p(α) over the samples of one technique.
template <int M>
captioned_figure means_figure(const linear_study<M>& of, int technique) {
  const auto k = static_cast<std::size_t>(technique - 1);
  const std::string n = std::to_string(of.number);
  const std::string p = std::to_string(technique);
  std::vector<std::pair<double, double>> arithmetic, geometric;
  captioned_figure result;
  result.csv = "run,arithmetic_mean,geometric_mean\n";
  double lowest = phimis::infinity<double>;
  double highest = 0;
  for (std::size_t i = 0; i < detail::shown(of.means); ++i) {
    const mean_pair& mean = of.means[i][k];
    const double run = static_cast<double>(i + 1);
    arithmetic.emplace_back(run, mean.arithmetic);
    geometric.emplace_back(run, mean.geometric);
    lowest = std::min(lowest, mean.geometric);
    highest = std::max(highest, mean.arithmetic);
    result.csv += csv_line({run, mean.arithmetic, mean.geometric});
  }
  const double margin = std::max(0.1 * (highest - lowest), 0.01 * highest);
  const bool equal = highest - lowest < 1e-9 * highest;
  result.name = "linear_figure_1_example_" + n + "_pdf_" + p;
  result.caption = "Example " + n + ": arithmetic and geometric mean of f/p(α) over 100 samples of pdf " + p +
                   ", at the α of least V[F]; the paper does not say at which α" +
                   (equal ? ". For the other pdf they are the same" : "");
  result.drawing = {
      .title = "Fig. 1, example " + n + ", pdf " + p +
               (equal ? ": where f = μ p(α) both means are μ"
                      : ": the geometric mean stays close below the arithmetic one"),
      .x_title = detail::run_axis,
      .y_title = "mean of f / p(α)  (unit of μ)",
      .x = {0, static_cast<double>(arithmetic.size()) + 1},
      .y = {lowest - margin, highest + margin},
      .series = {{"arithmetic mean",
                  equal ? "lines linewidth 5" : "linespoints pointtype 7 pointsize 0.5 linewidth 1.5", colour::blue,
                  arithmetic},
                 {"geometric mean",
                  equal ? "lines linewidth 1.5" : "linespoints pointtype 6 pointsize 0.5 linewidth 1.5",
                  colour::orange, geometric}},
  };
  return result;
}

/// Repeated runs: V[F] relative to the least, or to equal counts where the least is 0.
inline std::string linear_runs_csv(const linear_studies& all) {
  std::string csv =
      "example,runs,share_of_negative_solutions,newton_median,newton_p90,dropped_median,dropped_p90,best_face_median,"
      "best_face_p90,projected_median,projected_p90,exact_median,exact_p90\n";
  all.each([&](const auto& of) {
    const double unit = of.least.value <= of.least.error ? of.equal : of.least.value;
    std::vector<double> line{static_cast<double>(of.number), static_cast<double>(of.runs.size()),
                             detail::share_of_negative(of)};
    for (const detail::run_value value : {&linear_run::newton, &linear_run::dropped, &linear_run::best_face,
                                          &linear_run::projected, &linear_run::exact}) {
      for (const double share : {0.5, 0.9}) line.push_back(detail::quantile(of, value, share) / unit);
    }
    csv += csv_line(line);
  });
  return csv;
}

/// The same for people.
inline std::string linear_runs_table(const linear_studies& all) {
  std::string text =
      "| example | negative solutions | Newton–Raphson | first technique | second technique | ours | exact minimiser "
      "|\n"
      "|---|---|---|---|---|---|---|\n";
  all.each([&](const auto& of) {
    const bool zero = of.least.value <= of.least.error;
    const double unit = zero ? of.equal : of.least.value;
    const auto show = [&](detail::run_value value) {
      const double median = detail::quantile(of, value, 0.5);
      if (std::isnan(median)) return std::string("–");
      const double high = detail::quantile(of, value, 0.9);
      if (zero && high < 1e-20) return std::string("0, 0");
      return with_decimals(median / unit, 4) + ", " + with_decimals(high / unit, 4);
    };
    text += "| " + std::to_string(of.number) + " | " + with_decimals(100 * detail::share_of_negative(of), 1) +
            " % | " + show(&linear_run::newton) + " | " + show(&linear_run::dropped) + " | " +
            show(&linear_run::best_face) + " | " + show(&linear_run::projected) + " | " + show(&linear_run::exact) +
            " |\n";
  });
  return text;
}

/// What the equations ask for with infinitely many samples.
inline std::string linear_limits_table(const linear_studies& all) {
  std::string text =
      "| example | solution of Eq. 14 | V[F] / least V[F]: first technique | second technique | ours |\n"
      "|---|---|---|---|---|\n";
  all.each([&](const auto& of) {
    const bool zero = of.least.value <= of.least.error;
    const auto show = [&](const auto& alpha) {
      return zero ? std::string("0 / 0") : with_decimals(variance_at(of.problem, alpha) / of.least.value, 4);
    };
    text += "| " + std::to_string(of.number) + " | " + detail::tuple(of.limit.solution, 4) + " | " +
            show(of.limit.dropped) + " | " + show(of.limit.best_face) + " | " + show(of.limit.projected) + " |\n";
  });
  return text;
}

/// Every number that the paper prints in Sec. 6.1, and the statements of the paper that do not hold.
inline comparisons linear_comparisons(const linear_studies& all) {
  comparisons table("L");
  const auto add = [&](const auto& of, const std::string& equation, const std::string& mean, const std::string& equal,
                       const std::string& least, expectation of_mean = expectation::agrees,
                       const std::string& note = "") {
    const std::string item = "Ex. " + std::to_string(of.number) + ", ";
    table.number(item + equation + ": μ", mean, of.problem.mean().value, 0, of_mean, note);
    table.number(item + "Sec. 6.1: V[F] of equal counts", equal, of.equal);
    if (!least.empty()) table.number(item + "Sec. 6.1: least V[F]", least, of.least.value, of.least.error);
  };
  add(all.first, "Eq. 20", "25.3065", "24.1152", "");
  add(all.second, "Eq. 21", "2.9929", "0.1134", "");
  const double at_limit = variance_at(all.second.problem, all.second.limit.dropped);
  table.number("Ex. 2, Sec. 7: V[F] of the linear heuristic, which is exact", "0", at_limit,
               1e-24 * all.second.equal);
  add(all.third, "Eq. 22", "2.3118", "0.2772", "");
  add(all.fourth, "Eq. 23", "5.8394", "6.8063", "3.0454");
  add(all.fifth, "Eq. 24", "12.7484", "14.4033", "1.7217");
  add(all.sixth, "Eq. 25", "3.5962", "4.9175", "4.1945", expectation::differs,
      "rounded twice: 3.596148 is 3.59615 to five decimals, as the variance paper prints, and 3.5961 to four");
  const char* const printed[] = {"0", "0.1986", "0.8014"};
  for (int k = 0; k < 3; ++k) {
    table.number("Ex. 6, Sec. 6.1: α_" + std::to_string(k + 1) + " of the least V[F]", printed[k],
                 all.sixth.optimal[k]);
  }
  const phimis::interval domain = all.sixth.problem.domain();
  table.statement("Ex. 6, Eq. 25: lower limit of the integral", "3/2 π", with_digits(domain.lower(), 6),
                  std::fabs(domain.lower() - 1.5 * std::numbers::pi) < 1e-9, expectation::differs,
                  "read 3/(2π): 3π/2 is above the upper limit π, and with 3/(2π) the other numbers are right");
  const auto interior = [&](const auto& of) {
    const double least_fraction = *std::min_element(of.optimal.begin(), of.optimal.end());
    const double least_solution = *std::min_element(of.limit.solution.begin(), of.limit.solution.end());
    const std::string n = std::to_string(of.number);
    table.statement(
        "Ex. " + n + ", Secs. 7, 8: negative solutions appear when the optimum is on the border", "yes",
        "optimum " + detail::tuple(of.optimal, 4) + ", solution with infinitely many samples " +
            detail::tuple(of.limit.solution, 4),
        !(least_fraction > 0.001 && least_solution < 0), expectation::differs,
        "here the optimum is inside: the heuristic is the best fit of f by the pdfs in L2, and this has a "
        "negative coefficient; so have the solutions of " +
            with_decimals(100 * detail::share_of_negative(of), 0) + " % of the runs of 100 samples a technique");
  };
  interior(all.fourth);
  interior(all.fifth);
  return table;
}

}  // namespace papers

#endif  // PHIMIS_EXAMPLES_PAPERS_LINEAR_REPORT_HPP
