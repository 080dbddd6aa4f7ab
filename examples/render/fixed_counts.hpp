// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_RENDER_FIXED_COUNTS_HPP
#define PHIMIS_EXAMPLES_RENDER_FIXED_COUNTS_HPP

#include <render/image.hpp>
#include <render/light_sample.hpp>
#include <render/parallel.hpp>
#include <render/random_stream.hpp>
#include <render/rgb.hpp>

#include <phimis/core/counts.hpp>
#include <phimis/core/estimator.hpp>
#include <phimis/core/weight_heuristic.hpp>

#include <cstdint>

namespace render {

/// One pixel by multi-sample MIS with the same counts everywhere: n_k samples of technique k, balance heuristic.
///
///     F = (1/N) Σ_k Σ_j f(x_kj) / Σ_i α_i p_i(x_kj),   α_i = n_i/N
///
/// Sums of 256 are added in double: a reference of many samples is as exact as float.
template <class Point, light_techniques<Point> Techniques>
rgb render_pixel(const Point& from, const Techniques& all, const phimis::counts<Techniques::count>& n,
                 const random_stream& random, std::uint32_t pixel) {
  constexpr int M = Techniques::count;
  if (from.part == Point::no_part) return from.emitted;
  std::int64_t total = 0;
  for (const std::int64_t count : n) total += count;
  phimis::fractions<float, M> alpha{};
  for (int k = 0; k < M; ++k) alpha[k] = static_cast<float>(n[k]) / static_cast<float>(total);

  double sum[3] = {};
  std::uint32_t index = 0;
  for (int k = 0; k < M; ++k) {
    for (std::int64_t j = 0; j < n[k];) {
      rgb part{};
      for (int i = 0; i < 256 && j < n[k]; ++i, ++j) {
        const auto u = random(pixel, index++);
        const light_sample<M> sample = all.draw(from, k, u[0], u[1], u[2]);
        part = part + phimis::contribution(phimis::balance{}, k, sample.f, alpha, sample.pdfs);
      }
      sum[0] += part.r, sum[1] += part.g, sum[2] += part.b;
    }
  }
  const double scale = 1 / static_cast<double>(total);
  return {static_cast<float>(sum[0] * scale), static_cast<float>(sum[1] * scale), static_cast<float>(sum[2] * scale)};
}

/// The image of one run. `after_tile` is called after each tile, from any thread.
template <class Point, light_techniques<Point> Techniques, class AfterTile>
image<rgb> render_image(const image<Point>& points, const Techniques& all, const phimis::counts<Techniques::count>& n,
                        const random_stream& random, int threads, const AfterTile& after_tile) {
  image<rgb> picture(points.width, points.height);
  for_each_tile(points.width, points.height, threads, [&](const tile& t) {
    for_each_pixel(t, [&](int x, int y) {
      const auto pixel = static_cast<std::uint32_t>(y * points.width + x);
      picture(x, y) = render_pixel(points(x, y), all, n, random, pixel);
    });
    after_tile();
  });
  return picture;
}

/// Equal counts; where the number of techniques does not divide the samples, the first ones get one more.
template <int M>
phimis::counts<M> equal_counts(std::int64_t samples) {
  return phimis::split_largest_remainder(phimis::equal_fractions<double, M>(), samples);
}

}  // namespace render

#endif  // PHIMIS_EXAMPLES_RENDER_FIXED_COUNTS_HPP
