// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_DIRECT_LIGHTING_METHODS_HPP
#define PHIMIS_EXAMPLES_DIRECT_LIGHTING_METHODS_HPP

#include <direct_lighting/adaptive.hpp>
#include <direct_lighting/method_name.hpp>
#include <direct_lighting/render.hpp>

#include <phimis/core/divergence.hpp>
#include <phimis/core/exact_minimiser.hpp>
#include <phimis/core/linear_heuristic.hpp>
#include <phimis/core/newton_raphson.hpp>
#include <phimis/core/streaming_newton.hpp>
#include <phimis/core/table.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace direct_lighting {

/// A picture, and where fractions are learnt those of each technique in each pixel's last batch.
struct rendering {
  render::image<render::rgb> picture;
  std::vector<render::image<float>> fractions;
};

/// Renders one run.
using method = std::function<rendering(const render::random_stream& random, int threads,
                                       const std::function<void()>& after_tile)>;

/// What every method renders; both must outlive it.
struct view {
  const scene& plates;
  const render::image<shading_point>& points;
};

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

/// Options with the same floor for all techniques.
template <int M>
phimis::rule_options<float, M> options_of(float floor, float prior) {
  phimis::rule_options<float, M> options;
  for (int k = 0; k < M; ++k) options.floors[k] = floor;
  options.prior = prior;
  return options;
}

/// The rule of a plate. V[F] takes the same settings, and has its own strengths (docs/embedding.md).
///
/// A lobe so narrow that a highlight is smaller than a pixel is not learnt from neighbours, who do not see it: the BRDF,
/// which alone finds it, keeps more.
template <int M, class Divergence = phimis::chi_squared>
auto recommended_rule(float exponent, int width) {
  auto options = options_of<M>(M == 2 ? 0.2f : 0.02f, 30);
  const bool narrow = 2 * exponent > static_cast<float>(width) * static_cast<float>(width);
  if (narrow) options.floors[M - 1] = M == 2 ? 0.3f : 0.1f;
  return phimis::streaming_newton<Divergence, float, M>({}, options, 0.6f);
}

template <int M, class LightSampling>
method fixed_method(const view& of, const phimis::counts<M>& n) {
  return [of, n, all = techniques<M, LightSampling>(of.plates)](const auto& random, int threads, const auto& after) {
    return rendering{render_image(of.points, all, n, random, threads, after), {}};
  };
}

/// Learns by rule_of(plate).
template <int M, class LightSampling, class RuleOf>
method learning_method_of(const view& of, const RuleOf& rule_of, const learning_plan& plan) {
  return [of, rule_of, plan, all = techniques<M, LightSampling>(of.plates)](const auto& random, int threads,
                                                                            const auto& after) {
    auto learnt = render_adaptively(of.points, all, rule_of, plan, random, threads, after);
    rendering result{std::move(learnt.picture), {}};
    for (int k = 0; k < M; ++k) {
      result.fractions.push_back(render::map(learnt.fractions, [k](const auto& alpha) { return alpha[k]; }));
    }
    return result;
  };
}

/// Learns by copies of a rule.
template <int M, class LightSampling, class Rule>
method learning_method(const view& of, const Rule& rule, const learning_plan& plan) {
  return learning_method_of<M, LightSampling>(
      of, [rule](int) { return rule; }, plan);
}

/// What the library recommends, but for the divergence.
template <int M, class LightSampling, class Divergence>
method recommended_method(const view& of, std::int64_t samples) {
  const auto rule_of = [of](int plate) {
    return recommended_rule<M, Divergence>(of.plates.exponent(plate), of.points.width);
  };
  return learning_method_of<M, LightSampling>(of, rule_of, recommended_plan<M>(samples, of.points.width));
}

template <int M>
auto make_linear_rule() {
  return phimis::linear_heuristic<float, M, phimis::negative_fractions::drop_most_negative>(options_of<M>(0.01f, 0));
}

/// Tsallis-γ on all samples of a pixel.
template <int Capacity, class LightSampling>
method tsallis_method(const view& of, double gamma, std::int64_t samples) {
  using rule = phimis::exact_minimiser<phimis::tsallis, phimis::fixed_table<float, 2, Capacity>>;
  return learning_method<2, LightSampling>(
      of, rule(phimis::tsallis{gamma}, options_of<2>(0.02f, 2), phimis::control_variate::off),  // pdfs are defective
      papers_plan(samples, 2, 5));
}

template <class LightSampling>
method papers_method(const view& of, const method_name& name, std::int64_t samples) {
  if (name.family == "newton") {
    using rule = phimis::newton_raphson<phimis::tsallis, float>;
    const std::int64_t iterations = std::max<std::int64_t>(1, samples / 10);  // T: 5 of 10 samples, L: 10 of 10
    return learning_method<2, LightSampling>(
        of, rule(phimis::tsallis{name.gamma}, phimis::newton_form::paper, options_of<2>(0.01f, 0)),
        papers_plan(samples, 2, iterations));
  }
  if (name.family == "linear") {
    return learning_method<2, LightSampling>(of, make_linear_rule<2>(), papers_plan(samples, 2, 10));
  }
  if (samples <= 64) return tsallis_method<64, LightSampling>(of, name.gamma, samples);
  return tsallis_method<1024, LightSampling>(of, name.gamma, samples);
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
  if (name.family == "equal") return fixed_method<M, LightSampling>(of, equal_counts<M>(samples));
  if (name.family == "brdf" || name.family == "light") {
    phimis::fractions<double, M> alpha{};
    for (int k = 0; k < M; ++k) {
      if (name.family == "brdf") alpha[k] = k == M - 1 ? 1 : 0;
      if (name.family == "light") alpha[k] = k < M - 1 ? 1.0 / (M - 1) : 0;
    }
    return fixed_method<M, LightSampling>(of, phimis::split_largest_remainder(alpha, samples));
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
