// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_DIRECT_LIGHTING_LIGHT_SAMPLING_HPP
#define PHIMIS_EXAMPLES_DIRECT_LIGHTING_LIGHT_SAMPLING_HPP

#include <render/direction.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace direct_lighting {

using render::around, render::pi, render::turn, render::vector;

/// A light sphere as it is seen from a point outside.
///
///     s = r/d,   cap = 1 − cos θ_max = s²/(1 + √(1−s²))        exact in float for every s
struct seen_light {
  seen_light() = default;
  seen_light(const vector& from, const vector& centre, float light_radius)
      : axis(centre - from), distance(axis.norm()), radius(light_radius) {
    axis /= distance;
    const float s = radius / distance;
    cap = s * s / (1 + std::sqrt((1 - s) * (1 + s)));
  }

  vector axis{0, 0, 1};  ///< towards the centre
  float distance = 1;    ///< of the centre
  float radius = 0;
  float cap = 0;
};

/// 1 − cos of the angle between a direction and the light's axis: of two unit vectors, half their squared difference, which
/// does not cancel for small angles.
inline float from_axis(const seen_light& light, const vector& direction) {
  return 0.5f * (direction - light.axis).squaredNorm();
}
inline bool hits(const seen_light& light, const vector& direction) { return from_axis(light, direction) < light.cap; }

/// Distance at which a ray that hits the light enters it.   d cos θ − d √(s² − sin²θ)
/// The cosine there, between the surface's normal and the way back, is √(s² − sin²θ)/s.
struct entry {
  entry(const seen_light& light, const vector& direction) {
    const float t = from_axis(light, direction);
    const float s = light.radius / light.distance;
    const float root = std::sqrt(std::max(0.0f, s * s - t * (2 - t)));
    distance = light.distance * (1 - t - root);
    cosine = root / s;
  }
  float distance, cosine;
};

/// A point of a light's surface: where it is seen, and the solid angle of a unit of the sampler's measure there.
struct light_point {
  vector direction;
  float solid_angle;
};

/// A point uniform on the whole sphere, so that half of the points face away. The measure is area: dω/dA = cos θ_l/d², 0
/// where the surface faces away.
struct area_sampling {
  static float pdf(const seen_light& light) { return 1 / (4 * pi * light.radius * light.radius); }

  static light_point sample(const seen_light& light, float u1, float u2) { return at(light, normal(u1, u2)); }
  static light_point hit(const seen_light& light, const vector& direction) {
    const entry in(light, direction);
    return {direction, in.cosine / (in.distance * in.distance)};
  }

  static vector normal(float u1, float u2) {
    const float angle = 2 * pi * u2;
    const float ring = 2 * std::sqrt(u1 * (1 - u1));
    return {ring * std::cos(angle), ring * std::sin(angle), 1 - 2 * u1};
  }
  /// The numbers that normal() makes this one of.
  static std::array<float, 2> invert(const vector& normal) {
    const float u2 = std::atan2(normal.y(), normal.x()) / (2 * pi);
    return {(1 - normal.z()) / 2, u2 < 0 ? u2 + 1 : u2};
  }
  static light_point at(const seen_light& light, const vector& normal) {
    const vector to = light.axis * light.distance + normal * light.radius;
    const float squared = to.squaredNorm();
    const vector direction = to / std::sqrt(squared);
    return {direction, std::max(0.0f, -normal.dot(direction)) / squared};
  }
};

/// A direction uniform in the cone that the sphere subtends. The measure is solid angle.
struct cone_sampling {
  static float pdf(const seen_light& light) { return 1 / (2 * pi * light.cap); }

  static light_point sample(const seen_light& light, float u1, float u2) {
    const float t = u1 * light.cap;
    return {around(light.axis, 1 - t, std::sqrt(t * (2 - t)), u2), 1};
  }
  static light_point hit(const seen_light&, const vector& direction) { return {direction, 1}; }

  /// The numbers that sample() makes this direction of.
  static std::array<float, 2> invert(const seen_light& light, const vector& direction) {
    return {from_axis(light, direction) / light.cap, turn(light.axis, direction)};
  }
};

}  // namespace direct_lighting

#endif  // PHIMIS_EXAMPLES_DIRECT_LIGHTING_LIGHT_SAMPLING_HPP
