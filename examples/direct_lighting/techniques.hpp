// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_DIRECT_LIGHTING_TECHNIQUES_HPP
#define PHIMIS_EXAMPLES_DIRECT_LIGHTING_TECHNIQUES_HPP

#include <direct_lighting/light_sampling.hpp>
#include <direct_lighting/scene.hpp>
#include <render/light_sample.hpp>
#include <render/max_phong.hpp>
#include <render/rgb.hpp>

#include <phimis/core/fractions.hpp>

#include <array>

namespace direct_lighting {

/// The ways to sample the lights' surfaces as seen from a point of a plate.
///
///     M = 2: 0 a light in proportion to its power, then a point of it; 1 the BRDF
///     M = 5: k < 4 a point of light k; 4 the BRDF
///
///     f = L f_r cos θ dω/dx,   pdfs[k] = p_k(x)        dx: solid angle for cone_sampling, area for area_sampling
///
/// A point of light k has pdfs for the technique of that light and for the BRDF. Both are defective: absorbed samples, and
/// those past all lights, are lost. A point that is hidden, faces away or is below the horizon has f = 0 and the pdf of
/// light sampling alone: no ray of the BRDF ends there.
template <int M, class LightSampling>
class techniques {
  static_assert(M == 2 || M == light_count + 1);

 public:
  static constexpr int count = M;
  static constexpr int brdf = M - 1;

  explicit techniques(const scene& of) {
    float total = 0;
    for (const light& l : of.lights) total += l.power;
    float sum = 0;
    for (std::size_t k = 0; k < light_count; ++k) {
      radiance_[k] = of.lights[k].radiance;
      chance_[k] = M == 2 ? of.lights[k].power / total : 1;
      sum += of.lights[k].power / total;
      upto_[k] = sum;
    }
  }

  /// One sample of a technique from numbers that are uniform in [0, 1).   Requires a point on a plate.
  render::light_sample<M> draw(const shading_point& from, int technique, float u0, float u1, float u2) const {
    if (technique == brdf) return draw_brdf(from, u0, u1, u2);
    const int k = M == 2 ? pick(u0) : technique;
    const light_point x = LightSampling::sample(from.lights[at(k)], u1, u2);
    const bool lit =
        x.solid_angle > 0 && from.surface.normal().dot(x.direction) > 0 && scene::visible(from, k, x.direction);
    return seen(from, k, x, lit);
  }

 private:
  static std::size_t at(int k) { return static_cast<std::size_t>(k); }

  render::light_sample<M> draw_brdf(const shading_point& from, float u0, float u1, float u2) const {
    vector direction;
    if (!from.surface.sample(u0, u1, u2, direction)) return {};
    for (int k = 0; k < light_count; ++k) {
      if (!hits(from.lights[at(k)], direction) || !scene::visible(from, k, direction)) continue;
      return seen(from, k, LightSampling::hit(from.lights[at(k)], direction), true);
    }
    return {};
  }

  render::light_sample<M> seen(const shading_point& from, int k, const light_point& x, bool lit) const {
    render::light_sample<M> sample;
    sample.pdfs[M == 2 ? 0 : k] = chance_[at(k)] * LightSampling::pdf(from.lights[at(k)]);
    if (!lit) return sample;
    const render::max_phong::reflection reflected = from.surface(x.direction);
    sample.f = radiance_[at(k)] * (reflected.brdf_cosine * x.solid_angle);
    sample.pdfs[brdf] = reflected.pdf * x.solid_angle;
    return sample;
  }

  int pick(float u) const {
    int k = 0;
    while (k < light_count - 1 && u >= upto_[at(k)]) ++k;
    return k;
  }

  std::array<render::rgb, light_count> radiance_;
  std::array<float, light_count> chance_;  ///< that a light technique takes this light
  std::array<float, light_count> upto_;    ///< chances of two techniques, summed
};

}  // namespace direct_lighting

#endif  // PHIMIS_EXAMPLES_DIRECT_LIGHTING_TECHNIQUES_HPP
