// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_RENDER_TONE_MAP_HPP
#define PHIMIS_EXAMPLES_RENDER_TONE_MAP_HPP

#include <render/image.hpp>
#include <render/rgb.hpp>

#include <algorithm>
#include <cmath>

namespace render {

/// The display value in [0, 1] of a linear one.   Source IEC 61966-2-1, sRGB.
inline float srgb(float linear) {
  const float v = std::clamp(linear, 0.0f, 1.0f);
  return v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1 / 2.4f) - 0.055f;
}

/// Display values of radiance; what is brighter than 1/exposure is white.
inline image<rgb> tone_map(const image<rgb>& picture, float exposure = 1) {
  return map(picture, [&](rgb c) { return rgb{srgb(exposure * c.r), srgb(exposure * c.g), srgb(exposure * c.b)}; });
}

}  // namespace render

#endif  // PHIMIS_EXAMPLES_RENDER_TONE_MAP_HPP
