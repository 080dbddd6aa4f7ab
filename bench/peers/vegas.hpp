// SPDX-License-Identifier: MIT
#ifndef PHIMIS_BENCH_PEERS_VEGAS_HPP
#define PHIMIS_BENCH_PEERS_VEGAS_HPP

#include <gsl/gsl_monte_vegas.h>
#include <gsl/gsl_rng.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

namespace bench::peers {

/// GSL's VEGAS: importance and stratified sampling on a grid that adapts, five iterations, averaged by inverse variance. It
/// samples the box of the problem itself and knows nothing of techniques.
///
/// Source Lepage 1978; GSL 2.
template <class Problem>
double vegas(const Problem& on, std::int64_t budget, std::uint64_t seed) {
  constexpr std::size_t iterations = 5;
  const auto dimensions = static_cast<std::size_t>(on.dimensions);
  const std::unique_ptr<gsl_rng, decltype(&gsl_rng_free)> random(gsl_rng_alloc(gsl_rng_mt19937), gsl_rng_free);
  gsl_rng_set(random.get(), static_cast<unsigned long>(seed));
  const std::unique_ptr<gsl_monte_vegas_state, decltype(&gsl_monte_vegas_free)> state(
      gsl_monte_vegas_alloc(dimensions), gsl_monte_vegas_free);
  gsl_monte_vegas_params settings;
  gsl_monte_vegas_params_get(state.get(), &settings);
  settings.iterations = iterations;
  gsl_monte_vegas_params_set(state.get(), &settings);
  gsl_monte_function f{[](double* x, std::size_t n, void* problem) {
                         auto at = decltype(Problem::lower){};
                         std::copy(x, x + n, at.begin());
                         return static_cast<const Problem*>(problem)->f(at);
                       },
                       dimensions, const_cast<Problem*>(&on)};
  auto lower = on.lower;
  auto upper = on.upper;
  double estimate = 0;
  double standard_error = 0;
  gsl_monte_vegas_integrate(&f, lower.data(), upper.data(), dimensions, static_cast<std::size_t>(budget) / iterations,
                            random.get(), state.get(), &estimate, &standard_error);
  return estimate;
}

}  // namespace bench::peers

#endif  // PHIMIS_BENCH_PEERS_VEGAS_HPP
