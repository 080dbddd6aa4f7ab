// SPDX-License-Identifier: MIT
// The command lines of the examples: any arguments, one a line, are either refused in words or something that can run.
#include "bytes.hpp"

#include <direct_lighting/arguments.hpp>
#include <direct_lighting/method_name.hpp>
#include <direct_lighting/scene.hpp>
#include <papers/program.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

namespace {

/// Whether a parser takes the arguments. CLI11 takes them in reverse.
bool parses(CLI::App& app, std::vector<std::string> arguments) {
  std::reverse(arguments.begin(), arguments.end());
  try {
    app.parse(arguments);
    return true;
  } catch (const CLI::ParseError& error) {
    demand(error.get_exit_code() == 0 || error.what()[0] != '\0' ? "" : "a refusal without words");
    return false;
  }
}

bool within(std::int64_t value, std::int64_t least, std::int64_t largest) { return value >= least && value <= largest; }

void direct_lighting_line(const std::vector<std::string>& arguments) {
  direct_lighting::arguments given;
  CLI::App app;
  direct_lighting::add_options(app, given);
  if (!parses(app, arguments) || !accepts([&] { direct_lighting::settle(app, given); })) return;
  demand(within(given.width, 1, 4096) && within(given.height, 1, 4096) ? "" : "an image without a size");
  demand(within(given.samples, 1, 1000000) && within(given.runs, 1, 100000) ? "" : "no samples");
  demand(within(given.threads, 1, 1024) ? "" : "no threads");
  demand(given.techniques == 2 || given.techniques == 5 ? "" : "a number of techniques that there is not");
  demand(given.sampler == "area" || given.sampler == "cone" ? "" : "a sampler that there is not");
  demand(!(given.quick && given.full) ? "" : "quick and full");
  demand(!given.methods.empty() ? "" : "no method");
  for (const std::string& method : given.methods) {
    const direct_lighting::configuration what{given.sampler, given.techniques, method, given.samples};
    if (!accepts([&] { direct_lighting::check(what); })) continue;
    const auto [family, gamma] = direct_lighting::parse_method(method);
    demand(method == family || (gamma > 0 && std::isfinite(gamma)) ? "" : "a method with the order " + method);
  }
  // Lights and plates of numbers, or a refusal.
  accepts([&] {
    const direct_lighting::scene scene(given.scene);
    for (const auto& plate : scene.plates) demand(std::isfinite(plate.exponent) ? "" : "a plate without exponent");
    for (const auto& light : scene.lights) {
      demand(std::isfinite(light.radius) && light.radius > 0 ? "" : "a light without radius");
      demand(phimis::value_traits<render::rgb>::finite(light.radiance) ? "" : "a light without radiance");
    }
  });
}

void papers_line(const std::vector<std::string>& arguments) {
  papers::arguments given;
  CLI::App app;
  papers::add_options(app, given, {"", "", "", ""});
  if (parses(app, arguments)) demand(!(given.quick && given.full) ? "" : "quick and full");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::istringstream text(std::string(data, data + size));
  std::vector<std::string> arguments;
  for (std::string line; std::getline(text, line);) arguments.push_back(line);
  direct_lighting_line(arguments);
  papers_line(arguments);
  return 0;
}
