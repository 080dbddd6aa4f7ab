// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_DIRECT_LIGHTING_METHODS_HPP
#define PHIMIS_EXAMPLES_DIRECT_LIGHTING_METHODS_HPP

#include <direct_lighting/method_name.hpp>
#include <direct_lighting/scene.hpp>
#include <direct_lighting/techniques.hpp>
#include <render/method.hpp>

#include <phimis/core/newton_raphson.hpp>
#include <phimis/core/streaming_newton.hpp>

#include <algorithm>
#include <cstdint>
#include <string>

namespace direct_lighting {

using render::learning_plan, render::method;

/// What every method renders; both must outlive it.
struct view {
  const scene& plates;
  const render::image<shading_point>& points;
};

/// What the library recommends: cells that learn from a pilot of a quarter of their pixels, and go on learning.
///
/// Measured over exponents, plates, radii and 20 to 1000 samples (--never-worse): with two techniques there is little to
/// win, the best fractions of every pixel have .83 of the error of equal counts, and much to lose: floors of .2. With five
/// there is much to win, .42: floors are low, the pilot, drawn at equal counts, weighs half, and updates are many, since
/// they have far to go. A cell must be small against what is seen, and two techniques are learnt worse in small cells.
template <int M>
learning_plan recommended_plan(std::int64_t samples, int width) {
  learning_plan plan{
      .cell = M > 2 && width < 128 ? 8 : 16, .pixels_per_update = M > 2 ? 4 : 16, .batches = {{samples}}};
  const std::int64_t pilot = std::max<std::int64_t>(M, samples / 10);
  if (samples >= 2 * M)
    plan.batches = {{pilot, M == 2 ? 0.8 : 0.5, 0.25}, {.samples = samples - pilot, .observed = 3}};
  return plan;
}

/// The rule of a plate. V[F] takes the same settings, and has its own strengths (docs/embedding.md).
///
/// A lobe so narrow that a highlight is smaller than a pixel is not learnt from neighbours, who do not see it: the BRDF,
/// which alone finds it, keeps more.
template <int M, class Divergence = phimis::chi_squared>
auto recommended_rule(float exponent, int width) {
  auto options = render::options_of<M>(M == 2 ? 0.2f : 0.02f, 30);
  const bool narrow = 2 * exponent > static_cast<float>(width) * static_cast<float>(width);
  if (narrow) options.floors[M - 1] = M == 2 ? 0.3f : 0.1f;
  return phimis::streaming_newton<Divergence, float, M>({}, options, 0.6f);
}

/// What the library recommends, but for the divergence.
template <int M, class LightSampling, class Divergence>
method recommended_method(const view& of, std::int64_t samples) {
  const auto rule_of = [of](int plate) {
    return recommended_rule<M, Divergence>(of.plates.exponent(plate), of.points.width);
  };
  return render::learning_method_of(of.points, techniques<M, LightSampling>(of.plates), rule_of,
                                    recommended_plan<M>(samples, of.points.width));
}

template <class LightSampling>
method papers_method(const view& of, const method_name& name, std::int64_t samples) {
  const techniques<2, LightSampling> all(of.plates);
  if (name.family == "newton") {
    using rule = phimis::newton_raphson<phimis::tsallis, float>;
    const std::int64_t iterations = std::max<std::int64_t>(1, samples / 10);  // T: 5 of 10 samples, L: 10 of 10
    return render::learning_method(
        of.points, all,
        rule(phimis::tsallis{name.gamma}, phimis::newton_form::paper, render::options_of<2>(0.01f, 0)),
        render::papers_plan(samples, 2, iterations));
  }
  if (name.family == "linear") {
    return render::learning_method(of.points, all, render::make_linear_rule<2>(), render::papers_plan(samples, 2, 10));
  }
  return render::tsallis_method(of.points, all, name.gamma, render::papers_plan(samples, 2, 5), samples);
}

/// The method of that name with M techniques.
///
/// Requires check(configuration).
template <int M, class LightSampling>
method make_method(const view& of, const std::string& text, std::int64_t samples) {
  const method_name name = parse_method(text);
  if (name.family == "default") return recommended_method<M, LightSampling, phimis::chi_squared>(of, samples);
  if (name.family == "variance") {
    return recommended_method<M, LightSampling, phimis::multi_sample_variance>(of, samples);
  }
  const techniques<M, LightSampling> all(of.plates);
  if (name.family == "equal") return render::fixed_method(of.points, all, render::equal_counts<M>(samples));
  if (name.family == "brdf" || name.family == "light") {
    phimis::fractions<double, M> alpha{};
    for (int k = 0; k < M; ++k) {
      if (name.family == "brdf") alpha[k] = k == M - 1 ? 1 : 0;
      if (name.family == "light") alpha[k] = k < M - 1 ? 1.0 / (M - 1) : 0;
    }
    return render::fixed_method(of.points, all, phimis::split_largest_remainder(alpha, samples));
  }
  if constexpr (M == 2) {
    return papers_method<LightSampling>(of, name, samples);
  } else {
    return {};
  }
}

/// Errors std::invalid_argument where nothing can render this.
inline method make_method(const view& of, const configuration& what) {
  check(what);
  const auto& [sampler, techniques, name, samples] = what;
  if (sampler == "area") {
    return techniques == 2 ? make_method<2, area_sampling>(of, name, samples)
                           : make_method<5, area_sampling>(of, name, samples);
  }
  return techniques == 2 ? make_method<2, cone_sampling>(of, name, samples)
                         : make_method<5, cone_sampling>(of, name, samples);
}

}  // namespace direct_lighting

#endif  // PHIMIS_EXAMPLES_DIRECT_LIGHTING_METHODS_HPP
