// SPDX-License-Identifier: MIT
#ifndef PHIMIS_ESTIMATOR_ITERATION_SIZES_HPP
#define PHIMIS_ESTIMATOR_ITERATION_SIZES_HPP

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace phimis {

/// How many samples each of B iterations has.
///
///     n_b = l + (N − B l) r^b / Σ_i r^i,   r^(B − 1) = growth,   l = min(M, N/B)
///
/// What rounding leaves goes to the first ones, one each. Every technique may have a sample in every iteration where the
/// budget allows that.
///
/// \param growth the samples of the last iteration over those of the first, but for l; 1 spreads them evenly
inline std::vector<std::int64_t> iteration_sizes(std::int64_t budget, int iterations, double growth, int techniques) {
  const auto count = static_cast<std::size_t>(iterations);
  const std::int64_t least = std::min<std::int64_t>(techniques, budget / iterations);
  const std::int64_t rest = budget - least * iterations;
  // In units of the largest.
  std::vector<double> shares(count, 1);
  double sum = 0;
  for (std::size_t b = 0; b < count; ++b) {
    const double last = static_cast<double>(count) - 1;
    if (count > 1) shares[b] = std::pow(growth, (static_cast<double>(b) - (growth > 1 ? last : 0)) / last);
    sum += shares[b];
  }
  std::vector<std::int64_t> sizes(count, least);
  std::int64_t left = rest;
  for (std::size_t b = 0; b < count; ++b) {
    const double share = std::floor(static_cast<double>(rest) * shares[b] / sum);
    const std::int64_t own = std::min(left, static_cast<std::int64_t>(share));
    sizes[b] += own;
    left -= own;
  }
  for (std::size_t b = 0; left > 0; b = (b + 1) % count, --left) ++sizes[b];
  return sizes;
}

}  // namespace phimis

#endif  // PHIMIS_ESTIMATOR_ITERATION_SIZES_HPP
