// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_ARGUMENTS_HPP
#define PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_ARGUMENTS_HPP

#include <environment_lighting/cases.hpp>
#include <environment_lighting/methods.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

namespace environment_lighting {

/// The command line of the program.
struct arguments {
  int width = 96;
  int height = 96;
  std::vector<std::int64_t> samples{100, 200, 500};
  int runs = 1;
  std::uint64_t seed = 1;
  int threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  std::vector<std::string> methods = all_methods();
  std::vector<int> cases;
  std::string maps = "/usr/share/blender/datafiles/studiolights/world";
  test_case own{"", "", "sphere", "glossy:100"};
  std::string output = "reproduction";
  std::int64_t reference_samples = 10000;
  bool quick = false, full = false;

  /// Whether the ten cases are rendered, or what is given of one.
  bool is_own() const { return !own.map.empty(); }
};

/// Adds the options to a program. After parsing, settle() is called.
inline void add_options(CLI::App& app, arguments& to) {
  const int largest = 4096;
  app.add_option("--cases", to.cases, "a list of numbers from 1 to 10; all")->delimiter(',')->check(CLI::Range(1, 10));
  app.add_option("--maps", to.maps, "folder of the eight maps, from Debian's blender-data")->capture_default_str();
  auto* const map =
      app.add_option("--map", to.own.map, "lat-long map .exr or .hdr, or sky: one case in place of the ten");
  app.add_option("--object", to.own.object, "sphere, knot, or an OBJ or PLY file")->capture_default_str()->needs(map);
  app.add_option("--material", to.own.material, "lambert, varying, or glossy:N with the exponent N")
      ->capture_default_str()
      ->needs(map);
  app.add_option("--width", to.width, "pixels")->capture_default_str()->check(CLI::Range(1, largest));
  app.add_option("--height", to.height, "pixels")->capture_default_str()->check(CLI::Range(1, largest));
  app.add_option("--samples", to.samples, "a list of samples per pixel, of all techniques together")
      ->capture_default_str()
      ->delimiter(',')
      ->check(CLI::Range(fewest_samples, std::int64_t{1000000}));
  app.add_option("--runs", to.runs, "independent images per method")
      ->capture_default_str()
      ->check(CLI::Range(1, 100000));
  app.add_option("--seed", to.seed, "of all random numbers but the reference's")
      ->capture_default_str()
      ->check([](const std::string& text) { return text[0] == '-' ? "must not be negative" : std::string(); });
  app.add_option("--threads", to.threads, "images do not depend on it")
      ->capture_default_str()
      ->check(CLI::Range(1, 1024));
  app.add_option("--method", to.methods,
                 "a list of map, brdf, equal, lu, eq31, tsallis:G, linear, equal3, default; equal is added")
      ->delimiter(',');
  app.add_option("--output", to.output, "folder of images and tables")->capture_default_str();
  app.add_option("--reference-samples", to.reference_samples, "samples per pixel of the reference, which is kept")
      ->capture_default_str()
      ->check(CLI::Range(std::int64_t{6}, std::int64_t{100000000}));
  auto* const quick = app.add_flag("--quick", to.quick, "64 by 64 pixels, two cases, up to 200 samples");
  app.add_flag("--full", to.full, "256 by 256 pixels, 100 to 1500 samples, as V")->excludes(quick);
}

/// Fills in what was not given.   Errors std::invalid_argument for what there is not.
inline void settle(const CLI::App& app, arguments& to) {
  const auto unless_given = [&](const char* option, auto& value, const auto& otherwise) {
    if (app.get_option(option)->count() == 0) value = otherwise;
  };
  if (to.quick) {
    unless_given("--width", to.width, 64);
    unless_given("--height", to.height, 64);
    unless_given("--samples", to.samples, std::vector<std::int64_t>{100, 200});
    unless_given("--cases", to.cases, std::vector<int>{4, 7});
    unless_given("--reference-samples", to.reference_samples, 4000);
  }
  if (to.full) {
    unless_given("--width", to.width, 256);
    unless_given("--height", to.height, 256);
    unless_given("--samples", to.samples, std::vector<std::int64_t>{100, 200, 500, 1000, 1500});
    unless_given("--reference-samples", to.reference_samples, 20000);
  }
  if (to.cases.empty()) to.cases = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
  std::sort(to.samples.begin(), to.samples.end());
  if (std::find(to.methods.begin(), to.methods.end(), "equal") == to.methods.end()) {
    to.methods.insert(to.methods.begin(), "equal");
  }
  for (const std::string& method : to.methods) {
    for (const std::int64_t samples : to.samples) check(method, samples);
  }
  if (to.is_own()) make_material(to.own.material);
}

/// The cases to render, with the sky where a map of the ten is not there; each such is printed.
inline std::vector<test_case> cases_of(const arguments& given) {
  if (given.is_own()) {
    test_case own = given.own;
    const auto short_name = [](const std::string& of) { return std::filesystem::path(of).stem().string(); };
    own.name = short_name(own.map) + ", " + short_name(own.object) + ", " + own.material;
    return {own};
  }
  const std::vector<test_case> all = ten_cases(given.maps);
  std::vector<test_case> cases;
  for (const int number : given.cases) {
    test_case one = all[static_cast<std::size_t>(number - 1)];
    if (!std::filesystem::exists(one.map)) {
      std::printf("there is no %s (Debian: blender-data): case %d is lit by a sky in its place\n", one.map.c_str(),
                  number);
      one.map = analytic_sky_name;
      one.name += ", lit by a sky";
    }
    cases.push_back(one);
  }
  return cases;
}

}  // namespace environment_lighting

#endif  // PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_ARGUMENTS_HPP
