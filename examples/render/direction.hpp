// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_RENDER_DIRECTION_HPP
#define PHIMIS_EXAMPLES_RENDER_DIRECTION_HPP

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

namespace render {

using vector = Eigen::Vector3f;

inline constexpr float pi = std::numbers::pi_v<float>;

/// Two unit vectors that are orthogonal to a unit vector n and to each other.
/// Source Duff et al. 2017, Building an orthonormal basis, revisited.
struct frame {
  explicit frame(const vector& n) {
    const float sign = std::copysign(1.0f, n.z());
    const float a = -1 / (sign + n.z());
    const float b = n.x() * n.y() * a;
    s = vector(1 + sign * n.x() * n.x() * a, sign * b, -sign * n.x());
    t = vector(b, sign + n.y() * n.y() * a, -n.y());
  }
  vector s, t;
};

/// The direction at angle θ from the axis and 2πu around it.  Requires cosine² + sine² = 1, u in [0, 1).
inline vector around(const vector& axis, float cosine, float sine, float u) {
  const frame f(axis);
  const float angle = 2 * pi * u;
  return axis * cosine + f.s * (sine * std::cos(angle)) + f.t * (sine * std::sin(angle));
}

/// The u of around().
inline float turn(const vector& axis, const vector& direction) {
  const frame f(axis);
  const float u = std::atan2(direction.dot(f.t), direction.dot(f.s)) / (2 * pi);
  return u < 0 ? u + 1 : u;
}

}  // namespace render

#endif  // PHIMIS_EXAMPLES_RENDER_DIRECTION_HPP
