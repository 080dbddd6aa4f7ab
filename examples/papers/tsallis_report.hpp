// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_PAPERS_TSALLIS_REPORT_HPP
#define PHIMIS_EXAMPLES_PAPERS_TSALLIS_REPORT_HPP

#include <papers/comparison.hpp>
#include <papers/gnuplot.hpp>
#include <papers/integrand_figure.hpp>
#include <papers/report.hpp>
#include <papers/tsallis_study.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

// The Tsallis paper's figures and printed numbers, from the studies of its three examples.

namespace papers {

namespace detail {

/// One column of a study against γ.
template <class Value>
std::vector<std::pair<double, double>> against_gamma(const tsallis_study& of, const Value& value, bool sampled) {
  std::vector<std::pair<double, double>> points;
  for (const order& at : of.orders) {
    if (!sampled || at.sampled) points.emplace_back(at.gamma, value(at));
  }
  return points;
}

inline std::vector<std::pair<double, double>> level(double value) { return {{0, value}, {8, value}}; }

constexpr const char* gamma_axis = "order γ of the Tsallis divergence  (no unit)";
constexpr const char* variance_axis = "variance for N = 1  (unit of μ²)";

}  // namespace detail

/// Figs. 1, 4, 7: f/μ superimposed on the pdfs.
inline captioned_figure integrand_figure(const tsallis_study& of, const std::string& first,
                                         const std::string& second) {
  const std::string n = std::to_string(of.number);
  const std::string number = std::to_string(3 * of.number - 2);
  return integrand_figure(
      of.problem, "tsallis_figure_" + number, "Example " + n + ": f/μ superimposed on the two pdfs",
      "Fig. " + number + ", example " + n + ": neither pdf alone is proportional to the integrand f",
      {first, second});
}

namespace detail {

inline std::string variance_csv(const tsallis_study& of) {
  std::string csv =
      "gamma,alpha,V_F,V_one_sample,newton_alpha,newton_V_F,newton_iterates_that_left_0_1,least_V_F,equal_counts_V_"
      "F\n";
  for (const order& at : of.orders) {
    std::string row = csv_line({at.gamma, at.alpha[0], at.multi_sample, at.one_sample});
    row.pop_back();
    const std::string newton =
        at.sampled ? csv_line({at.newton.alpha[0], at.newton.variance, static_cast<double>(at.newton.left)}) : ",,\n";
    csv += row + ',' + newton.substr(0, newton.size() - 1) + ',' + csv_line({of.least_multi.value, of.equal_multi});
  }
  return csv;
}

inline std::vector<plot_series> variance_series(const tsallis_study& of) {
  const auto newton = [](const order& at) { return at.newton.variance; };
  const auto one = [](const order& at) { return at.one_sample; };
  const auto multi = [](const order& at) { return at.multi_sample; };
  return {
      {"least V[F]", "lines linewidth 1.5", colour::grey, level(of.least_multi.value)},
      {"V[F] after 5 × 100 samples", "points pointtype 7 pointsize 0.55", colour::black,
       against_gamma(of, newton, true)},
      {"V[ℱ] at the optimal α", "lines linewidth 3", colour::vermillion, against_gamma(of, one, false)},
      {"V[F] at the optimal α", "lines linewidth 3 dashtype (10,6)", colour::blue, against_gamma(of, multi, false)}};
}

}  // namespace detail

/// The range of variances close around both curves.
inline plot_range near_curves(const tsallis_study& of) {
  double highest = 0;
  for (const order& at : of.orders) highest = std::max(highest, at.one_sample);
  const double least = of.least_multi.value;
  const double height = highest - least > of.least_multi.error ? highest - least : 0.05 * of.equal_multi;
  return {std::max(least - 0.1 * height, 0.0), least + 2 * height};
}

/// Figs. 2, 5, 8: both variances at the optimal fractions, and V[F] at the learnt ones.
inline captioned_figure variance_figure(const tsallis_study& of, const std::string& title) {
  captioned_figure result;
  result.name = "tsallis_figure_" + std::to_string(3 * of.number - 1);
  result.caption =
      "Example " + std::to_string(of.number) +
      ": V[F] (dashed) and V[ℱ] (continuous) at the optimum of each γ, and V[F] (dots) at the fractions " +
      "after 5 Newton–Raphson iterations of 100 samples (triangles: above the picture)";
  result.csv = detail::variance_csv(of);
  result.drawing = {
      .title = title,
      .x_title = detail::gamma_axis,
      .y_title = detail::variance_axis,
      .x = {0, 8},
      .y = near_curves(of),
      .series = detail::variance_series(of),
  };
  return result;
}

/// Figs. 3, 6, 9: the same down to 0 and up to the variance of equal counts.
inline captioned_figure zoomed_out(const tsallis_study& of, const std::string& title) {
  captioned_figure result;
  result.name = "tsallis_figure_" + std::to_string(3 * of.number);
  result.caption =
      "Example " + std::to_string(of.number) + ": zoom-out of the figure before, with V[F] of equal counts";
  result.csv = detail::variance_csv(of);
  std::vector<plot_series> series = detail::variance_series(of);
  series.insert(series.begin(), plot_series{"V[F] of equal counts", "lines linewidth 2.5 dashtype (14,4,3,4)",
                                            colour::green, detail::level(of.equal_multi)});
  result.drawing = {
      .title = title,
      .x_title = detail::gamma_axis,
      .y_title = detail::variance_axis,
      .x = {0, 8},
      .y = {0, 1.15 * of.equal_multi},
      .series = series,
  };
  return result;
}

/// Not in the paper: what the library's rule learns from as many samples. Where the least variance is 0 the axis is
/// logarithmic: the rounding of f/p is all that is left.
inline captioned_figure exact_figure(const tsallis_study& of, const std::string& title) {
  const auto newton = [](const order& at) { return at.newton.variance; };
  const auto exact = [](const order& at) { return at.exact.variance; };
  const auto optimum = [](const order& at) { return at.multi_sample; };
  captioned_figure result;
  result.name = "tsallis_example_" + std::to_string(of.number) + "_exact";
  result.caption = "Example " + std::to_string(of.number) +
                   ", not in the paper: V[F] at the fractions that the exact minimiser with control variate learns " +
                   "from 5 × 100 samples, beside the paper's Newton–Raphson iteration";
  result.csv = "gamma,exact_alpha,exact_V_F,newton_alpha,newton_V_F,optimal_V_F,least_V_F,equal_counts_V_F\n";
  for (const order& at : of.orders) {
    if (!at.sampled) continue;
    result.csv += csv_line({at.gamma, at.exact.alpha[0], at.exact.variance, at.newton.alpha[0], at.newton.variance,
                            at.multi_sample, of.least_multi.value, of.equal_multi});
  }
  std::vector<plot_series> series{{"V[F] by Newton–Raphson", "points pointtype 6 pointsize 0.6 linewidth 1.5",
                                   colour::vermillion, detail::against_gamma(of, newton, true)},
                                  {"V[F] by the exact minimiser", "points pointtype 7 pointsize 0.6", colour::blue,
                                   detail::against_gamma(of, exact, true)}};
  const bool zero = of.least_multi.value <= of.least_multi.error;
  if (zero) {
    series.push_back({"V[F] of equal counts", "lines linewidth 2.5 dashtype (14,4,3,4)", colour::green,
                      detail::level(of.equal_multi)});
  } else {
    series.insert(series.begin(),
                  {"least V[F]", "lines linewidth 1.5", colour::grey, detail::level(of.least_multi.value)});
    series.push_back({"V[F] at the optimal α", "lines linewidth 2.5 dashtype (10,6)", colour::black,
                      detail::against_gamma(of, optimum, false)});
  }
  result.drawing = {
      .title = title,
      .x_title = detail::gamma_axis,
      .y_title = "V[F] for N = 1  (unit of μ²)",
      .x = {0, 8},
      .y = zero ? plot_range{1e-33, 100} : near_curves(of),
      .y_scale = zero ? axis_scale::logarithmic : axis_scale::linear,
      .series = series,
  };
  return result;
}

/// Repeated runs: V[F] relative to the least, or to equal counts where the least is 0.
inline std::string repeated_runs_csv(const std::vector<const tsallis_study*>& studies) {
  std::string csv =
      "example,gamma,newton_p10,newton_median,newton_p90,newton_share_that_left_0_1,exact_p10,exact_median,exact_"
      "p90\n";
  for (const tsallis_study* of : studies) {
    for (const order& at : of->orders) {
      if (!at.sampled) continue;
      const summary& n = at.newton_runs;
      const summary& e = at.exact_runs;
      csv += csv_line(
          {static_cast<double>(of->number), at.gamma, n.low, n.median, n.high, n.left, e.low, e.median, e.high});
    }
  }
  return csv;
}

/// γ of the least value on the paper's grid of 0.1.
template <class Value>
double gamma_of_least(const tsallis_study& of, const Value& value) {
  const auto less = [&](const order& a, const order& b) { return value(a) < value(b); };
  return std::min_element(of.orders.begin(), of.orders.end(), less)->gamma;
}

/// Every number that the paper prints in Sec. 7, and the statements of the paper that do not hold.
inline comparisons tsallis_comparisons(const tsallis_study& first, const tsallis_study& second,
                                       const tsallis_study& third) {
  using namespace phimis;
  comparisons table("T");
  const auto one = [](const order& at) { return at.one_sample; };
  const auto multi = [](const order& at) { return at.multi_sample; };
  const auto add = [&](const tsallis_study& of, const std::string& where, const std::string& equal,
                       const std::string& least) {
    const std::string item = "Ex. " + std::to_string(of.number) + ", " + where + ": ";
    if (!equal.empty()) table.number(item + "V[F] of equal counts", equal, of.equal_multi);
    if (!least.empty()) table.number(item + "least V[F]", least, of.least_multi.value, of.least_multi.error);
  };
  const auto add_mean = [&](const tsallis_study& of, const std::string& where, const std::string& printed) {
    table.number("Ex. " + std::to_string(of.number) + ", " + where + ": μ", printed, of.problem.mean().value);
  };
  const auto add_gamma = [&](const tsallis_study& of, const std::string& where) {
    const double gamma = gamma_of_least(of, one);
    table.statement("Ex. " + std::to_string(of.number) + ", " + where + ": γ of the least V[ℱ]", "2",
                    with_decimals(gamma, 1), with_decimals(gamma, 1) == "2.0");
  };

  add_mean(first, "Eq. 33", "25.3065");
  add(first, "Sec. 7.1", "24.1152", "13.4788");
  add(first, "Fig. 2", "", "13.4788");
  add_gamma(first, "Fig. 2");
  add(first, "Fig. 3", "24.1152", "13.4788");
  const order& kl = first.orders[9];
  const double gap = analysis::variance(first.problem, kl.alpha).difference.value;
  table.statement("Ex. 1, Fig. 3: V[ℱ] and V[F] at γ = 1", "equal", "V[ℱ] − V[F] = " + with_digits(gap, 2),
                  gap <= 1e-12 * kl.one_sample);
  const auto below = std::count_if(first.orders.begin(), first.orders.end(),
                                   [](const order& at) { return at.one_sample < at.multi_sample && at.gamma != 1; });
  const auto above = std::count_if(first.orders.begin(), first.orders.end(),
                                   [](const order& at) { return at.one_sample > at.multi_sample && at.gamma != 1; });
  table.statement("Ex. 1, Fig. 3: V[ℱ] and V[F] at γ ≠ 1", "V[ℱ] < V[F]",
                  "V[ℱ] < V[F] at " + std::to_string(below) + " of 79 γ, V[ℱ] > V[F] at " + std::to_string(above),
                  below == 79, expectation::differs,
                  "the labels are swapped in the caption: V[F] = V[ℱ] − Σ α_k (μ'_k − μ)² is never larger");

  add_mean(second, "Eq. 34", "2.9929");
  add(second, "Sec. 7.2", "0.1134", "0");
  add(second, "Fig. 5", "", "0");
  add(second, "Fig. 6", "0.1134", "0");
  table.number("Ex. 2, Fig. 6: least V[ℱ]", "0", second.least_one.value, second.least_one.error);

  add_mean(third, "Eq. 35", "2.3118");
  add(third, "Sec. 7.3", "0.2772", "0.09032");
  add(third, "Fig. 8", "", "0.09032");
  add_gamma(third, "Fig. 8");
  add(third, "Fig. 9", "0.2772", "0.09032");

  const double best = gamma_of_least(third, multi);
  table.statement("Ex. 3, Sec. 9: γ that is optimal for V[F]", "close to 2", with_decimals(best, 1),
                  std::fabs(best - 2) < 0.15, expectation::differs,
                  "true of V[ℱ], where it is exactly 2; V[F] is smallest at γ = " + with_decimals(best, 1) +
                      ", and in Ex. 1 at γ = " + with_decimals(gamma_of_least(first, multi), 1));

  // A condition that holds at every α selects none.
  const pair equal = equal_fractions<double, 2>();
  const auto moments = analysis::gamma_moments(first.problem, 0, equal);
  const double reversed_optimum = analysis::optimum(reversed<kullback_leibler>{}, first.problem).alpha[0];
  table.statement("Sec. 5.3: equal γ-moments cover the reversed Kullback–Leibler divergence", "yes, by γ → 1 − γ = 0",
                  "0-moments at α = 1/2 differ by " + with_digits(std::fabs(moments[0].value - moments[1].value), 1) +
                      ", the optimum is α = " + with_digits(reversed_optimum, 6),
                  std::fabs(moments[0].value - moments[1].value) > 1e-6, expectation::differs,
                  "every 0-moment is 1 at every α; the condition is that of E[log(p/f)] (Ex. 1)");

  // χ_P² as printed has the first argument in the denominator.
  const double by_phi = analysis::divergence_at(pearson_vajda{2}, first.problem, equal).value;
  const double as_printed = analysis::divergence_at(reversed{pearson_vajda{2}}, first.problem, equal).value;
  table.statement(
      "Sec. 5.4: χ_P²(q, r) = ∫ (q − r)²/q dx is defined by φ(t) = (t − 1)²", "yes",
      with_digits(as_printed, 6) + " as printed, " + with_digits(by_phi, 6) + " by φ",
      std::fabs(as_printed - by_phi) < 1e-9, expectation::differs,
      "by Eq. 11 the denominator is r^{k−1}, and for odd k only |t − 1|^k is convex (Ex. 1, equal counts)");
  return table;
}

}  // namespace papers

#endif  // PHIMIS_EXAMPLES_PAPERS_TSALLIS_REPORT_HPP
