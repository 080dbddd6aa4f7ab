// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_METHODS_HPP
#define PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_METHODS_HPP

#include <environment_lighting/scene.hpp>
#include <environment_lighting/techniques.hpp>
#include <render/method.hpp>
#include <render/method_name.hpp>

#include <phimis/core/divergence.hpp>
#include <phimis/core/second_order.hpp>
#include <phimis/core/sigma_proportional.hpp>
#include <phimis/core/streaming_newton.hpp>
#include <phimis/core/weight_heuristic.hpp>

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace environment_lighting {

using render::learning_plan;

/// What every method renders; both must outlive it.
struct view {
  const scene& world;
  const render::image<shading_point>& points;
};

/// V's five, in its order, and others. "equal3" and "default" have three techniques.
inline std::vector<std::string> all_methods() {
  return {"map", "brdf", "equal", "lu", "eq31", "tsallis:1", "linear", "equal3", "default"};
}
inline constexpr const char* methods_of_v[] = {"map", "brdf", "equal", "lu", "eq31"};

/// Errors std::invalid_argument where no method has that name.
inline render::method_name parse_method(const std::string& text) {
  return render::parse_method(text, {"map", "brdf", "equal", "lu", "eq31", "linear", "equal3", "default"}, {"tsallis"});
}

inline bool learns(const std::string& method) {
  return method != "map" && method != "brdf" && method != "equal" && method != "equal3";
}

/// Below, a stage of three techniques would leave no choice; nor would the fewest samples of a pixel.
inline constexpr std::int64_t fewest_in_a_stage = 10;
inline constexpr std::int64_t fewest_samples = 30;

/// V Sec. 7: every pixel alone, a pilot of .2 N at equal counts, then 8 stages of .1 N, all of the same weight.
inline learning_plan plan_of_v(std::int64_t samples) {
  learning_plan plan{.cell = 1, .batches = {{samples - samples / 10 * 8}}};
  plan.batches.insert(plan.batches.end(), 8, {samples / 10});
  return plan;
}

/// A floor that leaves each technique a sample in every stage.
inline float floor_of(float wanted, std::int64_t stage) { return std::max(wanted, 1 / static_cast<float>(stage)); }

/// What the library recommends for many samples per pixel: cells of pixels learn where to start, each pixel goes on alone.
///
/// Shadows are as fine as pixels, and a cell is right for none of them; a pixel alone starts from nothing, and what it has
/// not met yet may be a highlight. So it starts at three parts of its cell's fractions and one of equal counts of map and
/// BRDF, which count as 30 samples, and learns in stages of a tenth and of a fifth of its samples. With fewer than 100 it
/// would learn little alone, and its cell goes on for it.
inline learning_plan recommended_plan(std::int64_t samples) {
  const std::int64_t tenth = std::max(fewest_in_a_stage, samples / 10), fifth = samples / 5;
  learning_plan plan{.cell = 16, .pixels_per_update = 16, .batches = {{tenth, 0.5, 0.25}}};
  if (samples < 100) {
    plan.batches.push_back({samples - tenth});
  } else {
    plan.own = {{tenth}, {tenth}, {fifth}, {fifth}, {samples - 3 * tenth - 2 * fifth}};
  }
  return plan;
}

struct recommended_rules {
  static constexpr int M = 3;
  using rule = phimis::streaming_newton<phimis::multi_sample_variance, float, M>;

  rule operator()(int) const { return rule({}, render::options_of<M>(floor, 30), 0.6f); }
  rule operator()(int, const phimis::fractions<float, M>& cell) const {
    auto options = render::options_of<M>(floor, 30);
    const phimis::fractions<float, M> map_and_brdf{0.25f, 0.25f, 0.5f};
    for (int k = 0; k < M; ++k) options.start[k] = 0.75f * cell[k] + 0.25f * map_and_brdf[k];
    return rule({}, options);
  }

  float floor;
};

/// Errors std::invalid_argument where nothing can render this, in one line.
inline void check(const std::string& method, std::int64_t samples) {
  const render::method_name name = parse_method(method);
  if (samples < fewest_samples) {
    throw std::invalid_argument("--samples " + std::to_string(samples) + ": at least " +
                                std::to_string(fewest_samples));
  }
  if (name.family == "tsallis" && samples > render::most_samples_of_tsallis) {
    throw std::invalid_argument("--method tsallis keeps every sample of a pixel: at most " +
                                std::to_string(render::most_samples_of_tsallis) + " --samples");
  }
}

/// Requires check(text, samples).
inline render::method make_method(const view& of, const std::string& text, std::int64_t samples) {
  const render::method_name name = parse_method(text);
  const techniques<2> two(of.world);
  const techniques<3> three(of.world);
  const std::int64_t stage = samples / 10;
  if (name.family == "map") return render::fixed_method(of.points, two, {samples, 0});
  if (name.family == "brdf") return render::fixed_method(of.points, two, {0, samples});
  if (name.family == "equal") return render::fixed_method(of.points, two, render::equal_counts<2>(samples));
  if (name.family == "equal3") return render::fixed_method(of.points, three, render::equal_counts<3>(samples));
  const auto options = render::options_of<2>(floor_of(0.02f, stage), 0);
  if (name.family == "lu") {
    return render::learning_method(of.points, two, phimis::second_order<float, 2>(options), plan_of_v(samples));
  }
  if (name.family == "eq31") {
    return render::learning_method(of.points, two, phimis::sigma_proportional<float, 2>(options), plan_of_v(samples),
                                   phimis::count_independent<>{});
  }
  if (name.family == "linear") {
    return render::learning_method(of.points, two, render::make_linear_rule<2>(), plan_of_v(samples));
  }
  if (name.family == "tsallis") {
    return render::tsallis_method(of.points, two, name.gamma, plan_of_v(samples), samples);
  }
  return render::learning_method_of(of.points, three, recommended_rules{floor_of(0.05f, std::max(fewest_in_a_stage, stage))},
                                    recommended_plan(samples));
}

/// Of the methods, as configurations of one case.
inline std::vector<render::configuration> configurations(const std::string& of_case,
                                                         const std::vector<std::string>& methods,
                                                         std::int64_t samples) {
  std::vector<render::configuration> wanted;
  for (const std::string& name : methods) {
    wanted.push_back({of_case, name == "default" || name == "equal3" ? 3 : 2, name, samples});
  }
  return wanted;
}

}  // namespace environment_lighting

#endif  // PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_METHODS_HPP
