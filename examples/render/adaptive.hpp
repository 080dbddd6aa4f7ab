// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_RENDER_ADAPTIVE_HPP
#define PHIMIS_EXAMPLES_RENDER_ADAPTIVE_HPP

#include <render/image.hpp>
#include <render/light_sample.hpp>
#include <render/parallel.hpp>
#include <render/random_stream.hpp>
#include <render/rgb.hpp>

#include <phimis/core/counts.hpp>
#include <phimis/core/estimator.hpp>
#include <phimis/core/fractions.hpp>
#include <phimis/core/observation.hpp>
#include <phimis/core/weight_heuristic.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <type_traits>
#include <vector>

namespace render {

/// Samples of a pixel between which its cell learns, and what one of them weighs in the estimate.
struct planned_batch {
  std::int64_t samples;
  double weight = 1;
  /// Of the pixels of a cell that draw this batch; the others draw its samples with their last one.
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
  /// Then each pixel draws these alone, by a rule of its own that starts from what the cell learnt.
  std::vector<planned_batch> own{};
};

/// An image and the fractions at which the last batch of each of its pixels was drawn.
template <int M>
struct learnt_image {
  image<rgb> picture;
  image<phimis::fractions<float, M>> fractions;
};

/// Whether a plan may let pixels go on alone: rule_of(part, start) makes such a rule.
template <class RuleOf, int M>
inline constexpr bool has_own_rules = std::is_invocable_v<RuleOf, int, phimis::fractions<float, M>>;

/// The pixels of one cell that see the same part, all batches of them.
///
///     F = Σ_b w_b Σ_k Σ_j w_k(x_kj) f(x_kj)/(α_k p_k(x_kj)) / Σ_b w_b n_b,   α = counts of b/n_b
///
/// The fractions of a pixel's batch depend on samples of other pixels and of its own earlier batches: each batch is
/// unbiased, and so is their sum with weights that look at no sample.
template <class Point, light_techniques<Point> Techniques, class Heuristic>
class cell_renderer {
  static constexpr int M = Techniques::count;
  using alphas = phimis::fractions<float, M>;

 public:
  cell_renderer(const image<Point>& points, const Techniques& all, const Heuristic& heuristic,
                std::span<const std::uint32_t> pixels, const random_stream& random, learnt_image<M>& into)
      : points_(points),
        all_(all),
        heuristic_(heuristic),
        pixels_(pixels),
        random_(random),
        into_(into),
        stride_(pixels.size() * 618 / 1000 + 1),
        of_(pixels.size()) {
    while (std::gcd(stride_, pixels.size()) != 1) ++stride_;
  }

  template <class RuleOf>
  void render(const RuleOf& rule_of, int part, const learning_plan& plan) {
    auto rule = rule_of(part);
    const auto last = [&plan](std::size_t b) { return b + 1 == plan.batches.size() && plan.own.empty(); };
    for (std::size_t b = 0; b < plan.batches.size(); ++b) {
      const planned_batch& batch = plan.batches[b];
      const auto share = static_cast<std::size_t>(std::ceil(batch.share * static_cast<double>(pixels_.size())));
      allotment n;
      in_turn([&](std::size_t i, std::uint32_t pixel) {
        if (i >= share) {
          of_[i].owed += batch.samples;
          return;
        }
        const bool update = i % static_cast<std::size_t>(plan.pixels_per_update) == 0;
        if (update && i > 0) rule.update();
        const std::int64_t samples = batch.samples + (last(b) ? of_[i].owed : 0);
        if (update || n.samples != samples) n = allotment(rule.fractions(), samples);
        draw(i, pixel, n, batch.weight, rule, i % batch.observed == 0);
      });
      rule.update();
    }
    if constexpr (has_own_rules<RuleOf, M>) {
      in_turn([&](std::size_t i, std::uint32_t pixel) {
        auto own = rule_of(part, rule.fractions());
        for (std::size_t b = 0; b < plan.own.size(); ++b) {
          const bool ends = b + 1 == plan.own.size();
          const std::int64_t samples = plan.own[b].samples + (ends ? of_[i].owed : 0);
          draw(i, pixel, allotment(own.fractions(), samples), plan.own[b].weight, own, !ends);
          if (!ends) own.update();
        }
      });
    }
  }

 private:
  struct progress {
    std::int64_t owed = 0;  // samples of batches that it did not draw
    std::uint32_t drawn = 0;
    float weight = 0;  // Σ_b w_b n_b so far
  };

  /// Counts as near to fractions as they can be, and the fractions that they are.
  struct allotment {
    allotment() = default;
    allotment(const alphas& wanted, std::int64_t all)
        : samples(all), n(phimis::split_largest_remainder(wanted, all)) {
      for (int k = 0; k < M; ++k) alpha[k] = static_cast<float>(n[k]) / static_cast<float>(all);
    }
    std::int64_t samples = 0;
    phimis::counts<M> n{};
    alphas alpha{};
  };

  /// Neighbours take turns that are far apart, so that what was learnt late leaves no pattern.
  template <class F>
  void in_turn(const F& f) const {
    for (std::size_t i = 0, at = 0; i < pixels_.size(); ++i, at = (at + stride_) % pixels_.size()) f(i, pixels_[at]);
  }

  template <class Rule>
  void draw(std::size_t turn, std::uint32_t pixel, const allotment& n, double weight, Rule& rule, bool observed) {
    progress& of = of_[turn];
    rgb sum{};
    for (int k = 0; k < M; ++k) {
      for (std::int64_t j = 0; j < n.n[k]; ++j) {
        const auto u = random_(pixel, of.drawn++);
        const light_sample<M> x = all_.draw(points_.pixels[pixel], k, u[0], u[1], u[2]);
        sum = sum + phimis::contribution(heuristic_, k, x.f, n.alpha, x.pdfs);
        if (observed) rule.observe({luminance(x.f), x.pdfs, phimis::mixture(n.alpha, x.pdfs), k});
      }
    }
    // The weighted mean of the batches so far.
    const auto samples = static_cast<float>(n.samples);
    of.weight += static_cast<float>(weight) * samples;
    rgb& mean = into_.picture.pixels[pixel];
    mean = mean + (sum - mean * samples) * (static_cast<float>(weight) / of.weight);
    into_.fractions.pixels[pixel] = n.alpha;
  }

  const image<Point>& points_;
  const Techniques& all_;
  const Heuristic& heuristic_;
  std::span<const std::uint32_t> pixels_;
  const random_stream& random_;
  learnt_image<M>& into_;
  std::size_t stride_;
  std::vector<progress> of_;  // by turn
};

/// The image of one run whose fractions are learnt by rule_of(part), one rule for each cell, and where the plan says so by
/// rule_of(part, start) for each pixel. `after_tile` is called after each tile, from any thread.
///
/// Requires in each batch a sample for each technique: with fewer, a technique that alone reaches a point has none.
template <class Point, light_techniques<Point> Techniques, class Heuristic, class RuleOf, class AfterTile>
learnt_image<Techniques::count> render_adaptively(const image<Point>& points, const Techniques& all,
                                                  const Heuristic& heuristic, const RuleOf& rule_of,
                                                  const learning_plan& plan, const random_stream& random, int threads,
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
          cell_renderer(points, all, heuristic, std::span<const std::uint32_t>(cell), random, result)
              .render(rule_of, part, plan);
        }
      }
    }
    after_tile();
  });
  return result;
}

}  // namespace render

#endif  // PHIMIS_EXAMPLES_RENDER_ADAPTIVE_HPP
