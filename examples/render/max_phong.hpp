// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_RENDER_MAX_PHONG_HPP
#define PHIMIS_EXAMPLES_RENDER_MAX_PHONG_HPP

#include <render/direction.hpp>

#include <algorithm>
#include <cmath>

namespace render {

/// The max-Phong BRDF at a point with normal N that is seen from the direction V, and sampling in proportion to it.
///
///     f_r(L) = k_d/π + k_s (n+1)/(2π) max(0, R·V)^n / max(N·L, N·V)
///     p(L)   = k_d N·L/π + k_s (n+1)/(2π) max(0, R·V)^n        above the horizon
///
/// R·V, where R mirrors L, is L·V' where V' mirrors V. The pdf is defective: absorbed samples, and those of the lobe
/// that are below the horizon, are lost. f_r N·L <= p: sampling has a bounded weight.
///
/// Source   Neumann, Neumann & Szirmay-Kalos 1999.
/// Units    radians; pdf in 1/sr.
/// Requires unit vectors, N·V > 0, n >= 0, diffuse + specular <= 1.
class max_phong {
 public:
  max_phong() = default;
  max_phong(const vector& normal, const vector& view, float exponent, float diffuse = 0.5f, float specular = 0.5f)
      : normal_(normal),
        mirrored_view_(2 * normal.dot(view) * normal - view),
        normal_view_(normal.dot(view)),
        exponent_(exponent),
        diffuse_(diffuse),
        specular_(specular),
        lobe_(specular * (exponent + 1) / (2 * pi)) {}

  /// f_r(L) N·L and p(L), both 0 at and below the horizon.
  struct reflection {
    float brdf_cosine = 0;
    float pdf = 0;
  };
  reflection operator()(const vector& light) const {
    const float cosine = normal_.dot(light);
    if (!(cosine > 0)) return {};
    const float lobe = lobe_ * std::pow(std::clamp(mirrored_view_.dot(light), 0.0f, 1.0f), exponent_);
    const float diffuse = diffuse_ / pi * cosine;
    return {diffuse + lobe * std::min(1.0f, cosine / normal_view_), diffuse + lobe};
  }

  /// Draws L with density p and says whether there is one: false where the sample was absorbed or is below the horizon.
  bool sample(float u0, float u1, float u2, vector& light) const {
    if (u0 < diffuse_) {
      light = cosine_direction(u1, u2);
    } else if (u0 < diffuse_ + specular_) {
      light = lobe_direction(u1, u2);
    } else {
      return false;
    }
    return normal_.dot(light) > 0;
  }

  const vector& normal() const { return normal_; }
  const vector& mirrored_view() const { return mirrored_view_; }

 private:
  /// pdf N·L/π.
  vector cosine_direction(float u1, float u2) const { return around(normal_, std::sqrt(1 - u1), std::sqrt(u1), u2); }
  /// cos a = u^(1/(n+1)) around V': pdf (n+1)/(2π) cos^n a.
  vector lobe_direction(float u1, float u2) const {
    const float cosine = std::pow(1 - u1, 1 / (exponent_ + 1));
    return around(mirrored_view_, cosine, std::sqrt((1 - cosine) * (1 + cosine)), u2);
  }

  vector normal_{0, 0, 1};
  vector mirrored_view_{0, 0, 1};
  float normal_view_ = 1;
  float exponent_ = 0;
  float diffuse_ = 0;
  float specular_ = 0;
  float lobe_ = 0;
};

}  // namespace render

#endif  // PHIMIS_EXAMPLES_RENDER_MAX_PHONG_HPP
