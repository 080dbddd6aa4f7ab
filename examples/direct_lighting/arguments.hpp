// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_DIRECT_LIGHTING_ARGUMENTS_HPP
#define PHIMIS_EXAMPLES_DIRECT_LIGHTING_ARGUMENTS_HPP

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
  std::int64_t reference_samples = 10000;
};

/// Adds the options to a program that knows these methods; without --method, all.
inline void add_options(CLI::App& app, arguments& to, const std::vector<std::string>& methods) {
  to.methods = methods;
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
  app.add_option("--method", to.methods, "a list; all by default")->delimiter(',')->check(CLI::IsMember(methods));
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
}

}  // namespace direct_lighting

#endif  // PHIMIS_EXAMPLES_DIRECT_LIGHTING_ARGUMENTS_HPP
