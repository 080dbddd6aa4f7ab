// SPDX-License-Identifier: MIT
#ifndef PHIMIS_TESTS_STATISTICAL_LEARNING_HPP
#define PHIMIS_TESTS_STATISTICAL_LEARNING_HPP

#include "papers/tsallis_problems.hpp"

#include <phimis/analysis/optimum.hpp>
#include <phimis/phimis.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace learning {

/// A quantile of a sample with its standard error, from the order statistics one standard deviation of rank away.
struct quantile {
  double value;
  double error;
};

inline quantile quantile_of(std::vector<double> sample, double share) {
  std::sort(sample.begin(), sample.end());
  const double n = static_cast<double>(sample.size());
  const double rank = share * (n - 1);
  const double spread = std::sqrt(n * share * (1 - share));
  const auto at = [&](double r) { return sample[static_cast<std::size_t>(std::clamp(r, 0.0, n - 1))]; };
  return {at(rank), (at(rank + spread) - at(rank - spread)) / 2};
}

/// Quality of learnt fractions over many runs.
struct outcome {
  quantile median;
  quantile ninetieth;
  double left;  ///< share of runs in which an iterate left [0, 1]
};

/// A paper's problem with its oracle, and what V[F] is divided by: its minimum, or equal counts' where that is 0.
template <class Paper>
struct arena {
  static constexpr int M = decltype(Paper::techniques())::techniques;

  phimis::analysis::problem<M> oracle{Paper::f, Paper::techniques(), Paper::domain()};
  decltype(Paper::techniques()) techniques = Paper::techniques();
  double unit = 1;

  arena() {
    const auto best = phimis::analysis::optimum(phimis::multi_sample_variance{}, oracle).alpha;
    unit = variance(best) > 1e-20 ? variance(best) : variance(phimis::equal_fractions<double, M>());
  }

  double variance(const phimis::fractions<double, M>& alpha) const {
    const double v = phimis::analysis::variance(oracle, alpha).multi_sample.value;
    return phimis::is_finite(v) ? v : 1e300;
  }

  /// V[F] at the fractions that a rule learns in a number of batches, over the unit.
  template <class MakeRule>
  outcome learn(const MakeRule& make_rule, int runs, phimis::batch_options batch, int batches,
                std::uint64_t seed) const {
    std::vector<double> quality;
    int left = 0;
    for (int run = 0; run < runs; ++run) {
      std::mt19937_64 engine(seed * 1000003 + static_cast<std::uint64_t>(run));
      auto next = [&] { return phimis::uniform(engine()); };
      auto rule = make_rule();
      for (int b = 0; b < batches; ++b) {
        phimis::draw_batch(Paper::f, techniques, rule.fractions(), batch, phimis::balance{}, next,
                           [&](const auto& sample) { rule.observe(sample.observed); });
        rule.update();
      }
      left += rule.counters().left > 0 ? 1 : 0;
      quality.push_back(variance(rule.fractions()) / unit);
    }
    return {quantile_of(quality, 0.5), quantile_of(quality, 0.9), static_cast<double>(left) / runs};
  }
};

}  // namespace learning

#endif  // PHIMIS_TESTS_STATISTICAL_LEARNING_HPP
