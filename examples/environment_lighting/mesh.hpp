// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_MESH_HPP
#define PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_MESH_HPP

#include <render/direction.hpp>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace environment_lighting {

using render::pi, render::vector;

/// Triangles with a unit normal at each corner.
struct mesh {
  std::vector<vector> positions;
  std::vector<vector> normals;  ///< of each position; empty: triangles are flat
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

namespace detail {

/// A closed surface of columns × rows quads, x(u, v) with u, v in [0, 1]. `closed` in v: the last row is the first.
template <class Position>
mesh surface(int columns, int rows, bool closed, const Position& position) {
  mesh of;
  const auto at = [&](int i, int j) {
    return static_cast<std::uint32_t>((closed ? j % rows : j) * columns + i % columns);
  };
  for (int j = 0; j < rows + (closed ? 0 : 1); ++j) {
    for (int i = 0; i < columns; ++i) {
      of.positions.push_back(
          position(static_cast<float>(i) / static_cast<float>(columns), static_cast<float>(j) / static_cast<float>(rows)));
    }
  }
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      of.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      of.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return of;
}

}  // namespace detail

/// Twice the area of a triangle along its normal.
inline vector area_normal(const mesh& of, const std::array<std::uint32_t, 3>& triangle) {
  const vector& a = of.positions[triangle[0]];
  return (of.positions[triangle[1]] - a).cross(of.positions[triangle[2]] - a);
}

/// Leaves out triangles of no area, which no ray can hit and which have no normal; says how many.
inline std::size_t drop_flat(mesh& of) {
  return std::erase_if(of.triangles, [&](const auto& t) { return !(area_normal(of, t).squaredNorm() > 0); });
}

/// Gives each position the mean normal of the triangles around it, weighted by their area.
inline void smooth(mesh& of) {
  of.normals.assign(of.positions.size(), vector(0, 0, 0));
  for (const auto& triangle : of.triangles) {
    const vector n = area_normal(of, triangle);
    for (const std::uint32_t corner : triangle) of.normals[corner] += n;
  }
  for (vector& n : of.normals) n = n.squaredNorm() > 0 ? n.normalized() : vector(0, 1, 0);
}

/// A unit sphere.
inline mesh sphere() {
  mesh of = detail::surface(384, 192, false, [](float u, float v) {
    const float sine = v < 1 ? std::sin(pi * v) : 0.0f;  // which π of 24 bits does not give
    return vector(sine * std::cos(2 * pi * u), std::cos(pi * v), sine * std::sin(2 * pi * u));
  });
  of.normals = of.positions;
  drop_flat(of);  // at the poles
  return of;
}

/// A tube around a trefoil knot, thick and thin in turns and wavy, within the unit sphere: a solid with concavities.
inline mesh knot() {
  const auto centre = [](float t) {
    const float angle = 2 * pi * t;
    const float ring = 2 + std::cos(3 * angle);
    return vector(ring * std::cos(2 * angle), ring * std::sin(2 * angle), 1.3f * std::sin(3 * angle));
  };
  mesh of = detail::surface(96, 1200, true, [&](float u, float v) {
    const vector along = (centre(v + 1e-3f) - centre(v - 1e-3f)).normalized();
    const vector out = (vector(0, 0, 1) - along * along.z()).normalized();
    const vector side = along.cross(out);
    const float waves = 0.04f * std::sin(24 * pi * v + pi * std::cos(6 * pi * u));
    const float radius = 0.62f + 0.12f * std::sin(14 * pi * v) + waves;
    const vector x = centre(v) + (out * std::cos(2 * pi * u) + side * std::sin(2 * pi * u)) * radius;
    return vector(x / 3.8f);
  });
  smooth(of);
  return of;
}

/// A cage of square bars on the faces of a cube, `bars` in each of two directions on each face, `width` across: occluders.
inline mesh cage(float half_size, int bars, float width) {
  mesh of;
  const auto bar = [&](const vector& low, const vector& high) {
    const auto first = static_cast<std::uint32_t>(of.positions.size());
    for (unsigned i = 0; i < 8; ++i) {
      of.positions.emplace_back(i & 1 ? high.x() : low.x(), i & 2 ? high.y() : low.y(), i & 4 ? high.z() : low.z());
    }
    static constexpr std::array<std::array<std::uint32_t, 4>, 6> faces{
        {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
    for (const auto& f : faces) {
      of.triangles.push_back({first + f[0], first + f[1], first + f[2]});
      of.triangles.push_back({first + f[0], first + f[2], first + f[3]});
    }
  };
  for (int axis = 0; axis < 3; ++axis) {          // across which the face is
    for (int along = 0; along < 3; ++along) {     // the bars' direction
      if (along == axis) continue;
      const int across = 3 - axis - along;
      for (int side = -1; side <= 1; side += 2) {
        for (int i = 0; i < bars; ++i) {
          const float t = bars > 1 ? -1 + 2 * static_cast<float>(i) / static_cast<float>(bars - 1) : 0;
          vector middle(0, 0, 0), half(width / 2, width / 2, width / 2);
          middle[axis] = static_cast<float>(side) * half_size;
          middle[across] = t * half_size;
          half[along] = half_size + width / 2;
          bar(middle - half, middle + half);
        }
      }
    }
  }
  return of;
}

}  // namespace environment_lighting

#endif  // PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_MESH_HPP
