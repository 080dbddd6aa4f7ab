// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_DIRECT_LIGHTING_IMAGE_FILES_HPP
#define PHIMIS_EXAMPLES_DIRECT_LIGHTING_IMAGE_FILES_HPP

#include <direct_lighting/table.hpp>
#include <papers/output_folder.hpp>
#include <render/colour_map.hpp>
#include <render/exr.hpp>
#include <render/png.hpp>
#include <render/tone_map.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>

namespace direct_lighting {

/// The fraction of all light techniques; no number where no plate is seen.
inline render::image<float> fraction_of_lights(const rendering& of, const render::image<shading_point>& points) {
  render::image<float> alpha(points.width, points.height, std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < alpha.pixels.size(); ++i) {
    if (points.pixels[i].part != shading_point::no_part) alpha.pixels[i] = 1 - of.fractions.back().pixels[i];
  }
  return alpha;
}

/// The names of a method's files, without their endings.
inline std::string image_name(const configuration& of) {
  std::string name = of.setting + '_' + std::to_string(of.techniques) + '_' + of.method;
  std::replace(name.begin(), name.end(), ':', '_');
  return name;
}

/// The picture, its errors, and where fractions are learnt a map of them in the papers' colours; the EXR file has all of
/// them as channels.
inline void write_images(const papers::output_folder& folder, const measured_method& m,
                         const render::image<shading_point>& points) {
  const std::string name = image_name(m.of);
  const auto file = [&](const char* ending) { return folder.path() / (name + ending); };
  std::map<std::string, render::image<float>> channels{{"relative_error", m.error_map}};
  const auto& fractions = m.first_run.fractions;
  for (std::size_t k = 0; k < fractions.size(); ++k) {
    const bool brdf = k + 1 == fractions.size();
    channels[brdf ? "alpha_brdf" : "alpha_light" + (fractions.size() > 2 ? std::to_string(k) : "")] = fractions[k];
  }
  render::write_png(file(".png"), render::tone_map(m.first_run.picture));
  render::write_exr(file(".exr"), m.first_run.picture, channels);
  // The root is a relative error: red where it is 100 %.
  render::write_png(file("_error.png"),
                    render::with_colour_bar(render::map(m.error_map, [](float e) { return std::sqrt(e); })));
  if (!fractions.empty()) {
    render::write_png(file("_alpha.png"), render::with_colour_bar(fraction_of_lights(m.first_run, points)));
  }
}

}  // namespace direct_lighting

#endif  // PHIMIS_EXAMPLES_DIRECT_LIGHTING_IMAGE_FILES_HPP
