// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_DIRECT_LIGHTING_ARGUMENTS_HPP
#define PHIMIS_EXAMPLES_DIRECT_LIGHTING_ARGUMENTS_HPP

#include <direct_lighting/method_name.hpp>
#include <direct_lighting/scene.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>
#include <thread>
#include <vector>

namespace direct_lighting {

/// The command line of the program.
struct arguments {
  int width = 200;
  int height = 200;
  std::int64_t samples = 50;
  int runs = 10;
  std::uint64_t seed = 1;
  int threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  std::string sampler = "area";
  int techniques = 2;
  std::vector<std::string> methods;
  scene_options scene;
  std::string output = "reproduction";
  std::int64_t reference_samples = 50000;  // as T's

  bool table1 = false, never_worse = false, convergence = false, overhead = false;
  bool quick = false, full = false;

  /// Whether a study is asked for in place of the methods of one sampler and one number of techniques.
  bool studies() const { return table1 || never_worse || convergence || overhead; }

  /// Whether what is rendered is what the papers print numbers of, often enough to tell its noise.
  bool as_printed() const { return table1 && scene == scene_options{} && samples == 50 && runs > 1; }
};

/// Adds the options to a program. After parsing, settle() is called.
inline void add_options(CLI::App& app, arguments& to) {
  const int largest = 4096;
  app.add_option("--width", to.width, "pixels")->capture_default_str()->check(CLI::Range(1, largest));
  app.add_option("--height", to.height, "pixels")->capture_default_str()->check(CLI::Range(1, largest));
  app.add_option("--samples", to.samples, "samples per pixel, of all techniques together")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000000));
  app.add_option("--runs", to.runs, "independent images per method")
      ->capture_default_str()
      ->check(CLI::Range(1, 100000));
  app.add_option("--seed", to.seed, "of all random numbers but the reference's")
      ->capture_default_str()
      ->check([](const std::string& text) { return text[0] == '-' ? "must not be negative" : std::string(); });
  app.add_option("--threads", to.threads, "images do not depend on it")
      ->capture_default_str()
      ->check(CLI::Range(1, 1024));
  app.add_option("--sampler", to.sampler, "points of the whole sphere, or of what is seen of it")
      ->capture_default_str()
      ->check(CLI::IsMember({"area", "cone"}));
  app.add_option("--techniques", to.techniques, "lights and BRDF, or each light and BRDF")
      ->capture_default_str()
      ->check(CLI::IsMember({2, 5}));
  app.add_option("--method", to.methods,
                 "a list of brdf, light, equal, default, variance; with two techniques also tsallis:G, newton:G, linear")
      ->delimiter(',');
  app.add_option_function<std::vector<float>>(
         "--exponents",
         [&to](const std::vector<float>& given) { std::copy_n(given.begin(), 4, to.scene.exponents.begin()); },
         "of the plates from the front: a,b,c,d (50,100,500,1000)")
      ->delimiter(',')
      ->expected(4);
  app.add_option("--plates", to.scene.plates, "from the front")->capture_default_str()->check(CLI::Range(1, 4));
  app.add_option("--radius-scale", to.scene.radius_scale, "of all lights, at the same power")->capture_default_str();
  app.add_option("--output", to.output, "folder of images and tables")->capture_default_str();
  app.add_option("--reference-samples", to.reference_samples, "samples per pixel of the reference, which is kept")
      ->capture_default_str()
      ->check(CLI::Range(std::int64_t{5}, std::int64_t{100000000}));
  app.add_flag("--table1", to.table1,
               "the report on T's Table 1 and L's Sec. 6.2; both samplers, both numbers of techniques");
  app.add_flag("--never-worse", to.never_worse,
               "the default against equal counts over many scenes and sample counts");
  app.add_flag("--convergence", to.convergence, "figures of errors against samples and seconds");
  app.add_flag("--overhead", to.overhead, "what rules cost, in time and in memory");
  auto* const quick = app.add_flag("--quick", to.quick, "small images, few runs");
  app.add_flag("--full", to.full, "600 by 600 pixels, 30 runs, as T; the whole grid of --never-worse")
      ->excludes(quick);
}

/// Fills in what was not given.   Errors std::invalid_argument for methods that there are not.
inline void settle(const CLI::App& app, arguments& to) {
  const auto unless_given = [&](const char* option, auto& value, auto otherwise) {
    if (app.get_option(option)->count() == 0) value = otherwise;
  };
  if (to.quick) {
    unless_given("--width", to.width, 48);
    unless_given("--height", to.height, 48);
    unless_given("--runs", to.runs, 10);
    unless_given("--reference-samples", to.reference_samples, 2000);
  }
  if (to.full) {
    unless_given("--width", to.width, 600);
    unless_given("--height", to.height, 600);
    unless_given("--runs", to.runs, 30);
  }
  unless_given("--method", to.methods, methods_of(to.techniques));
  for (const std::string& method : to.methods) parse_method(method);
}

}  // namespace direct_lighting

#endif  // PHIMIS_EXAMPLES_DIRECT_LIGHTING_ARGUMENTS_HPP
