// SPDX-License-Identifier: MIT
#ifndef PHIMIS_TECHNIQUE_DISTRIBUTION_HPP
#define PHIMIS_TECHNIQUE_DISTRIBUTION_HPP

#include <phimis/concepts.hpp>
#include <phimis/interval.hpp>

#include <boost/math/distributions/complement.hpp>
#include <boost/math/distributions/fwd.hpp>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

namespace phimis {

namespace detail {

// Boost.Math's accessors are found by their argument; members of the same name would hide them.
template <class D>
auto support_of(const D& d) {
  return support(d);
}
template <class D>
double pdf_of(const D& d, double x) {
  try {
    return pdf(d, x);
  } catch (const std::overflow_error&) {  // how Boost.Math says infinity: a beta distribution at its ends
    return std::numeric_limits<double>::infinity();
  }
}
template <class D>
double cdf_of(const D& d, double x, bool upper_tail) {
  return upper_tail ? cdf(boost::math::complement(d, x)) : cdf(d, x);
}
template <class D>
double quantile_of(const D& d, double p, bool upper_tail) {
  return upper_tail ? quantile(boost::math::complement(d, p)) : quantile(d, p);
}

}  // namespace detail

/// Any continuous distribution of Boost.Math as a technique, truncated to a domain and renormalised there.
///
///     p(x) = d(x) / Z inside the domain, 0 outside,   Z = D(upper) − D(lower)
///
/// Requires a distribution with pdf, cdf, quantile and complements, as Boost.Math's have.
/// Errors   std::invalid_argument where the domain holds no probability.
///
///     phimis::distribution technique(boost::math::exponential(2.0), phimis::interval(0, 3));
template <class Distribution>
class distribution {
 public:
  explicit distribution(Distribution base, interval domain = {}) : base_(std::move(base)), domain_(domain) {
    const auto [least, most] = detail::support_of(base_);
    lower_ = std::max(domain.lower(), static_cast<double>(least));
    upper_ = std::min(domain.upper(), static_cast<double>(most));
    if (!(lower_ < upper_)) require(false, "domain", "must overlap the distribution's support", upper_);
    // In the upper tail the complements keep the digits that the cdf loses.
    upper_tail_ = detail::cdf_of(base_, lower_, false) > 0.5;
    from_ = probability(lower_);
    mass_ = upper_tail_ ? from_ - probability(upper_) : probability(upper_) - from_;
    require(mass_ > 0, "domain", "must hold some of the distribution's probability", mass_);
  }

  const interval& domain() const noexcept { return domain_; }

  /// 0 outside the domain, also where x is NaN; infinite where the density is.
  double pdf(double x) const { return x >= lower_ && x <= upper_ ? detail::pdf_of(base_, x) / mass_ : 0; }

  /// The point of the next uniform number, by inversion.
  template <uniform_source Next>
  double sample(Next&& next) const {
    // Neither u = 0 nor rounding to p = 1 may ask for the quantile at infinity: 0 stands for the cell [0, 2^-53).
    const double u = std::max(static_cast<double>(next()), 0x1p-54);
    const double p = std::clamp(upper_tail_ ? from_ - u * mass_ : from_ + u * mass_,
                                std::numeric_limits<double>::min(), 1 - std::numeric_limits<double>::epsilon() / 2);
    const double x = detail::quantile_of(base_, p, upper_tail_);
    return std::clamp(x, lower_, upper_);
  }

  /// The uniform number that `sample` turns into x: the cdf.
  double invert(double x) const {
    if (x <= lower_) return 0;
    if (x >= upper_) return 1;
    return (upper_tail_ ? from_ - probability(x) : probability(x) - from_) / mass_;
  }

 private:
  double probability(double x) const { return detail::cdf_of(base_, x, upper_tail_); }

  Distribution base_;
  interval domain_;
  double lower_ = 0;
  double upper_ = 0;
  double from_ = 0;
  double mass_ = 1;
  bool upper_tail_ = false;
};

}  // namespace phimis

#endif  // PHIMIS_TECHNIQUE_DISTRIBUTION_HPP
