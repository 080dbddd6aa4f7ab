// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_DIRECT_LIGHTING_SCENE_HPP
#define PHIMIS_EXAMPLES_DIRECT_LIGHTING_SCENE_HPP

#include <direct_lighting/light_sampling.hpp>
#include <render/direction.hpp>
#include <render/image.hpp>
#include <render/light_sample.hpp>
#include <render/max_phong.hpp>
#include <render/parallel.hpp>
#include <render/rgb.hpp>

#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace direct_lighting {

inline constexpr int light_count = 4;

/// What may differ from the papers' scene. Plates count from the front.
struct scene_options {
  std::array<float, 4> exponents{50, 100, 500, 1000};
  int plates = 4;
  float radius_scale = 1;  ///< of all lights; their power stays

  friend bool operator==(const scene_options&, const scene_options&) = default;
};

/// A rectangle, half_width in x and 1 across, that reflects on its upper side.
struct plate {
  static constexpr float half_width = 8, half_depth = 1;

  vector corner(int i) const {
    return centre + across() * (i < 2 ? half_depth : -half_depth) +
           vector::UnitX() * (i % 2 ? half_width : -half_width);
  }
  vector across() const { return {0, normal.z(), -normal.y()}; }

  vector centre, normal;
  float exponent;
};

struct light {
  vector centre;
  float radius;
  render::rgb radiance;
  float power;
};

/// What a pixel sees: a point of a plate, its part, with what of it does not depend on samples; or only `emitted`.
struct shading_point : render::seen_point {
  vector position{0, 0, 0};
  render::max_phong surface;
  std::array<seen_light, light_count> lights;
  std::array<unsigned char, light_count>
      hiding{};  ///< for each light, a bit for each light that may be in front of it
};

/// Four glossy plates below four lights of equal power, after Veach 1997.
///
/// Errors std::invalid_argument for options that make no scene.
class scene {
 public:
  explicit scene(const scene_options& options = {}) : plates_(options.plates) {
    if (options.plates < 1 || options.plates > 4) throw std::invalid_argument("there are 1 to 4 plates");
    if (!(options.radius_scale >= 1e-3f)) throw std::invalid_argument("the radius scale must be at least 0.001");
    const float radii[] = {0.07f, 0.16f, 0.4f, 1};
    const render::rgb colours[] = {{4, 2, 1}, {2, 4, 1}, {2, 1, 4}, {4, 1, 2}};
    for (int k = 0; k < light_count; ++k) {
      const float r = radii[k] * options.radius_scale;
      const float power = 60;
      const render::rgb radiance = colours[k] * (power / (mean(colours[k]) * 4 * pi * pi * r * r));
      lights[at(k)] = {{-4.5f + 3 * static_cast<float>(k), 4, -6}, r, radiance, power};
    }
    const vector centres[] = {{0, -4, 2}, {0, -3.5f, -2}, {0, -2.5f, -6}, {0, -1, -10}};
    for (int i = 0; i < 4; ++i) {
      const vector to_eye = (eye() - centres[i]).normalized();
      const vector to_lights = (vector(0, 4, -6) - centres[i]).normalized();
      if (!(options.exponents[at(i)] >= 0 && options.exponents[at(i)] <= 1e6f)) {
        throw std::invalid_argument("exponents are numbers from 0 to 1e6");
      }
      plates[at(i)] = {centres[i], (to_eye + to_lights).normalized(), options.exponents[at(i)]};
    }
    for (const plate& a : plates) {
      for (const plate& b : plates) {
        for (const light& l : lights) {
          if (!in_sight(a, l, b))
            throw std::invalid_argument("the radius scale is so large that lights reach the plates");
        }
      }
    }
  }

  static vector eye() { return {0, 6, 18}; }

  /// Of the max-Phong lobe of plate i.
  float exponent(int i) const { return plates[at(i)].exponent; }

  /// The point in the middle of pixel (x, y) of an image; 35° from its lower to its upper edge, square pixels.
  shading_point shade(int x, int y, int width, int height) const {
    const vector forward = -eye().normalized();
    const vector up = vector::UnitX().cross(forward);
    const float pixel = 2 * std::tan(35 * pi / 360) / static_cast<float>(height);
    const float right = (static_cast<float>(x) + 0.5f - static_cast<float>(width) / 2) * pixel;
    const float above = (static_cast<float>(height) / 2 - static_cast<float>(y) - 0.5f) * pixel;
    const vector direction = (forward + right * vector::UnitX() + above * up).normalized();
    shading_point point;
    float nearest = std::numeric_limits<float>::infinity();
    for (int k = 0; k < light_count; ++k) {
      const seen_light seen(eye(), lights[at(k)].centre, lights[at(k)].radius);
      if (!hits(seen, direction)) continue;
      const float distance = entry(seen, direction).distance;
      if (distance < nearest) nearest = distance, point.emitted = lights[at(k)].radiance;
    }
    int visible = shading_point::no_part;
    for (int i = 0; i < plates_; ++i) {
      const float distance = distance_to(plates[at(i)], eye(), direction);
      if (distance < nearest) nearest = distance, visible = i;
    }
    return visible == shading_point::no_part ? point : on_plate(visible, eye() + direction * nearest, -direction);
  }

  /// A point of plate i, seen from the unit vector `view`.
  shading_point on_plate(int i, const vector& position, const vector& view) const {
    shading_point point;
    const plate& under = plates[at(i)];
    point.part = i;
    point.position = position;
    point.surface = render::max_phong(under.normal, view, under.exponent);
    for (int k = 0; k < light_count; ++k) {
      point.lights[at(k)] = seen_light(position, lights[at(k)].centre, lights[at(k)].radius);
    }
    for (int k = 0; k < light_count; ++k) {
      for (int j = 0; j < light_count; ++j) {
        if (j != k && overlap(point.lights[at(j)], point.lights[at(k)])) {
          point.hiding[at(k)] = static_cast<unsigned char>(point.hiding[at(k)] | 1u << j);
        }
      }
    }
    return point;
  }

  /// Whether nothing is before light k in a direction in which a ray from the point hits it. Only lights can be: that no
  /// plate is between a plate and a light is checked once, at construction.
  static bool visible(const shading_point& from, int k, const vector& direction) {
    const unsigned before = from.hiding[at(k)];
    if (before == 0) return true;
    const float distance = entry(from.lights[at(k)], direction).distance;
    for (int j = 0; j < light_count; ++j) {
      const seen_light& other = from.lights[at(j)];
      if ((before >> j & 1u) && hits(other, direction) && entry(other, direction).distance < distance) return false;
    }
    return true;
  }

  std::array<light, light_count> lights;
  std::array<plate, 4> plates;

 private:
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }

  /// Infinite where the ray misses.
  static float distance_to(const plate& p, const vector& from, const vector& direction) {
    const float distance = p.normal.dot(p.centre - from) / p.normal.dot(direction);
    const vector in_plane = from + direction * distance - p.centre;
    const bool inside = distance > 0 && std::fabs(in_plane.x()) <= plate::half_width &&
                        std::fabs(in_plane.dot(p.across())) <= plate::half_depth;
    return inside ? distance : std::numeric_limits<float>::infinity();
  }

  /// False only where the two cones have no direction in common.
  static bool overlap(const seen_light& a, const seen_light& b) {
    const float most = std::acos(1 - a.cap) + std::acos(1 - b.cap) + 1e-3f;  // acos is that exact near 1
    return a.axis.dot(b.axis) > std::cos(std::min(most, pi));
  }

  /// Whether light l is clear of plate b and nothing of b is between it and plate a: the plane of b, or a horizontal one,
  /// has b on one side and both others on the other.
  static bool in_sight(const plate& a, const light& l, const plate& b) {
    bool above_plane = b.normal.dot(l.centre - b.centre) > l.radius;
    float lowest = l.centre.y() - l.radius, highest = -std::numeric_limits<float>::infinity();
    for (int c = 0; c < 4; ++c) {
      above_plane = above_plane && (&a == &b || b.normal.dot(a.corner(c) - b.centre) > 0);
      lowest = std::min(lowest, a.corner(c).y());
      highest = std::max(highest, b.corner(c).y());
    }
    return above_plane || lowest > highest;
  }

  int plates_;
};

/// What the pixels of an image see.
inline render::image<shading_point> shading_points(const scene& of, int width, int height, int threads) {
  render::image<shading_point> points(width, height);
  render::for_each_tile(width, height, threads, [&](const render::tile& t) {
    for (int y = t.y0; y < t.y1; ++y) {
      for (int x = t.x0; x < t.x1; ++x) points(x, y) = of.shade(x, y, width, height);
    }
  });
  return points;
}

}  // namespace direct_lighting

#endif  // PHIMIS_EXAMPLES_DIRECT_LIGHTING_SCENE_HPP
