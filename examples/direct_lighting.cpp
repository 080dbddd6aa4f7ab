// SPDX-License-Identifier: MIT
// Direct lighting of Veach's plates, T Sec. 8 and L Sec. 6.2: images, errors and times of sampling methods, each with the
// same number of samples per pixel. Ratios are to equal counts of two techniques with the same light sampler.
//
// test: --quick --table1 --never-worse --convergence --overhead
#include <direct_lighting/arguments.hpp>
#include <direct_lighting/convergence.hpp>
#include <direct_lighting/image_files.hpp>
#include <direct_lighting/never_worse.hpp>
#include <direct_lighting/overhead.hpp>
#include <direct_lighting/methods.hpp>
#include <direct_lighting/printed.hpp>
#include <direct_lighting/reference.hpp>
#include <direct_lighting/section.hpp>
#include <direct_lighting/table.hpp>
#include <papers/gnuplot.hpp>
#include <papers/output_folder.hpp>
#include <papers/report.hpp>
#include <render/png.hpp>
#include <render/tone_map.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <vector>

namespace {

using namespace direct_lighting;

/// Whether the image of one run has no bias, |z| < 5: an error of the pixels' sum beyond is no chance.
bool unbiased(const measured_method& m, const render::image<render::rgb>& reference) {
  const double z = render::bias_in_standard_errors(m.first_run.picture, reference);
  if (std::fabs(z) < 5) return true;
  std::fprintf(stderr, "direct_lighting: %s with %d techniques, %s sampling is biased, z = %.1f\n",
               m.of.method.c_str(), m.of.techniques, m.of.setting.c_str(), z);
  return false;
}

/// Methods of one sampler, in the order of the table.
std::vector<configuration> table_of(const arguments& given, const std::string& sampler) {
  std::vector<configuration> wanted;
  const auto add = [&](int techniques, const std::vector<std::string>& methods) {
    for (const std::string& m : methods) wanted.push_back({sampler, techniques, m, given.samples});
  };
  if (given.table1) {
    add(2, methods_of(2));
    add(5, methods_of(5));
  } else {
    add(given.techniques, given.methods);
  }
  return wanted;
}

/// direct_lighting.csv and images of each of its rows, which are added to `rows`. Whether those whose check is sound have
/// no bias.
bool compare_methods(const study& plates, const view& seen, const arguments& given, const papers::output_folder& folder,
                     const papers::output_folder& images, std::vector<measured_method>& rows) {
  bool good = true;
  std::string csv = csv_header;
  const std::vector<std::string> both{"area", "cone"};
  for (const std::string& sampler : given.table1 ? both : std::vector<std::string>{given.sampler}) {
    std::vector<configuration> wanted = table_of(given, sampler);
    const auto is_baseline = [](const configuration& c) { return c.techniques == 2 && c.method == "equal"; };
    const bool extra = std::none_of(wanted.begin(), wanted.end(), is_baseline);
    if (extra) wanted.push_back({sampler, 2, "equal", given.samples});
    std::vector<measured_method> measured = plates.measure(wanted, sampler);
    const auto at =
        std::find_if(measured.begin(), measured.end(), [&](const measured_method& m) { return is_baseline(m.of); });
    const measured_method baseline = *at;
    if (extra) measured.pop_back();
    for (measured_method& m : measured) {
      csv += csv_row(m, baseline);
      write_images(images, m, seen.points);
      // One technique alone may miss a light in every pixel: its error is too skewed for a z.
      if (m.of.method == "equal" || m.of.method == "default") good = unbiased(m, plates.reference) && good;
      m.forget_images();
    }
    print_table(measured, baseline);
    rows.insert(rows.end(), measured.begin(), measured.end());
  }
  folder.write("direct_lighting.csv", csv);
  return good;
}

/// The section of the report. Whether all rows agree as they should.
bool report(const std::vector<measured_method>& rows, const std::vector<measured_method>& linear,
            const std::vector<papers::captioned_figure>& figures, const arguments& given,
            const papers::output_folder& folder) {
  const papers::comparisons of_tsallis = table_1(rows), of_linear = linear_statements(linear);
  papers::comparisons both("direct_lighting");
  both.append(of_tsallis);
  both.append(of_linear);
  papers::write_report(folder, both, section(of_tsallis, of_linear, rows, linear, figures, given));
  std::printf("\n%s: reproduction.md, tables.csv, images/\n", folder.path().c_str());
  return papers::conclude("direct_lighting", both) == 0;
}

int run(const arguments& given) {
  const scene plates(given.scene);
  const bool table = given.table1 || !given.studies();
  for (const configuration& one : table_of(given, given.sampler)) {
    if (table) check(one);
  }
  if (given.convergence) papers::require_gnuplot();
  const papers::output_folder folder(given.output);
  const papers::output_folder references(folder.path() / "references");
  bool good = true;
  if (table || given.convergence) {
    const papers::output_folder images(folder.path() / "images");
    const auto points = shading_points(plates, given.width, given.height, given.threads);
    const auto truth =
        reference(references.path(), given.scene, plates, points, given.reference_samples, given.threads);
    render::write_png(images.path() / "reference.png", render::tone_map(truth));
    const view seen{plates, points};
    const study of{[&](const configuration& one) { return make_method(seen, one); }, truth, given.runs, given.seed, given.threads};
    std::vector<measured_method> rows;
    if (table) good = compare_methods(of, seen, given, folder, images, rows);
    std::vector<papers::captioned_figure> figures;
    if (given.convergence) {
      figures = convergence_figures(of);
      papers::write_figures(figures, papers::figures_of(folder));
    }
    if (given.as_printed()) {
      const papers::output_folder of_heuristic(images.path() / "linear_heuristic");
      good = report(rows, measure_linear(given, references.path(), of_heuristic), figures, given, folder) && good;
    }
  }
  if (given.overhead) {
    const int size = given.quick ? 48 : 200;
    print_overheads({plates, shading_points(plates, size, size, given.threads)}, given.samples, given.seed,
                    given.quick ? 3 : 15);
  }
  if (given.never_worse) {
    const never_worse_effort effort = given.quick  ? never_worse_effort{56, 4, 2000}
                                      : given.full ? never_worse_effort{1, 30}
                                                   : never_worse_effort{8, 30};
    good = never_worse(folder, references.path(), given, effort) && good;
  }
  return good ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  arguments given;
  CLI::App app("Direct lighting of four plates by four lights: images, errors and times of sampling methods.");
  add_options(app, given);
  try {
    app.parse(argc, argv);
    settle(app, given);
    return run(given);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    std::fprintf(stderr, "direct_lighting: %s; --help lists the options\n", error.what());
  } catch (const std::bad_alloc&) {
    std::fputs("direct_lighting: not enough memory for an image of this size\n", stderr);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "direct_lighting: %s\n", error.what());
  }
  return 2;
}
