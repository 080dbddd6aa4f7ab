// SPDX-License-Identifier: MIT
#ifndef PHIMIS_DIVERGENCE_PHI_DIVERGENCE_HPP
#define PHIMIS_DIVERGENCE_PHI_DIVERGENCE_HPP

#include <phimis/core/divergence.hpp>
#include <phimis/core/finite.hpp>

#include <boost/math/differentiation/autodiff.hpp>

#include <cmath>
#include <limits>
#include <utility>

namespace phimis {

/// The divergence of any convex φ with φ(1) = 0 that is given as one generic callable.
///
///     auto jensen_shannon = phimis::phi_divergence([](auto t) { return t * log(t) - (1 + t) * log((1 + t) / 2); });
///
/// Its derivatives come from Boost.Math's automatic differentiation, so φ must call functions unqualified (log, not
/// std::log).
///
/// Requires φ convex on t > 0; it may be NaN or infinite at 0, where its limit is taken.
/// Source   T Sec. 5.1, Eqs. 11, 15–18.
template <class Phi>
class phi_divergence {
 public:
  /// φ may have kinks anywhere: at least one at t = 1 is expected by those who integrate it.
  static constexpr bool kinked = true;

  explicit phi_divergence(Phi phi) : phi_(std::move(phi)) {}

  template <class Real>
  phi_taylor<Real> taylor(Real t) const {
    phi_taylor<double> at = derivatives(static_cast<double>(t));
    if (!(t > 0) && !is_finite(at.value) && !(at.value > 0))
      at.value = derivatives(std::numeric_limits<double>::min()).value;
    return {static_cast<Real>(at.value), static_cast<Real>(at.first), static_cast<Real>(at.second)};
  }

 private:
  phi_taylor<double> derivatives(double t) const {
    const auto x = boost::math::differentiation::make_fvar<double, 2>(t);
    const auto y = phi_(x);
    return {static_cast<double>(y.derivative(0u)), static_cast<double>(y.derivative(1u)),
            static_cast<double>(y.derivative(2u))};
  }

  Phi phi_;
};

}  // namespace phimis

#endif  // PHIMIS_DIVERGENCE_PHI_DIVERGENCE_HPP
