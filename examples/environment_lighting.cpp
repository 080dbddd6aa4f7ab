// SPDX-License-Identifier: MIT
// An object in a cage, lit by an environment map, V Sec. 7: images, errors and times of sampling methods, each with the same
// number of samples per pixel. Ratios are to equal counts of two techniques, the map and the BRDF.
//
// test: --quick --cases 4 --width 32 --height 32 --samples 60
#include <environment_lighting/arguments.hpp>
#include <environment_lighting/report.hpp>
#include <environment_lighting/study.hpp>
#include <papers/gnuplot.hpp>
#include <papers/output_folder.hpp>
#include <papers/report.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <vector>

namespace {

using namespace environment_lighting;

bool has(const arguments& given, const char* method) {
  return std::find(given.methods.begin(), given.methods.end(), method) != given.methods.end();
}

int run(const arguments& given) {
  const auto begin = std::chrono::steady_clock::now();
  papers::require_gnuplot();
  const papers::output_folder folder(given.output);
  const papers::output_folder references(folder.path() / "references");
  const papers::output_folder images(folder.path() / "images" / "environment_lighting");
  std::vector<case_study> studies;
  bool good = true;
  for (const test_case& one : cases_of(given)) {
    studies.push_back(measure(one, given, references.path(), images));
    std::printf("\n%s", table_of(studies.back(), given).c_str());
    std::fflush(stdout);
    for (const result& r : studies.back().results) {
      if ((r.of.method != "equal" && r.of.method != "default") || std::fabs(r.bias) < 5) continue;
      std::fprintf(stderr, "environment_lighting: %s, %s is biased, z = %.1f\n", one.name.c_str(),
                   r.of.method.c_str(), r.bias);
      good = false;
    }
  }
  folder.write("environment_lighting.csv", csv_of(studies));
  const auto figures = charts(studies, given);
  papers::write_figures(figures, papers::figures_of(folder));
  if (has(given, "default")) {
    std::printf("%s", efficiency_table(studies, given).c_str());
    const shortcomings found = where_default_is_not_best(studies, given);
    if (!found.lines.empty()) std::printf("\nwhere the default is not best:\n%s", found.lines.c_str());
    good = good && found.beyond_noise == 0;
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  std::printf("\n%s: environment_lighting.csv, images/environment_lighting/, figures/; %.0f s\n",
              folder.path().c_str(), seconds);
  if (!given.is_own() && has(given, "default") && has(given, "eq31")) {
    const papers::comparisons of_v = statements(studies, given);
    papers::comparisons table("environment_lighting");
    table.append(of_v);
    papers::write_report(folder, table, section(studies, of_v, figures, given, seconds));
    good = papers::conclude("environment_lighting", table) == 0 && good;
  }
  return good ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  arguments given;
  CLI::App app("An object lit by an environment map: images, errors and times of sampling methods.");
  add_options(app, given);
  try {
    app.parse(argc, argv);
    settle(app, given);
    return run(given);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    std::fprintf(stderr, "environment_lighting: %s; --help lists the options\n", error.what());
  } catch (const std::bad_alloc&) {
    std::fputs("environment_lighting: not enough memory for an image of this size\n", stderr);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "environment_lighting: %s\n", error.what());
  }
  return 2;
}
