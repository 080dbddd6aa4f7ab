// SPDX-License-Identifier: MIT
#ifndef PHIMIS_TECHNIQUE_GAUSSIAN_HPP
#define PHIMIS_TECHNIQUE_GAUSSIAN_HPP

#include <phimis/core/finite.hpp>
#include <phimis/technique/distribution.hpp>

#include <boost/math/distributions/normal.hpp>

namespace phimis {

/// Normal distribution of given mean and standard deviation, truncated to a domain and renormalised there.
///
/// Errors std::invalid_argument where mean is not finite, sigma is not positive, or the domain holds no probability.
class gaussian : public distribution<boost::math::normal> {
 public:
  gaussian(double mean, double sigma, interval domain = {})
      : distribution(boost::math::normal(finite_mean(mean), positive_sigma(sigma)), domain) {}

 private:
  static double finite_mean(double mean) {
    require(is_finite(mean), "mean", "must be finite", mean);
    return mean;
  }
  static double positive_sigma(double sigma) {
    require(sigma > 0 && is_finite(sigma), "sigma", "must be finite and greater than 0", sigma);
    return sigma;
  }
};

}  // namespace phimis

#endif  // PHIMIS_TECHNIQUE_GAUSSIAN_HPP
