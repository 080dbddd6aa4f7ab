// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_DIRECT_LIGHTING_REFERENCE_HPP
#define PHIMIS_EXAMPLES_DIRECT_LIGHTING_REFERENCE_HPP

#include <direct_lighting/scene.hpp>
#include <direct_lighting/techniques.hpp>
#include <render/fixed_counts.hpp>
#include <render/progress.hpp>
#include <render/reference.hpp>

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
///
/// Errors as kept_image.
inline render::image<render::rgb> reference(const std::filesystem::path& folder, const scene_options& options,
                                            const scene& of, const render::image<shading_point>& points,
                                            std::int64_t samples, int threads) {
  const std::filesystem::path file = folder / reference_name(options, points.width, points.height, samples);
  return render::kept_image(file, points.width, points.height, [&] {
    render::progress bar("reference", render::tile_count(points.width, points.height));
    return render::render_image(points, techniques<5, cone_sampling>(of), render::equal_counts<5>(samples),
                                render::random_stream(0, 0, render::of_reference), threads, [&] { bar.advance(); });
  });
}

}  // namespace direct_lighting

#endif  // PHIMIS_EXAMPLES_DIRECT_LIGHTING_REFERENCE_HPP
