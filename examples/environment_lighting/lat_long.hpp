// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_LAT_LONG_HPP
#define PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_LAT_LONG_HPP

#include <render/direction.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace environment_lighting {

using render::pi, render::vector;

/// A sphere of directions in rows of equal steps of the angle from +y, the first row around +y, and columns of equal steps
/// around it.
///
///     (sin θ cos φ, cos θ, sin θ sin φ) is in row ⌊height θ/π⌋, column ⌊width φ/2π⌋
class lat_long {
 public:
  lat_long(int width, int height) : width_(width), height_(height), cosine_(static_cast<std::size_t>(height) + 1) {
    for (int row = 0; row <= height; ++row) {
      cosine_[static_cast<std::size_t>(row)] =
          static_cast<float>(std::cos(static_cast<double>(pi) * row / height));
    }
    cosine_.back() = -1;
  }

  int width() const { return width_; }
  int height() const { return height_; }

  /// In steradian, of each texel of a row.
  float solid_angle(int row) const { return (upper(row) - lower(row)) * (2 * pi / static_cast<float>(width_)); }

  struct place {
    int column, row;
    float across, down;  ///< within the texel, in [0, 1): equal parts have equal solid angle
  };

  vector direction(const place& at) const {
    const float cosine = upper(at.row) - at.down * (upper(at.row) - lower(at.row));
    const float sine = std::sqrt(std::max(0.0f, (1 - cosine) * (1 + cosine)));
    const float angle = (static_cast<float>(at.column) + at.across) * (2 * pi / static_cast<float>(width_));
    return {sine * std::cos(angle), cosine, sine * std::sin(angle)};
  }

  /// Where a unit vector is.
  place find(const vector& direction) const {
    const float y = std::clamp(direction.y(), -1.0f, 1.0f);
    place at{};
    at.row = std::min(height_ - 1, static_cast<int>(std::acos(y) * (static_cast<float>(height_) / pi)));
    at.down = inside((upper(at.row) - y) / (upper(at.row) - lower(at.row)));
    float turn = std::atan2(direction.z(), direction.x()) / (2 * pi);
    turn = (turn < 0 ? turn + 1 : turn) * static_cast<float>(width_);
    at.column = std::min(width_ - 1, static_cast<int>(turn));
    at.across = inside(turn - static_cast<float>(at.column));
    return at;
  }

 private:
  float upper(int row) const { return cosine_[static_cast<std::size_t>(row)]; }
  float lower(int row) const { return cosine_[static_cast<std::size_t>(row) + 1]; }
  static float inside(float t) { return std::clamp(t, 0.0f, 0.99999994f); }

  int width_, height_;
  std::vector<float> cosine_;  ///< of the rows' bounds
};

}  // namespace environment_lighting

#endif  // PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_LAT_LONG_HPP
