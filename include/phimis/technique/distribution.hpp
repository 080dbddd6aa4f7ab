// SPDX-License-Identifier: MIT
#ifndef PHIMIS_TECHNIQUE_DISTRIBUTION_HPP
#define PHIMIS_TECHNIQUE_DISTRIBUTION_HPP

#include <phimis/concepts.hpp>
#include <phimis/technique/interval.hpp>

#include <boost/math/distributions/complement.hpp>
#include <boost/math/distributions/fwd.hpp>

#include <algorithm>
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
  return pdf(d, x);
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

  double pdf(double x) const { return x < lower_ || x > upper_ ? 0 : detail::pdf_of(base_, x) / mass_; }

  /// The point of the next uniform number, by inversion.
  template <uniform_source Next>
  double sample(Next&& next) const {
    const double u = next();
    const double p = upper_tail_ ? from_ - u * mass_ : from_ + u * mass_;
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
