// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_RENDER_RGB_HPP
#define PHIMIS_EXAMPLES_RENDER_RGB_HPP

#include <phimis/core/finite.hpp>
#include <phimis/core/limits.hpp>
#include <phimis/core/value.hpp>

#include <cmath>

namespace render {

/// A colour, or a radiance in three bands.
struct rgb {
  float r = 0, g = 0, b = 0;

  friend constexpr rgb operator+(rgb a, rgb c) { return {a.r + c.r, a.g + c.g, a.b + c.b}; }
  friend constexpr rgb operator-(rgb a, rgb c) { return {a.r - c.r, a.g - c.g, a.b - c.b}; }
  friend constexpr rgb operator*(rgb a, rgb c) { return {a.r * c.r, a.g * c.g, a.b * c.b}; }
  friend constexpr rgb operator*(rgb a, float s) { return {a.r * s, a.g * s, a.b * s}; }
  friend constexpr bool operator==(rgb, rgb) = default;
};

constexpr float luminance(rgb c) { return 0.2126f * c.r + 0.7152f * c.g + 0.0722f * c.b; }  // Rec. 709
constexpr float mean(rgb c) { return (c.r + c.g + c.b) / 3; }

}  // namespace render

/// Fractions are learnt from luminance.
template <>
struct phimis::value_traits<render::rgb> {
  using real = float;

  static constexpr render::rgb zero() { return {}; }
  static constexpr render::rgb unknown() { return {infinity<float>, infinity<float>, infinity<float>}; }
  static constexpr float magnitude(render::rgb v) { return luminance(v) < 0 ? -luminance(v) : luminance(v); }
  static render::rgb root(render::rgb v) { return {std::sqrt(v.r), std::sqrt(v.g), std::sqrt(v.b)}; }
  static bool finite(render::rgb v) { return is_finite(v.r) && is_finite(v.g) && is_finite(v.b); }
};

#endif  // PHIMIS_EXAMPLES_RENDER_RGB_HPP
