// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_RENDER_METHOD_HPP
#define PHIMIS_EXAMPLES_RENDER_METHOD_HPP

#include <render/adaptive.hpp>
#include <render/fixed_counts.hpp>

#include <phimis/core/divergence.hpp>
#include <phimis/core/exact_minimiser.hpp>
#include <phimis/core/linear_heuristic.hpp>
#include <phimis/core/rule.hpp>
#include <phimis/core/table.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

// Ways to render any scene. All keep references to the points, and copies of the techniques.

namespace render {

/// What is rendered, and how.
struct configuration {
  std::string setting;  ///< of the scene
  int techniques;
  std::string method;
  std::int64_t samples_per_pixel;
};

/// A picture, and where fractions are learnt those of each technique in each pixel's last batch.
struct rendering {
  image<rgb> picture;
  std::vector<image<float>> fractions;
};

/// Renders one run.
using method =
    std::function<rendering(const random_stream& random, int threads, const std::function<void()>& after_tile)>;

template <class Point, light_techniques<Point> Techniques>
method fixed_method(const image<Point>& points, const Techniques& all, const phimis::counts<Techniques::count>& n) {
  return [&points, all, n](const auto& random, int threads, const auto& after) {
    return rendering{render_image(points, all, n, random, threads, after), {}};
  };
}

/// Learns by rule_of(part), and by rule_of(part, start) where the plan says so.
template <class Point, light_techniques<Point> Techniques, class RuleOf, class Heuristic = phimis::balance>
method learning_method_of(const image<Point>& points, const Techniques& all, const RuleOf& rule_of,
                          const learning_plan& plan, const Heuristic& heuristic = {}) {
  return [&points, all, rule_of, plan, heuristic](const auto& random, int threads, const auto& after) {
    auto learnt = render_adaptively(points, all, heuristic, rule_of, plan, random, threads, after);
    rendering result{std::move(learnt.picture), {}};
    for (int k = 0; k < Techniques::count; ++k) {
      result.fractions.push_back(map(learnt.fractions, [k](const auto& alpha) { return alpha[k]; }));
    }
    return result;
  };
}

/// Learns by copies of a rule.
template <class Point, light_techniques<Point> Techniques, class Rule, class Heuristic = phimis::balance>
method learning_method(const image<Point>& points, const Techniques& all, const Rule& rule, const learning_plan& plan,
                       const Heuristic& heuristic = {}) {
  return learning_method_of(points, all, [rule](int) { return rule; }, plan, heuristic);
}

/// The papers' protocol: every pixel alone, iterations of the same size and weight, the first one of equal counts.
///
/// Fewer iterations where they would have no sample for each technique.
inline learning_plan papers_plan(std::int64_t samples, int techniques, std::int64_t iterations) {
  iterations = std::min(iterations, samples / techniques);
  learning_plan plan;
  plan.cell = 1;
  plan.batches.assign(static_cast<std::size_t>(iterations), {samples / iterations});
  plan.batches.back().samples += samples % iterations;
  return plan;
}

/// Options with the same floor for all techniques.
template <int M>
phimis::rule_options<float, M> options_of(float floor, float prior) {
  phimis::rule_options<float, M> options;
  for (int k = 0; k < M; ++k) options.floors[k] = floor;
  options.prior = prior;
  return options;
}

template <int M>
auto make_linear_rule() {
  return phimis::linear_heuristic<float, M, phimis::negative_fractions::drop_most_negative>(options_of<M>(0.01f, 0));
}

namespace detail {

template <int Capacity, class Point, light_techniques<Point> Techniques>
method tsallis_method(const image<Point>& points, const Techniques& all, double gamma, const learning_plan& plan) {
  using rule = phimis::exact_minimiser<phimis::tsallis, phimis::fixed_table<float, 2, Capacity>>;
  return learning_method(
      points, all,
      rule(phimis::tsallis{gamma}, options_of<2>(0.02f, 2), phimis::control_variate::off),  // pdfs are defective
      plan);
}

}  // namespace detail

/// The most samples of a pixel that tsallis_method keeps.
inline constexpr std::int64_t most_samples_of_tsallis = 2048;

/// Tsallis-γ on all samples of a pixel, two techniques.   Requires at most `most_samples_of_tsallis`.
template <class Point, light_techniques<Point> Techniques>
method tsallis_method(const image<Point>& points, const Techniques& all, double gamma, const learning_plan& plan,
                      std::int64_t samples) {
  if (samples <= 64) return detail::tsallis_method<64>(points, all, gamma, plan);
  return detail::tsallis_method<most_samples_of_tsallis>(points, all, gamma, plan);
}

}  // namespace render

#endif  // PHIMIS_EXAMPLES_RENDER_METHOD_HPP
