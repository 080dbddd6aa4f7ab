// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_MAP_DISTRIBUTION_HPP
#define PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_MAP_DISTRIBUTION_HPP

#include <environment_lighting/lat_long.hpp>
#include <render/image.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace environment_lighting {

/// Directions with a density that is constant in each texel of a lat–long map.
///
///     p(ω) = v(texel of ω) / Σ v Ω,   Ω the texel's solid angle, ∫ sin θ dθ dφ over it
///
/// Units    1/sr.
/// Requires values that are not negative; where all are 0, p is uniform.
class map_distribution {
 public:
  explicit map_distribution(const render::image<float>& values)
      : on_(values.width, values.height), width_(static_cast<std::size_t>(values.width)) {
    const auto height = static_cast<std::size_t>(values.height);
    std::vector<double> row_sums(height);
    columns_upto_.resize(width_ * height);
    for (std::size_t row = 0; row < height; ++row) {
      const float* const of_row = values.pixels.data() + row * width_;
      row_sums[row] = on_.solid_angle(static_cast<int>(row)) * cumulate(of_row, &columns_upto_[row * width_]);
      total_ += row_sums[row];
    }
    if (!(total_ > 0)) {
      *this = map_distribution(render::image<float>(values.width, values.height, 1));
      return;
    }
    double sum = 0;
    for (const double of_row : row_sums) rows_upto_.push_back(static_cast<float>((sum += of_row) / total_));
  }

  /// Σ v Ω.
  double total() const { return total_; }

  /// Where two uniform numbers in [0, 1) are: the first chooses the row, the second the column.
  lat_long::place sample(float u1, float u2) const {
    lat_long::place at{};
    at.row = pick(rows_upto_.data(), rows_upto_.size(), u1, at.down);
    at.column = pick(columns_of(at.row), width_, u2, at.across);
    return at;
  }

  /// The numbers of which sample() makes this place.   Requires a texel that is not black.
  std::array<float, 2> invert(const lat_long::place& at) const {
    return {part(rows_upto_.data(), at.row, at.down), part(columns_of(at.row), at.column, at.across)};
  }

 private:
  /// Running sums of values as shares of all of them, which it returns.
  double cumulate(const float* values, float* upto) const {
    double all = 0;
    for (std::size_t i = 0; i < width_; ++i) all += static_cast<double>(values[i]);
    double sum = 0;
    for (std::size_t i = 0; i < width_; ++i) {
      sum += static_cast<double>(values[i]);
      upto[i] = static_cast<float>(all > 0 ? sum / all : 1);
    }
    return all;
  }

  const float* columns_of(int row) const { return columns_upto_.data() + static_cast<std::size_t>(row) * width_; }

  /// The i of upto[i−1] <= u < upto[i], and how far between them u is.
  static int pick(const float* upto, std::size_t n, float u, float& between) {
    const std::size_t i = std::min(n - 1, static_cast<std::size_t>(std::upper_bound(upto, upto + n, u) - upto));
    const float from = i == 0 ? 0 : upto[i - 1];
    between = std::min((u - from) / (upto[i] - from), 0.99999994f);
    return static_cast<int>(i);
  }
  static float part(const float* upto, int i, float between) {
    const float from = i == 0 ? 0 : upto[i - 1];
    return from + between * (upto[i] - from);
  }

  lat_long on_;
  std::size_t width_;
  double total_ = 0;
  std::vector<float> rows_upto_;
  std::vector<float> columns_upto_;  ///< of each row
};

}  // namespace environment_lighting

#endif  // PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_MAP_DISTRIBUTION_HPP
