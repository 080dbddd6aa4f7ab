// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_DIRECT_LIGHTING_REFERENCE_HPP
#define PHIMIS_EXAMPLES_DIRECT_LIGHTING_REFERENCE_HPP

#include <direct_lighting/render.hpp>
#include <papers/output_folder.hpp>
#include <render/exr.hpp>
#include <render/progress.hpp>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>

namespace direct_lighting {

/// A file name that is different for every reference.
inline std::string reference_name(const scene_options& of, int width, int height, std::int64_t samples) {
  char text[240];
  std::snprintf(text, sizeof text, "reference_%dx%d_%lld_samples_plates%d_exponents%.9g-%.9g-%.9g-%.9g_radii%.9g.exr",
                width, height, static_cast<long long>(samples), of.plates, of.exponents[0], of.exponents[1],
                of.exponents[2], of.exponents[3], of.radius_scale);
  return text;
}

/// The image that others are compared with: five techniques with cone sampling, equal counts, random numbers of its own.
/// It is read from the folder where it is there, and written there where it is not.
///
/// Errors papers::cannot_run where it cannot be written. A file that cannot be read is replaced.
inline render::image<render::rgb> reference(const std::filesystem::path& folder, const scene_options& options,
                                            const scene& of, const render::image<shading_point>& points,
                                            std::int64_t samples, int threads) {
  const std::filesystem::path file = folder / reference_name(options, points.width, points.height, samples);
  if (std::filesystem::exists(file)) {
    try {
      render::image<render::rgb> cached = render::read_exr(file);
      if (cached.width == points.width && cached.height == points.height) return cached;
    } catch (const papers::cannot_run&) {
    }
  }
  constexpr std::uint32_t purpose = 1;
  render::progress bar("reference", render::tile_count(points.width, points.height));
  const techniques<5, cone_sampling> all(of);
  const auto picture = render_image(points, all, equal_counts<5>(samples), render::random_stream(0, 0, purpose),
                                    threads, [&] { bar.advance(); });
  render::write_exr(file, picture);
  return picture;
}

}  // namespace direct_lighting

#endif  // PHIMIS_EXAMPLES_DIRECT_LIGHTING_REFERENCE_HPP
