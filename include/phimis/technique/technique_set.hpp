// SPDX-License-Identifier: MIT
#ifndef PHIMIS_TECHNIQUE_TECHNIQUE_SET_HPP
#define PHIMIS_TECHNIQUE_TECHNIQUE_SET_HPP

#include <phimis/concepts.hpp>
#include <phimis/core/fractions.hpp>

#include <cstddef>
#include <tuple>
#include <utility>

namespace phimis {

/// The techniques p_1..p_M that are combined, each of its own type, all sampling points of one type.
template <technique... Techniques>
class technique_set {
  static_assert(sizeof...(Techniques) >= 1, "at least one technique is needed");

 public:
  static constexpr int techniques = sizeof...(Techniques);
  using first = std::tuple_element_t<0, std::tuple<Techniques...>>;
  using point = decltype(std::declval<const first&>().sample(std::declval<detail::any_uniform_source>()));

  explicit technique_set(Techniques... all) : all_(std::move(all)...) {}

  /// p_1(x)..p_M(x)
  per_technique<double, techniques> pdfs(const point& x) const {
    return std::apply(
        [&](const auto&... t) { return per_technique<double, techniques>{{static_cast<double>(t.pdf(x))...}}; },
        all_);
  }

  /// A point from technique k.
  template <uniform_source Next>
  point sample(int k, Next& next) const {
    return sample_from(k, next, std::make_index_sequence<sizeof...(Techniques)>{});
  }

 private:
  template <class Next, std::size_t... I>
  point sample_from(int k, Next& next, std::index_sequence<I...>) const {
    point x{};
    (void)((static_cast<int>(I) == k ? (x = std::get<I>(all_).sample(next), true) : false) || ...);
    return x;
  }

  std::tuple<Techniques...> all_;
};

}  // namespace phimis

#endif  // PHIMIS_TECHNIQUE_TECHNIQUE_SET_HPP
