// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_MAP_FILE_HPP
#define PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_MAP_FILE_HPP

#include <environment_lighting/lat_long.hpp>
#include <papers/output_folder.hpp>
#include <render/exr.hpp>
#include <render/image.hpp>
#include <render/rgb.hpp>

#include <phimis/core/finite.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>

#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_HDR
#include <stb/stb_image.h>

namespace environment_lighting {

/// A map that can be rendered, and what had to be done to it, in one line; empty where nothing had.
struct read_map {
  render::image<render::rgb> radiance;
  std::string remark;
};

namespace detail {

inline render::image<render::rgb> read_hdr(const std::filesystem::path& file) {
  int width = 0, height = 0, channels = 0;
  const std::unique_ptr<float, decltype(&stbi_image_free)> values(
      stbi_loadf(file.c_str(), &width, &height, &channels, 3), stbi_image_free);
  if (!values) throw papers::cannot_run("cannot read " + file.string() + ": " + stbi_failure_reason());
  render::image<render::rgb> picture(width, height);
  for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
    const float* const c = values.get() + 3 * i;
    picture.pixels[i] = {c[0], c[1], c[2]};
  }
  return picture;
}

}  // namespace detail

/// Negative texels become 0, and are counted; so is a map that is black.
///
/// Errors papers::cannot_run where a texel is not finite; `name` says of what.
inline read_map checked(render::image<render::rgb> radiance, const std::string& name) {
  std::size_t unusable = 0, negative = 0, lit = 0, first = 0;
  for (std::size_t i = radiance.pixels.size(); i-- > 0;) {
    render::rgb& c = radiance.pixels[i];
    if (!phimis::value_traits<render::rgb>::finite(c)) {
      ++unusable, first = i;
      continue;
    }
    if (std::min({c.r, c.g, c.b}) < 0) {
      ++negative;
      c = {std::max(c.r, 0.0f), std::max(c.g, 0.0f), std::max(c.b, 0.0f)};
    }
    lit += luminance(c) > 0 ? 1 : 0;
  }
  if (unusable > 0) {
    const auto width = static_cast<std::size_t>(radiance.width);
    throw papers::cannot_run(name + ": " + std::to_string(unusable) + " texels are not finite, the first in column " +
                             std::to_string(first % width) + ", row " + std::to_string(first / width));
  }
  std::string remark;
  if (negative > 0) remark = name + ": " + std::to_string(negative) + " texels with a negative channel, taken as 0";
  if (lit == 0) remark += (remark.empty() ? name + ": " : "; ") + std::string("the map is black");
  return {std::move(radiance), remark};
}

/// The map of an OpenEXR or Radiance HDR file, told apart by its name.
///
/// Errors papers::cannot_run, which names the file, as `checked`, and where it is not there, or not a whole map.
inline read_map read_map_file(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) throw papers::cannot_run("there is no " + file.string());
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  if (ending != ".exr" && ending != ".hdr") {
    throw papers::cannot_run(file.string() + ": a map is a file .exr or .hdr");
  }
  return checked(ending == ".hdr" ? detail::read_hdr(file) : render::read_exr(file), file.string());
}

/// What stands for a file where analytic_sky() is meant.
inline constexpr const char* analytic_sky_name = "sky";

/// A sky to render where there is no file: a gradient above, a dim ground, a sun of .00027 sr, four times the real one's.
///
///     L = L_z + (L_h − L_z) (1 − cos θ)³ above, with the sun, whose radiance is 3e4, at θ = 50°
inline render::image<render::rgb> analytic_sky(int width = 512, int height = 256) {
  render::image<render::rgb> sky(width, height);
  const lat_long on(width, height);
  const float sun_height = std::cos(50 * pi / 180);
  const vector sun(0, sun_height, std::sqrt(1 - sun_height * sun_height));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const vector d = on.direction({x, y, 0.5f, 0.5f});
      const float haze = std::pow(1 - std::max(0.0f, d.y()), 3.0f);
      sky(x, y) = d.y() < 0 ? render::rgb{0.1f, 0.09f, 0.08f}
                            : render::rgb{0.2f, 0.4f, 0.9f} + render::rgb{0.6f, 0.5f, 0.1f} * haze;
      if (1 - d.dot(sun) < 4.3e-5f) sky(x, y) = {30000, 28000, 24000};
    }
  }
  return sky;
}

}  // namespace environment_lighting

#endif  // PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_MAP_FILE_HPP
