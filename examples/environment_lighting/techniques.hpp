// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_TECHNIQUES_HPP
#define PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_TECHNIQUES_HPP

#include <environment_lighting/scene.hpp>
#include <render/light_sample.hpp>

namespace environment_lighting {

/// The ways to sample the directions from which the map lights a point.
///
///     M = 2: 0 the map, 1 the BRDF times cosine
///     M = 3: 0 the brightest region of the map, 1 the rest of it, 2 the BRDF times cosine
///     f = L f_r cos θ,   p_k in 1/sr
///
/// BRDF sampling is defective: what is absorbed or goes below the horizon is lost. f = 0 where the map is hidden.
template <int M>
class techniques {
  static_assert(M == 2 || M == 3);

 public:
  static constexpr int count = M;
  static constexpr int brdf = M - 1;

  explicit techniques(const scene& of) : scene_(&of) {}

  render::light_sample<M> draw(const shading_point& from, int technique, float u0, float u1, float u2) const {
    const environment_map& light = scene_->light();
    lat_long::place at;
    vector direction;
    if (technique == brdf) {
      if (!from.surface.sample(u0, u1, u2, direction)) return {};
      at = light.directions().find(direction);
    } else {
      const map_distribution& of = M == 2 ? light.whole() : technique == 0 ? light.bright() : light.rest();
      at = of.sample(u1, u2);
      direction = light.directions().direction(at);
    }
    const render::rgb radiance = light.radiance(at);
    render::light_sample<M> sample;
    if constexpr (M == 2) {
      sample.pdfs[0] = light.whole_pdf(radiance);
    } else {
      sample.pdfs[0] = light.bright_pdf(radiance);
      sample.pdfs[1] = light.rest_pdf(radiance);
    }
    const render::max_phong::reflection reflected = from.surface(direction);
    sample.pdfs[brdf] = reflected.pdf;
    if (reflected.brdf_cosine > 0 && luminance(radiance) > 0 && scene_->sees_light(from, direction)) {
      sample.f = radiance * from.albedo * reflected.brdf_cosine;
    }
    return sample;
  }

 private:
  const scene* scene_;
};

}  // namespace environment_lighting

#endif  // PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_TECHNIQUES_HPP
