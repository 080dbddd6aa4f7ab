// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_PAPERS_LINEAR_STUDY_HPP
#define PHIMIS_EXAMPLES_PAPERS_LINEAR_STUDY_HPP

#include <papers/linear_problems.hpp>
#include <papers/tsallis_study.hpp>

#include <phimis/analysis/optimum.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

// What the figures of the linear heuristic's paper show, as numbers.

namespace papers {

/// V[F] at the fractions that one run learns from 100 samples of each technique.
struct linear_run {
  double dropped;    ///< the linear heuristic, L Sec. 5.1, first technique
  double best_face;  ///< second technique
  double projected;  ///< third, ours
  double exact;      ///< the exact minimiser of χ², with control variate
  bool negative;     ///< whether the linear equations had a negative solution
  double newton;     ///< two techniques: Newton–Raphson for Kullback–Leibler, 4 batches of 50; NaN for more
  double without_1;  ///< three techniques: the linear heuristic of the second and third; NaN for others
};

/// What the linear heuristic finds with infinitely many samples.
template <int M>
struct linear_limit {
  phimis::fractions<double, M> solution;  ///< of Eq. 14, perhaps negative
  phimis::fractions<double, M> dropped;
  phimis::fractions<double, M> best_face;
  phimis::fractions<double, M> projected;
};

/// Means of f/p(α) over 100 samples of one technique, at the α of least V[F].
struct mean_pair {
  double arithmetic;
  double geometric;
};

/// One example of the paper.
template <int M>
struct linear_study {
  int number;
  phimis::analysis::problem<M> problem;
  double equal = 0;                        ///< V[F] of equal counts
  phimis::fractions<double, M> optimal{};  ///< of least V[F]
  phimis::measured least{};                ///< V[F] there
  linear_limit<M> limit{};
  std::vector<linear_run> runs{};
  std::vector<std::array<mean_pair, M>> means{};  ///< of each run, of each technique
};

/// V[F]; what is not finite, at fractions that miss a part of f, is infinite.
template <int M>
double variance_at(const phimis::analysis::problem<M>& on, const phimis::fractions<double, M>& alpha) {
  const double v = phimis::analysis::variance(on, alpha).multi_sample.value;
  return phimis::is_finite(v) ? v : phimis::infinity<double>;
}

/// The equations on exact integrals.  P_ik = ∫ p_i p_k dx, F_k = ∫ f p_k dx
template <int M>
linear_limit<M> limit_of(const phimis::analysis::problem<M>& on) {
  using pdfs = phimis::per_technique<double, M>;
  phimis::linear_equations<M> equations{};
  equations.rounding = 1e-15;
  for (int k = 0; k < M; ++k) {
    equations.f[k] = on.integral([k](double f, const pdfs& p, double) { return f * p[k]; }).value;
    for (int i = 0; i < M; ++i) {
      equations.p[i][k] = on.integral([i, k](double, const pdfs& p, double) { return p[i] * p[k]; }).value;
    }
  }
  const auto options = phimis::without_floors<double, M>();
  const phimis::movable_techniques<M> all(options);
  linear_limit<M> result{};
  double tau[M];
  equations.solve(all, all.all(), tau);
  result.solution = all.at(tau);
  const bool negative = !all.feasible(tau);
  equations.drop_most_negative(all, tau);
  result.dropped = result.best_face = result.projected = all.at(tau);
  if (!negative) return result;

  equations.best_face(
      all, [&](const auto& alpha) { return variance_at(on, alpha); }, tau);
  result.best_face = all.at(tau);
  phimis::projection_sums<double, M> projection;
  const auto rows = on.rows();
  for (std::ptrdiff_t j = 0; j < rows.size(); ++j) projection.add(rows[j]);
  projection.fit(all, options.start, 0, 1, tau);
  result.projected = all.at(tau);
  return result;
}

namespace detail {

template <class Rule, class Observations>
auto fractions_after(Rule rule, const Observations& all) {
  for (const auto& sample : all) rule.observe(sample);
  rule.update();
  return rule;
}

/// Samples of the second and third technique, as of a problem of two.
inline std::vector<phimis::observation<double, 2>> without_first(
    const std::vector<phimis::observation<double, 3>>& all) {
  std::vector<phimis::observation<double, 2>> two;
  for (const auto& o : all) {
    if (o.technique > 0) two.push_back({o.f, {{o.pdfs[1], o.pdfs[2]}}, (o.pdfs[1] + o.pdfs[2]) / 2, o.technique - 1});
  }
  return two;
}

}  // namespace detail

/// One run: 100 samples of each technique, learnt from in every way.
template <class Paper, class Techniques, int M>
linear_run run_once(const Paper& paper, const Techniques& techniques, linear_study<M>& of, std::uint64_t seed,
                    int repetition) {
  using namespace phimis;
  const int example = 20 + of.number;
  std::mt19937_64 engine = stream(seed, example, 0, 0, repetition);
  auto next = [&engine] { return uniform(engine()); };
  std::vector<observation<double, M>> all;
  draw_batch(paper.f, techniques, equal_fractions<double, M>(), {.samples = 100 * M}, balance{}, next,
             [&](const auto& sample) { all.push_back(sample.observed); });

  std::array<mean_pair, M> means{};
  for (const auto& o : all) {
    const double t = o.f / mixture(of.optimal, o.pdfs);
    auto& mean = means[static_cast<std::size_t>(o.technique)];
    mean.arithmetic += t / 100;
    mean.geometric += std::log(t) / 100;
  }
  for (auto& mean : means) mean.geometric = std::exp(mean.geometric);
  of.means.push_back(means);

  const auto free = without_floors<double, M>();
  const auto value = [&](const auto& rule) { return variance_at(of.problem, rule.fractions()); };
  const auto dropped = detail::fractions_after(linear_rule<M, negative_fractions::drop_most_negative>(free), all);
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  linear_run run{
      .dropped = value(dropped),
      .best_face = value(detail::fractions_after(linear_rule<M, negative_fractions::best_face>(free), all)),
      .projected = value(detail::fractions_after(linear_rule<M>(free), all)),
      .exact = value(detail::fractions_after(exact_rule<M>(chi_squared{}, free), all)),
      .negative = dropped.counters().left > 0,
      .newton = none,
      .without_1 = none};
  if constexpr (M == 2) {
    auto newton = newton_rule(kullback_leibler{}, newton_form::paper, free);
    engine = stream(seed, example, 0, 1, repetition);
    for (int batch = 0; batch < 4; ++batch) {
      draw_batch(paper.f, techniques, newton.fractions(), {.samples = 50, .model = sampling_model::one_sample},
                 balance{}, next, [&](const auto& sample) { newton.observe(sample.observed); });
      newton.update();
    }
    run.newton = value(newton);
  }
  if constexpr (M == 3) {
    const auto two =
        detail::fractions_after(linear_rule<2, negative_fractions::drop_most_negative>(without_floors<double, 2>()),
                                detail::without_first(all));
    run.without_1 = variance_at(of.problem, {{0, two.fractions()[0], two.fractions()[1]}});
  }
  return run;
}

template <class Paper>
auto study_linear(int number, const Paper& paper, std::uint64_t seed, int runs) {
  using namespace phimis;
  const auto techniques = paper.techniques();
  constexpr int M = decltype(techniques)::techniques;
  linear_study<M> result{.number = number, .problem = analysis::problem(paper.f, techniques, paper.domain())};
  result.equal = variance_at(result.problem, equal_fractions<double, M>());
  result.optimal = analysis::optimum(multi_sample_variance{}, result.problem).alpha;
  result.least = analysis::variance(result.problem, result.optimal).multi_sample;
  result.limit = limit_of(result.problem);
  for (int run = 0; run < runs; ++run) result.runs.push_back(run_once(paper, techniques, result, seed, run));
  return result;
}

}  // namespace papers

#endif  // PHIMIS_EXAMPLES_PAPERS_LINEAR_STUDY_HPP
