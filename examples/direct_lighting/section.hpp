// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_DIRECT_LIGHTING_SECTION_HPP
#define PHIMIS_EXAMPLES_DIRECT_LIGHTING_SECTION_HPP

#include <direct_lighting/arguments.hpp>
#include <direct_lighting/image_files.hpp>
#include <direct_lighting/methods.hpp>
#include <direct_lighting/printed.hpp>
#include <direct_lighting/reference.hpp>
#include <direct_lighting/table.hpp>
#include <papers/report.hpp>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

// The part of the report that is about direct lighting.

namespace direct_lighting {

/// L Sec. 6.2 at the size given: its exponents, 100 samples. Its images go to a folder of their own.
inline std::vector<measured_method> measure_linear(const arguments& given, const std::filesystem::path& references,
                                                   const papers::output_folder& images) {
  const scene_options options{.exponents = {200, 500, 2000, 5000}};
  const scene plates(options);
  const auto points = shading_points(plates, given.width, given.height, given.threads);
  // Its error is a fifteenth of what 100 samples of two techniques have by area sampling, and adds 0.2 % to it.
  const std::int64_t samples = std::min<std::int64_t>(given.reference_samples, 5000);
  const auto truth = reference(references, options, plates, points, samples, given.threads);
  const view seen{plates, points};
  const study of{[&](const configuration& one) { return make_method(seen, one); }, truth, given.runs, given.seed, given.threads};
  std::vector<configuration> wanted;
  for (const char* const name : {"brdf", "light", "equal", "newton:1", "linear", "default"}) {
    wanted.push_back({"area", 2, name, 100});
  }
  std::vector<measured_method> measured = of.measure(wanted, "linear heuristic");
  for (measured_method& m : measured) {
    write_images(images, m, points);
    m.forget_images();
  }
  return measured;
}

namespace detail {

/// A row of images for each method: shown for the papers' techniques, for others only linked.
inline std::string image_table(const std::vector<measured_method>& measured, const std::string& folder) {
  std::string text =
      "| sampling | techniques | method | picture | α of light sampling | error |\n|---|---|---|---|---|---|\n";
  for (const measured_method& m : measured) {
    const std::string shown = m.of.setting == "area" && m.of.techniques == 2 ? "!" : "";
    const auto image = [&](const char* what, const char* ending) {
      return shown + '[' + what + "](" + folder + image_name(m.of) + ending + ") |";
    };
    text += "| " + m.of.setting + " | " + std::to_string(m.of.techniques) + " | " + m.of.method + " | " +
            image("picture", ".png") + ' ' + (learns(m.of.method) ? image("α", "_alpha.png") : "– |") + ' ' +
            image("error", "_error.png") + '\n';
  }
  return text;
}

}  // namespace detail

inline std::string section(const papers::comparisons& of_tsallis, const papers::comparisons& of_linear,
                           const std::vector<measured_method>& measured, const std::vector<measured_method>& linear,
                           const std::vector<papers::captioned_figure>& figures, const arguments& given) {
  std::ostringstream text;
  text
      << "## Direct lighting\n\n"
         "Sec. 8 of the Tsallis paper (T) and Sec. 6.2 of the linear heuristic's (L): four plates below four lights. "
         "The papers print no geometry and no unit of radiance, and their RMSE grows with the image; ratios to equal "
         "counts are compared. They agree within 5 %; ± is one standard error of ours. Here "
      << given.width << " × " << given.height << " pixels and " << given.runs << " runs";
  if (given.width < 600 || given.height < 600 || given.runs < 30) {
    text << ", which is less than T's 600 × 600 and 30 (`--full`)";
  }
  text << "; references of " << given.reference_samples
       << " samples per pixel. Every method, also with cone sampling and five techniques: "
          "`direct_lighting.csv`. Made by `direct_lighting --table1"
       << (given.convergence ? " --convergence" : "")
       << (given.full    ? " --full"
           : given.quick ? " --quick"
                         : "")
       << "`.\n\n### Printed numbers and statements on direct lighting\n\nT:\n\n"
       << of_tsallis.markdown() << "\nL, with its exponents and 100 samples per pixel:\n\n"
       << of_linear.markdown()
       << "\n### Images of direct lighting\n\n"
          "α is that of a pixel's last batch, 0 blue and 1 red; the relative error, √ of the mean of "
          "(I − R)²/(R² + 0.01) over channels and runs, is red from 100 % on. The program writes an EXR file beside "
          "each picture, "
          "with all of them.\n\n"
          "![reference](images/reference.png)\n\nThe reference (T Fig. 11).\n\nT Fig. 10, with "
       << given.samples << " samples per pixel; what is only linked is not in the paper.\n\n"
       << detail::image_table(measured, "images/") << "\nL Fig. 19.\n\n"
       << detail::image_table(linear, "images/linear_heuristic/") << '\n';
  if (!figures.empty()) {
    text << "### Convergence of direct lighting\n\nThe first is T Fig. 12.\n\n" << papers::markdown(figures);
  }
  return text.str();
}

}  // namespace direct_lighting

#endif  // PHIMIS_EXAMPLES_DIRECT_LIGHTING_SECTION_HPP
