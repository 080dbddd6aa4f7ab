// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_RENDER_COLOUR_MAP_HPP
#define PHIMIS_EXAMPLES_RENDER_COLOUR_MAP_HPP

#include <render/image.hpp>
#include <render/rgb.hpp>

#include <algorithm>
#include <cmath>

namespace render {

/// The papers' colour bar: 0 blue, cyan, green, yellow, 1 red. Values outside are as the ends; black is no number.
inline rgb colour_of(float value) {
  if (std::isnan(value)) return {};
  const float v = 4 * std::clamp(value, 0.0f, 1.0f);
  const auto ramp = [](float t) { return std::clamp(t, 0.0f, 1.0f); };
  return {ramp(v - 2), std::min(ramp(v), ramp(4 - v)), ramp(2 - v)};
}

/// The map in those colours, and to its right the bar: 0 below, 1 above.
inline image<rgb> with_colour_bar(const image<float>& values) {
  const int gap = std::max(1, values.width / 50);
  const int bar = std::max(2, values.width / 20);
  image<rgb> picture(values.width + gap + bar, values.height, rgb{1, 1, 1});
  for (int y = 0; y < values.height; ++y) {
    for (int x = 0; x < values.width; ++x) picture(x, y) = colour_of(values(x, y));
    const float height =
        static_cast<float>(values.height - 1 - y) / static_cast<float>(std::max(1, values.height - 1));
    for (int x = values.width + gap; x < picture.width; ++x) picture(x, y) = colour_of(height);
  }
  return picture;
}

}  // namespace render

#endif  // PHIMIS_EXAMPLES_RENDER_COLOUR_MAP_HPP
