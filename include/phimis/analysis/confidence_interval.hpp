// SPDX-License-Identifier: MIT
#ifndef PHIMIS_ANALYSIS_CONFIDENCE_INTERVAL_HPP
#define PHIMIS_ANALYSIS_CONFIDENCE_INTERVAL_HPP

#include <phimis/core/finite.hpp>
#include <phimis/core/value.hpp>
#include <phimis/error.hpp>

#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>

#include <algorithm>

namespace phimis::analysis {

/// Two values between which the integral lies; a colour's by component.
template <class Value>
struct confidence_bounds {
  Value lower;
  Value upper;
};

/// How many standard errors a confidence interval reaches to each side: Student's t.
///
/// Errors std::invalid_argument where the level is not in (0, 1), or there are no degrees of freedom. Fewer than one count
///        as one.
inline double confidence_factor(double level, double degrees_of_freedom) {
  require(level > 0 && level < 1, "confidence level", "must lie in (0, 1)", level);
  require(degrees_of_freedom > 0, "degrees_of_freedom", "must be greater than 0", degrees_of_freedom);
  const double tail = (1 - level) / 2;
  // Boost's t warns of more degrees of freedom than it can tell from the normal distribution.
  if (!(degrees_of_freedom < 1e8)) return quantile(complement(boost::math::normal(), tail));
  return quantile(complement(boost::math::students_t(std::max(degrees_of_freedom, 1.0)), tail));
}

/// The integral, with a given probability, from an estimate and its standard error.
///
///     F ± t_ν(level) · standard error
///
/// ν are the degrees of freedom of the standard error (Welch 1947; Satterthwaite 1946): of an `integration` with all its
/// techniques and iterations, of an `estimator` for one batch. With hundreds of samples t is the normal quantile; with ten
/// a technique, intervals of 1.96 standard errors hold less often than they say. docs/confidence.md has figures.
///
/// - Nothing mends skewness: where samples may miss a peak, low estimates come with small standard errors.
/// - Without variance the interval is the estimate alone; it is the whole line where the standard error is unknown.
///
/// Errors std::invalid_argument where the level is not in (0, 1).
template <class Value>
confidence_bounds<Value> confidence_interval(const Value& estimate, const Value& standard_error,
                                             double degrees_of_freedom, double level = 0.95) {
  using real = typename value_traits<Value>::real;
  const double factor = confidence_factor(level, std::max(degrees_of_freedom, 1.0));
  const Value reach = standard_error * static_cast<real>(factor);
  return {estimate - reach, estimate + reach};
}

/// Of an `integration`.
template <class Integration>
auto confidence_interval(const Integration& run, double level = 0.95) -> confidence_bounds<decltype(run.estimate)> {
  return confidence_interval(run.estimate, run.standard_error, run.degrees_of_freedom, level);
}

}  // namespace phimis::analysis

#endif  // PHIMIS_ANALYSIS_CONFIDENCE_INTERVAL_HPP
