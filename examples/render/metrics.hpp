// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_RENDER_METRICS_HPP
#define PHIMIS_EXAMPLES_RENDER_METRICS_HPP

#include <render/image.hpp>
#include <render/rgb.hpp>

#include <phimis/core/config.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

namespace render {

/// How far an image I is from a reference R.
///
///     rmse             √ Σ|I−R|²                       over pixels and channels, not divided: the papers' RMSE
///     rmse_per_channel √ (Σ|I−R|² / (3 pixels))
///     relmse           mean (I−R)²/(R² + 0.01)         over pixels and channels
///     relmse_trimmed   the same without the 0.1 % of the pixels where it is largest
struct image_error {
  double rmse = 0;
  double rmse_per_channel = 0;
  double relmse = 0;
  double relmse_trimmed = 0;

  image_error& operator+=(const image_error& other) {
    rmse += other.rmse, rmse_per_channel += other.rmse_per_channel;
    relmse += other.relmse, relmse_trimmed += other.relmse_trimmed;
    return *this;
  }
  friend image_error operator/(image_error sum, double n) {
    return {sum.rmse / n, sum.rmse_per_channel / n, sum.relmse / n, sum.relmse_trimmed / n};
  }
};

/// (I−R)², mean over the channels, of each pixel.
inline image<float> squared_error_map(const image<rgb>& picture, const image<rgb>& reference) {
  PHIMIS_EXPECTS(picture.width == reference.width && picture.height == reference.height);
  image<float> errors(picture.width, picture.height);
  for (std::size_t i = 0; i < errors.pixels.size(); ++i) {
    const rgb d = picture.pixels[i] - reference.pixels[i];
    errors.pixels[i] = mean(d * d);
  }
  return errors;
}

/// (I−R)²/(R² + 0.01), mean over the channels, of each pixel.
inline image<float> relative_error_map(const image<rgb>& picture, const image<rgb>& reference) {
  PHIMIS_EXPECTS(picture.width == reference.width && picture.height == reference.height);
  image<float> errors(picture.width, picture.height);
  for (std::size_t i = 0; i < errors.pixels.size(); ++i) {
    const rgb r = reference.pixels[i];
    const rgb d = picture.pixels[i] - r;
    const auto relative = [](float off, float of) { return off * off / (of * of + 0.01f); };
    errors.pixels[i] = (relative(d.r, r.r) + relative(d.g, r.g) + relative(d.b, r.b)) / 3;
  }
  return errors;
}

inline image_error compare(const image<rgb>& picture, const image<rgb>& reference) {
  std::vector<float> relative = relative_error_map(picture, reference).pixels;
  const auto pixels = static_cast<double>(relative.size());
  double squares = 0;
  for (std::size_t i = 0; i < relative.size(); ++i) {
    const rgb d = picture.pixels[i] - reference.pixels[i];
    squares += double{d.r} * d.r + double{d.g} * d.g + double{d.b} * d.b;
  }
  const std::size_t trimmed = relative.size() / 1000;
  std::nth_element(relative.begin(), relative.begin() + static_cast<std::ptrdiff_t>(trimmed), relative.end(),
                   std::greater<>());
  double all = 0;
  double kept = 0;
  for (std::size_t i = 0; i < relative.size(); ++i) {
    all += relative[i];
    if (i >= trimmed) kept += relative[i];
  }
  return {std::sqrt(squares), std::sqrt(squares / (3 * pixels)), all / pixels,
          kept / (pixels - static_cast<double>(trimmed))};
}

/// How far the sum of an image is from that of its reference, in standard errors: of independent pixels without bias.
///
///     z = Σ d / √ Σ d²,   d = I−R, summed over the channels
inline double bias_in_standard_errors(const image<rgb>& picture, const image<rgb>& reference) {
  PHIMIS_EXPECTS(picture.width == reference.width && picture.height == reference.height);
  double sum = 0;
  double squares = 0;
  for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
    const double d = 3 * double{mean(picture.pixels[i] - reference.pixels[i])};
    sum += d;
    squares += d * d;
  }
  return squares > 0 ? sum / std::sqrt(squares) : 0;
}

}  // namespace render

#endif  // PHIMIS_EXAMPLES_RENDER_METRICS_HPP
