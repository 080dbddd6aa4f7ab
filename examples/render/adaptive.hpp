// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_RENDER_ADAPTIVE_HPP
#define PHIMIS_EXAMPLES_RENDER_ADAPTIVE_HPP

#include <render/image.hpp>
#include <render/light_sample.hpp>
#include <render/parallel.hpp>
#include <render/random_stream.hpp>
#include <render/rgb.hpp>

#include <phimis/core/counts.hpp>
#include <phimis/core/fractions.hpp>
#include <phimis/core/observation.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace render {

/// Samples of a pixel between which its cell learns, and what one of them weighs in the estimate.
struct planned_batch {
  std::int64_t samples;
  double weight = 1;
  /// Of the pixels of a cell that draw this batch; the others draw its samples with their next one.
  double share = 1;
  /// The rule observes every so manieth pixel of this batch: each costs time, and a cell has many.
  std::size_t observed = 1;
};

/// When and where fractions are learnt.
struct learning_plan {
  /// Pixels across a cell: those of one cell that see the same part share a rule. 1: every pixel learns alone.
  int cell = 16;
  /// Pixels between two updates of a cell; each batch of a cell ends with one.
  int pixels_per_update = 32;
  std::vector<planned_batch> batches;
};

/// An image and the fractions at which the last batch of each of its pixels was drawn.
template <int M>
struct learnt_image {
  image<rgb> picture;
  image<phimis::fractions<float, M>> fractions;
};

/// The pixels of one cell, all batches of them, with one rule.
///
///     F = Σ_b w_b Σ_k Σ_j f(x_kj)/p(α_b, x_kj) / Σ_b w_b n_b,   α_b = counts/n_b
///
/// The fractions of a pixel's batch depend on samples of other pixels and of its own earlier batches: each batch is
/// unbiased, and so is their sum with weights that look at no sample.
template <class Point, light_techniques<Point> Techniques, class Rule>
void render_cell(const image<Point>& points, const Techniques& all, std::span<const std::uint32_t> pixels, Rule& rule,
                 const learning_plan& plan, const random_stream& random, learnt_image<Techniques::count>& into) {
  constexpr int M = Techniques::count;
  // Neighbours take turns that are far apart, so that what was learnt late leaves no pattern.
  std::size_t stride = pixels.size() * 618 / 1000 + 1;
  while (std::gcd(stride, pixels.size()) != 1) ++stride;

  struct progress {
    std::int64_t owed = 0;  // samples of batches that it did not draw
    std::uint32_t drawn = 0;
    float weight = 0;  // Σ_b w_b n_b so far
  };
  std::vector<progress> of(pixels.size());  // by turn
  for (const planned_batch& batch : plan.batches) {
    const auto share = static_cast<std::size_t>(std::ceil(batch.share * static_cast<double>(pixels.size())));
    const auto weight = static_cast<float>(batch.weight);
    std::int64_t samples = 0;
    phimis::counts<M> n{};
    phimis::fractions<float, M> alpha{};
    for (std::size_t i = 0, at = 0; i < pixels.size(); ++i, at = (at + stride) % pixels.size()) {
      of[i].owed += batch.samples;
      if (i >= share) continue;
      const bool update = i % static_cast<std::size_t>(plan.pixels_per_update) == 0;
      if (update && i > 0) rule.update();
      if (update || of[i].owed != samples) {
        samples = of[i].owed;
        n = phimis::split_largest_remainder(rule.fractions(), samples);
        for (int k = 0; k < M; ++k) alpha[k] = static_cast<float>(n[k]) / static_cast<float>(samples);
      }
      const std::uint32_t pixel = pixels[at];
      const bool observed = i % batch.observed == 0;
      rgb sum{};
      for (int k = 0; k < M; ++k) {
        for (std::int64_t j = 0; j < n[k]; ++j) {
          const auto u = random(pixel, of[i].drawn++);
          const light_sample<M> x = all.draw(points.pixels[pixel], k, u[0], u[1], u[2]);
          const float q = phimis::mixture(alpha, x.pdfs);
          if (q > 0) sum = sum + x.f * (1 / q);
          if (observed) rule.observe({luminance(x.f), x.pdfs, q, k});
        }
      }
      // The weighted mean of the batches so far.
      of[i].weight += weight * static_cast<float>(samples);
      of[i].owed = 0;
      rgb& mean = into.picture.pixels[pixel];
      mean = mean + (sum - mean * static_cast<float>(samples)) * (weight / of[i].weight);
      into.fractions.pixels[pixel] = alpha;
    }
    rule.update();
  }
}

/// The image of one run whose fractions are learnt by rule_of(part), one rule for each cell. `after_tile` is called after
/// each tile, from any thread.
///
/// Requires in each batch a sample for each technique: with fewer, a technique that alone reaches a point has none.
template <class Point, light_techniques<Point> Techniques, class RuleOf, class AfterTile>
learnt_image<Techniques::count> render_adaptively(const image<Point>& points, const Techniques& all,
                                                  const RuleOf& rule_of, const learning_plan& plan,
                                                  const random_stream& random, int threads,
                                                  const AfterTile& after_tile) {
  learnt_image<Techniques::count> result{{points.width, points.height}, {points.width, points.height}};
  for_each_tile(points.width, points.height, threads, [&](const tile& t) {
    std::vector<std::uint32_t> cell;
    for (int y0 = t.y0; y0 < t.y1; y0 += plan.cell) {
      for (int x0 = t.x0; x0 < t.x1; x0 += plan.cell) {
        const tile of{x0, y0, std::min(x0 + plan.cell, t.x1), std::min(y0 + plan.cell, t.y1)};
        int parts = 0;
        for_each_pixel(of, [&](int x, int y) {
          parts = std::max(parts, points(x, y).part + 1);
          if (points(x, y).part == Point::no_part) result.picture(x, y) = points(x, y).emitted;
        });
        for (int part = 0; part < parts; ++part) {
          cell.clear();
          for_each_pixel(of, [&](int x, int y) {
            if (points(x, y).part == part) cell.push_back(static_cast<std::uint32_t>(y * points.width + x));
          });
          if (cell.empty()) continue;
          auto rule = rule_of(part);
          render_cell(points, all, std::span<const std::uint32_t>(cell), rule, plan, random, result);
        }
      }
    }
    after_tile();
  });
  return result;
}

}  // namespace render

#endif  // PHIMIS_EXAMPLES_RENDER_ADAPTIVE_HPP
