// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_PAPERS_TSALLIS_STUDY_HPP
#define PHIMIS_EXAMPLES_PAPERS_TSALLIS_STUDY_HPP

#include <papers/tsallis_problems.hpp>

#include <phimis/analysis/optimum.hpp>

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

// What the figures of the Tsallis paper show, as numbers.

namespace papers {

using pair = phimis::fractions<double, 2>;

/// Fractions that were learnt from 5 iterations of 100 samples.
struct learnt_fractions {
  pair alpha{};
  double variance = 0;    ///< V[F] there
  std::int64_t left = 0;  ///< how many iterates left [0, 1]; each went on from the nearer end
};

/// Median and spread of repeated runs.
struct summary {
  double low;  ///< 10th percentile
  double median;
  double high;  ///< 90th percentile
  double left;  ///< share of runs in which an iterate left [0, 1]
};

/// All that the figures show at one γ.
struct order {
  double gamma = 0;
  pair alpha{};             ///< the optimum of the Tsallis divergence
  double multi_sample = 0;  ///< V[F] there
  double one_sample = 0;    ///< V[ℱ] there
  bool sampled = false;     ///< whether fractions were learnt at this γ
  learnt_fractions newton;  ///< by the paper's protocol
  learnt_fractions exact;   ///< by the exact minimiser with as many samples
  summary newton_runs{};    ///< V[F] over repeated runs, where there are any
  summary exact_runs{};
};

/// One example of the paper.
struct tsallis_study {
  int number;
  phimis::analysis::problem<2> problem;
  std::vector<order> orders;
  double equal_multi = 0;          ///< V[F] of equal counts
  phimis::measured least_multi{};  ///< the least V[F] of all fractions
  phimis::measured least_one{};    ///< the least V[ℱ]
};

/// The random stream of one run: a function of what the run is, not of the order of runs.
inline std::mt19937_64 stream(std::uint64_t seed, int example, int tenths, int rule, int repetition) {
  const auto word = [](auto value) { return static_cast<std::uint32_t>(value); };
  std::seed_seq words{word(seed), word(seed >> 32), word(example), word(tenths), word(rule), word(repetition)};
  return std::mt19937_64(words);
}

/// 5 iterations of 100 samples.
template <class Paper, class Rule>
learnt_fractions learn(const Paper& paper, const phimis::analysis::problem<2>& on, Rule rule,
                       phimis::sampling_model model, std::mt19937_64 engine) {
  static const auto techniques = paper.techniques();
  auto next = [&engine] { return phimis::uniform(engine()); };
  for (int k = 0; k < 5; ++k) {
    phimis::draw_batch(paper.f, techniques, rule.fractions(), {.samples = 100, .model = model}, phimis::balance{},
                       next, [&](const auto& sample) { rule.observe(sample.observed); });
    rule.update();
  }
  const pair alpha = rule.fractions();
  return {alpha, phimis::analysis::variance(on, alpha).multi_sample.value, rule.counters().left};
}

/// The paper's protocol: every iteration draws its samples from p(α) and takes one Newton–Raphson step.  T Sec. 6
template <class Paper>
learnt_fractions learn_by_newton(const Paper& paper, const phimis::analysis::problem<2>& on, double gamma,
                                 const std::mt19937_64& engine) {
  return learn(paper, on, phimis::newton_rule(phimis::tsallis{gamma}, phimis::newton_form::paper, phimis::without_floors<double, 2>()),
               phimis::sampling_model::one_sample, engine);
}

/// The library's rule: the exact minimum on all samples so far, each pdf made to integrate to one on them.
template <class Paper>
learnt_fractions learn_by_minimiser(const Paper& paper, const phimis::analysis::problem<2>& on, double gamma,
                                    const std::mt19937_64& engine) {
  return learn(paper, on, phimis::exact_rule(phimis::tsallis{gamma}, phimis::without_floors<double, 2>()), phimis::sampling_model::multi_sample, engine);
}

inline summary summarise(std::vector<learnt_fractions> runs) {
  std::sort(runs.begin(), runs.end(), [](const auto& a, const auto& b) { return a.variance < b.variance; });
  const auto at = [&](double share) {
    return runs[static_cast<std::size_t>(share * static_cast<double>(runs.size() - 1) + 0.5)].variance;
  };
  const auto left = std::count_if(runs.begin(), runs.end(), [](const auto& run) { return run.left > 0; });
  return {at(0.1), at(0.5), at(0.9), static_cast<double>(left) / static_cast<double>(runs.size())};
}

/// γ = 0.1, 0.2, ..., 8 for the curves; dots at every `stride`-th of them, each with `repetitions` further runs.
template <class Paper>
tsallis_study study(int number, const Paper& paper, std::uint64_t seed, int stride, int repetitions) {
  using namespace phimis;
  tsallis_study result{number, analysis::problem(paper.f, paper.techniques(), paper.domain()), {}};
  const auto& on = result.problem;
  result.equal_multi = analysis::variance(on, equal_fractions<double, 2>()).multi_sample.value;
  result.least_multi = analysis::variance(on, analysis::optimum(multi_sample_variance{}, on).alpha).multi_sample;
  result.least_one = analysis::variance(on, analysis::optimum(one_sample_variance{}, on).alpha).one_sample;
  for (int tenths = 1; tenths <= 80; ++tenths) {
    order at;
    at.gamma = tenths / 10.0;
    at.alpha = analysis::optimum(tsallis{at.gamma}, on).alpha;
    const auto variances = analysis::variance(on, at.alpha);
    at.multi_sample = variances.multi_sample.value;
    at.one_sample = variances.one_sample.value;
    if (tenths % stride == 0) {
      std::vector<learnt_fractions> newton;
      std::vector<learnt_fractions> exact;
      for (int run = 0; run <= repetitions; ++run) {
        newton.push_back(learn_by_newton(paper, on, at.gamma, stream(seed, number, tenths, 0, run)));
        exact.push_back(learn_by_minimiser(paper, on, at.gamma, stream(seed, number, tenths, 1, run)));
      }
      at.sampled = true;
      at.newton = newton.front();
      at.exact = exact.front();
      if (repetitions > 0) {
        at.newton_runs = summarise({newton.begin() + 1, newton.end()});
        at.exact_runs = summarise({exact.begin() + 1, exact.end()});
      }
    }
    result.orders.push_back(at);
  }
  return result;
}

}  // namespace papers

#endif  // PHIMIS_EXAMPLES_PAPERS_TSALLIS_STUDY_HPP
