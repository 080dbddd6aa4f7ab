// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_REPORT_HPP
#define PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_REPORT_HPP

#include <environment_lighting/arguments.hpp>
#include <environment_lighting/study.hpp>
#include <papers/comparison.hpp>
#include <papers/log_log_figure.hpp>
#include <papers/report.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

// Tables, charts and the section of the report.

namespace environment_lighting {

inline std::string csv_of(const std::vector<case_study>& studies) {
  std::string csv =
      "case,method,techniques,samples_per_pixel,mse,mse_ratio,mse_ratio_standard_error,relmse,relmse_ratio,seconds,"
      "time_ratio,efficiency_ratio,bias_z\n";
  for (const case_study& s : studies) {
    for (const result& r : s.results) {
      char line[500];
      std::snprintf(line, sizeof line, "\"%s\",%s,%d,%lld,%.6g,%.4f,%.4f,%.6g,%.4f,%.4g,%.3f,%.3f,%.2f\n",
                    s.of.name.c_str(), r.of.method.c_str(), r.of.techniques,
                    static_cast<long long>(r.of.samples_per_pixel), r.mse, r.ratio, r.standard_error, r.relmse,
                    r.relmse_ratio, r.seconds, r.time_ratio, r.efficiency(), r.bias);
      csv += line;
    }
  }
  return csv;
}

/// Ratios of the MSE to that of equal counts of two techniques, a line for each method.
inline std::string table_of(const case_study& study, const arguments& given) {
  std::string text = "| " + study.of.name + " |";
  std::string rule = "|---|";
  for (const std::int64_t samples : given.samples) text += ' ' + std::to_string(samples) + " |", rule += "---|";
  text += " s.e. | relMSE | time | efficiency |\n" + rule + "---|---|---|---|\n";
  for (const std::string& method : given.methods) {
    text += "| " + method + " |";
    char cell[80];
    for (const std::int64_t samples : given.samples) {
      std::snprintf(cell, sizeof cell, " %.3f |", study.at(method, samples).ratio);
      text += cell;
    }
    const result& last = study.at(method, given.samples.back());
    std::snprintf(cell, sizeof cell, " %.3f | %.3f | %.2f | %.2f |\n", last.standard_error, last.relmse_ratio,
                  last.time_ratio, last.efficiency());
    text += cell;
  }
  return text + '\n';
}

/// The efficiency of the default at V's 500 samples, or the nearest number.
inline std::string efficiency_table(const std::vector<case_study>& studies, const arguments& given) {
  const std::int64_t samples =
      *std::min_element(given.samples.begin(), given.samples.end(),
                        [](std::int64_t a, std::int64_t b) { return std::abs(a - 500) < std::abs(b - 500); });
  std::string text = "| case | MSE | s.e. | time | efficiency |\n|---|---|---|---|---|\n";
  double sum = 0;
  char line[300];
  for (const case_study& s : studies) {
    const result& r = s.at("default", samples);
    sum += std::log(r.efficiency());
    std::snprintf(line, sizeof line, "| %s | %.3f | %.3f | %.2f | %.2f |\n", s.of.name.c_str(), r.ratio,
                  r.standard_error, r.time_ratio, r.efficiency());
    text += line;
  }
  std::snprintf(line, sizeof line, "| geometric mean | | | | %.2f |\n", std::exp(sum / static_cast<double>(studies.size())));
  return "The default against equal counts of two techniques, " + std::to_string(samples) +
         " samples per pixel; efficiency is 1/(MSE × time)\n\n" + text + line;
}

/// Where the default is not below a method of V from 200 samples on, or above 1.02 of equal counts with any, a line each;
/// those that three standard errors could mend say so, and do not count as `beyond_noise`.
struct shortcomings {
  std::string lines;
  int beyond_noise = 0;
};

inline shortcomings where_default_is_not_best(const std::vector<case_study>& studies, const arguments& given) {
  shortcomings found;
  for (const case_study& s : studies) {
    for (const std::int64_t samples : given.samples) {
      const result& ours = s.at("default", samples);
      for (const std::string& method : given.methods) {
        if (std::find(std::begin(methods_of_v), std::end(methods_of_v), method) == std::end(methods_of_v)) continue;
        const bool of_equal = method == "equal";
        if (!of_equal && samples < 200) continue;
        const result& theirs = s.at(method, samples);
        const double most = of_equal && samples < 200 ? 1.02 : theirs.ratio;
        if (ours.ratio < most) continue;
        const double error = std::hypot(ours.standard_error, theirs.standard_error);
        const bool noise = ours.ratio - most <= 3 * error;
        found.beyond_noise += noise ? 0 : 1;
        char line[300];
        std::snprintf(line, sizeof line, "%s, %lld samples: default %.3f, %s %.3f of equal counts, s.e. %.3f%s\n",
                      s.of.name.c_str(), static_cast<long long>(samples), ours.ratio, method.c_str(), theirs.ratio,
                      error, noise ? ", within noise" : "");
        found.lines += line;
      }
    }
  }
  return found;
}

/// V Sec. 7: "the new algorithm ... reaches faster convergence for all 10 scenes tested".
inline papers::comparisons statements(const std::vector<case_study>& studies, const arguments& given) {
  papers::comparisons table("V");
  const char* const estimated =
      "with exact σ Eq. 31 is never worse (V Eq. 30); estimated in the pixel, the σ of a technique that has not met what is "
      "bright yet is too small, and so is its count";
  for (const case_study& s : studies) {
    // Where a few highlights have most of the error, and where there is little to win.
    const bool differs = s.of.name[1] == ' ' && std::strchr("136", s.of.name[0]) != nullptr;
    double z = std::numeric_limits<double>::infinity();
    std::string computed;
    for (const std::int64_t samples : given.samples) {
      const result& r = s.at("eq31", samples);
      z = std::min(z, (1 - r.ratio) / r.standard_error);
      computed += (computed.empty() ? "" : ", ") + papers::with_decimals(r.ratio, 3);
    }
    papers::add_noisy(table, "Sec. 7, Fig. 1: MSE of Eq. 31 to that of equal counts, case " + s.of.name, "< 1",
                      computed, z, differs ? papers::expectation::differs : papers::expectation::agrees,
                      differs ? estimated : "");
  }
  return table;
}

inline std::vector<papers::captioned_figure> charts(const std::vector<case_study>& studies, const arguments& given) {
  struct look {
    const char* method;
    const char* title;
    const char* colour;
  };
  const look looks[] = {{"map", "map", papers::colour::vermillion},
                        {"brdf", "BRDF · cos θ", papers::colour::green},
                        {"equal", "equal counts", papers::colour::blue},
                        {"lu", "Lu et al. 2013", papers::colour::orange},
                        {"eq31", "V Eq. 31", papers::colour::black},
                        {"default", "default, three techniques", papers::colour::purple}};
  std::vector<papers::captioned_figure> figures;
  for (const case_study& s : studies) {
    std::vector<papers::log_log_curve> curves;
    for (const look& l : looks) {
      if (std::find(given.methods.begin(), given.methods.end(), l.method) == given.methods.end()) continue;
      curves.push_back({l.method, l.title, l.colour});
      for (const std::int64_t samples : given.samples) {
        curves.back().points.emplace_back(static_cast<double>(samples), s.at(l.method, samples).mse);
      }
    }
    const bool lowest = std::all_of(curves.begin(), curves.end(), [&](const papers::log_log_curve& c) {
      for (std::size_t i = 0; i < c.points.size(); ++i) {
        if (c.points[i].second < curves.back().points[i].second) return false;
      }
      return true;
    });
    figures.push_back(papers::log_log_figure{.name = "environment_lighting_" + s.files,
                                             .title = s.of.name + ": errors fall alike" +
                                                      (lowest ? ", that of the last is lowest" : ""),
                                             .caption = "MSE against samples per pixel, case " + s.of.name,
                                             .x_title = "samples per pixel",
                                             .y_title = "MSE  (radiance²)",
                                             .slope = -1,
                                             .slope_title = "slope −1",
                                             .csv_header = "method,samples,mse",
                                             .y_most = 8 * s.at("equal", given.samples.front()).mse}(curves));
  }
  return figures;
}

/// The part of the report that is about environment maps.
inline std::string section(const std::vector<case_study>& studies, const papers::comparisons& table,
                           const std::vector<papers::captioned_figure>& figures, const arguments& given,
                           double seconds) {
  std::string text =
      "## Environment maps\n\nV Sec. 7 and Fig. 1, on scenes of our own, since V prints none: a sphere and a knot in a "
      "cage of bars, eight maps of Debian's blender-data (CC0), ten cases. Every method has the same number of samples "
      "in each pixel; errors are ratios of the MSE to that of equal counts of map and BRDF. " +
      std::to_string(given.width) + " × " + std::to_string(given.height) + " pixels, " + std::to_string(given.runs) +
      (given.runs == 1 ? " run" : " runs") + ", reference of " + std::to_string(given.reference_samples) +
      " samples, whose own error is subtracted; " + papers::with_decimals(seconds / 60, 1) + " minutes. Command: "
      "`environment_lighting" + (given.full ? " --full" : given.quick ? " --quick" : "") +
      "`.\n\n### Printed statements on environment maps\n\n" + table.markdown() + "\n### Efficiency\n\n" +
      efficiency_table(studies, given) +
      "\n### MSE to that of equal counts\n\nFor each number of samples; the standard error, relMSE, time and efficiency "
      "are those of the last. `lu`: Lu et al. 2013. `eq31`: V's. `default` and `equal3` have three techniques: the "
      "map's brightest region, the rest of it, the BRDF.\n\n";
  for (const case_study& s : studies) text += table_of(s, given);
  text += "### Images of environment maps\n\n" + std::to_string(samples_of_images(given.samples)) +
          " samples per pixel. α is the fraction of BRDF sampling in a pixel's last batch, 0 blue and 1 red.\n\n"
          "| case | reference | equal counts | Eq. 31 | α | default | α |\n|---|---|---|---|---|---|---|\n";
  for (const case_study& s : studies) {
    const auto image = [&](const char* what, const std::string& ending) {
      return " ![" + std::string(what) + "](images/environment_lighting/" + s.files + ending + ".png) |";
    };
    text += "| " + s.of.name + " |" + image("reference", "_reference") + image("equal counts", "_equal") +
            image("Eq. 31", "_eq31") + image("α", "_eq31_alpha") + image("default", "_default") +
            image("α", "_default_alpha") + '\n';
  }
  return text + "\n### MSE charts\n\n" + papers::markdown(figures);
}

}  // namespace environment_lighting

#endif  // PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_REPORT_HPP
