// SPDX-License-Identifier: MIT
#ifndef PHIMIS_CORE_KINK_HPP
#define PHIMIS_CORE_KINK_HPP

#include <phimis/core/config.hpp>
#include <phimis/core/divergence.hpp>

#include <type_traits>
#include <utility>

namespace phimis {

/// A divergence whose kink at t = 1 is rounded off within `width`.
template <class Divergence>
struct rounded_off {
  Divergence divergence;
  double width;

  template <class Real>
  PHIMIS_HOST_DEVICE phi_taylor<Real> taylor(Real t) const noexcept {
    return divergence.taylor(t, static_cast<Real>(width));
  }
  template <class Real>
  PHIMIS_HOST_DEVICE score<Real> score_of(Real t) const noexcept {
    return divergence.score_of(t, static_cast<Real>(width));
  }
};

template <class Divergence>
PHIMIS_HOST_DEVICE rounded_off<Divergence> round_off(const Divergence& divergence, double width) noexcept {
  return {divergence, width};
}
template <class Divergence>
PHIMIS_HOST_DEVICE reversed<rounded_off<Divergence>> round_off(const reversed<Divergence>& divergence,
                                                               double width) noexcept {
  return {{divergence.forward, width}};
}

/// Whether a divergence has a kink that has to be rounded off.
template <class Divergence>
PHIMIS_HOST_DEVICE auto has_sharp_kink(const Divergence& divergence) noexcept -> decltype(divergence.smooth()) {
  return !divergence.smooth();
}
template <class Divergence>
PHIMIS_HOST_DEVICE auto has_sharp_kink(const reversed<Divergence>& divergence) noexcept
    -> decltype(divergence.forward.smooth()) {
  return !divergence.forward.smooth();
}

namespace detail {

template <class Divergence, class = void>
struct can_round_off : std::false_type {};
template <class Divergence>
struct can_round_off<Divergence, std::void_t<decltype(has_sharp_kink(std::declval<const Divergence&>()))>>
    : std::true_type {};

/// A slope at a rounded kink is no scale of a score.
template <class Divergence>
struct is_rounded_off : std::false_type {};
template <class Divergence>
struct is_rounded_off<rounded_off<Divergence>> : std::true_type {};
template <class Divergence>
struct is_rounded_off<reversed<rounded_off<Divergence>>> : std::true_type {};

template <class Divergence, class = void>
struct is_kinked : std::false_type {};
template <class Divergence>
struct is_kinked<Divergence, std::enable_if_t<Divergence::kinked>> : std::true_type {};
template <class Divergence>
struct is_kinked<reversed<Divergence>> : is_kinked<Divergence> {};

}  // namespace detail

}  // namespace phimis

#endif  // PHIMIS_CORE_KINK_HPP
