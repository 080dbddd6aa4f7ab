// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_ENVIRONMENT_MAP_HPP
#define PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_ENVIRONMENT_MAP_HPP

#include <environment_lighting/lat_long.hpp>
#include <environment_lighting/map_distribution.hpp>
#include <render/image.hpp>
#include <render/rgb.hpp>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

namespace environment_lighting {

/// Radiance from every direction, constant in each texel of a lat–long map, and densities in proportion to its luminance.
///
///     whole(ω) ∝ luminance(ω);   bright(ω), rest(ω): the same, on the brightest region and off it
///
/// The brightest region is the smallest that emits half of the power; where nothing off it has light, as where all texels
/// are alike, there is none, and bright and rest are both the whole. A black map has uniform densities.
///
/// Requires finite radiance that is not negative.
class environment_map {
 public:
  explicit environment_map(render::image<render::rgb> radiance)
      : radiance_(std::move(radiance)),
        on_(radiance_.width, radiance_.height),
        whole_(luminances([](float) { return true; })) {
    black_ = !std::any_of(radiance_.pixels.begin(), radiance_.pixels.end(),
                          [](render::rgb c) { return luminance(c) > 0; });
    threshold_ = brightest_half();
    bright_ = map_distribution(luminances([this](float l) { return l >= threshold_; }));
    rest_ = map_distribution(luminances([this](float l) { return l < threshold_ || !splits(); }));
  }

  const lat_long& directions() const { return on_; }
  const map_distribution& whole() const { return whole_; }
  const map_distribution& bright() const { return bright_; }
  const map_distribution& rest() const { return rest_; }
  bool black() const { return black_; }

  render::rgb radiance(const lat_long::place& at) const { return radiance_(at.column, at.row); }

  /// A radiance's densities.   Units 1/sr.
  float whole_pdf(render::rgb radiance) const { return value(radiance) / static_cast<float>(whole_.total()); }
  float bright_pdf(render::rgb radiance) const {
    return value(radiance) >= threshold_ ? value(radiance) / static_cast<float>(bright_.total()) : 0.0f;
  }
  float rest_pdf(render::rgb radiance) const {
    return value(radiance) < threshold_ || !splits() ? value(radiance) / static_cast<float>(rest_.total()) : 0.0f;
  }

 private:
  float value(render::rgb radiance) const { return black_ ? 1.0f : luminance(radiance); }
  bool splits() const { return threshold_ > 0; }

  template <class Keep>
  render::image<float> luminances(const Keep& keep) const {
    return render::map(radiance_, [&](render::rgb c) { return keep(luminance(c)) ? luminance(c) : 0.0f; });
  }

  /// The luminance at and above which texels are of the brightest region; 0 where there is none.
  float brightest_half() const {
    std::vector<std::size_t> order(radiance_.pixels.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto at = [this](std::size_t i) { return luminance(radiance_.pixels[i]); };
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return at(a) > at(b); });
    double sum = 0;
    std::size_t i = 0;
    for (; i < order.size() && sum < whole_.total() / 2; ++i) {
      sum += static_cast<double>(at(order[i])) *
             static_cast<double>(on_.solid_angle(static_cast<int>(order[i]) / radiance_.width));
    }
    // All of the same luminance are in it; what is left must have some light.
    const float least = i > 0 ? at(order[i - 1]) : 0.0f;
    const auto left = std::find_if(order.begin(), order.end(), [&](std::size_t j) { return at(j) < least; });
    return left != order.end() && at(*left) > 0 ? least : 0.0f;
  }

  render::image<render::rgb> radiance_;
  lat_long on_;
  map_distribution whole_, bright_ = whole_, rest_ = whole_;
  bool black_ = false;
  float threshold_ = 0;
};

}  // namespace environment_lighting

#endif  // PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_ENVIRONMENT_MAP_HPP
