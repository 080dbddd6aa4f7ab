// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_RENDER_LIGHT_SAMPLE_HPP
#define PHIMIS_EXAMPLES_RENDER_LIGHT_SAMPLE_HPP

#include <render/rgb.hpp>

#include <phimis/core/fractions.hpp>

#include <concepts>

namespace render {

/// One sample x of the light that a point reflects: f(x), and pdfs[k] = p_k(x) for each technique, in one measure.
///
/// A lost sample, which found nothing, has f = 0 and no pdf.
template <int M>
struct light_sample {
  rgb f{};
  phimis::per_technique<float, M> pdfs{};
};

/// What the pixels of an image see. A scene's own points derive from it.
struct seen_point {
  static constexpr int no_part = -1;

  int part = no_part;  ///< of the scene, 0, 1, …: what is alike in its reflection is one part
  rgb emitted{};       ///< where there is no part
};

/// Ways to sample the light at such a point: draw() makes one sample of the k-th of `count` from uniform numbers in [0, 1).
template <class T, class Point>
concept light_techniques = requires(const T all, const Point& from, int k, float u) {
  { all.draw(from, k, u, u, u) } -> std::same_as<light_sample<T::count>>;
};

}  // namespace render

#endif  // PHIMIS_EXAMPLES_RENDER_LIGHT_SAMPLE_HPP
