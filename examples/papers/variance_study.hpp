// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_PAPERS_VARIANCE_STUDY_HPP
#define PHIMIS_EXAMPLES_PAPERS_VARIANCE_STUDY_HPP

#include <papers/variance_problems.hpp>

#include <phimis/analysis/allocation.hpp>
#include <phimis/analysis/optimum.hpp>
#include <phimis/analysis/variance.hpp>

// What the tables of the variance paper are made of, for each example.

namespace papers {

using triple = phimis::fractions<double, 3>;

/// Fractions, both variances there, and the mean cost of a sample.
struct allotment {
  triple alpha;
  phimis::analysis::variances variance;
  double cost;

  phimis::measured one_sample_times_cost() const {
    return {cost * variance.one_sample.value, cost * variance.one_sample.error};
  }
  phimis::measured multi_sample_times_cost() const {
    return {cost * variance.multi_sample.value, cost * variance.multi_sample.error};
  }
};

struct variance_study {
  int number;
  phimis::analysis::problem<3> problem;
  phimis::per_technique<phimis::measured, 3> alone;   ///< V[G_i]
  phimis::per_technique<double, 3> alone_as_printed;  ///< of examples 3 and 4: up to the double nearest to π
  phimis::analysis::part_moments<3> parts;            ///< of the estimator of Sec. 4
  allotment equal;
  allotment by_variance;           ///< α_i ∝ 1/V[G_i] as printed
  allotment by_cost_and_variance;  ///< α_i ∝ 1/(c_i V[G_i]) as printed
  allotment by_true_variance;      ///< the same with V[G_3] = ∞
  allotment by_cost_and_true_variance;
  allotment least_multi_sample;  ///< of all fractions, which the paper did not look for
  allotment least_one_sample;
  allotment cheapest_multi_sample;  ///< least cost × V[F]
  allotment cheapest_one_sample;
};

/// α_k ∝ 1/(c_k V_k); 0 where V_k is infinite.
inline triple inverse_to(const phimis::per_technique<double, 3>& variances,
                         const phimis::per_technique<double, 3>& costs) {
  phimis::per_technique<double, 3> shares{};
  for (int k = 0; k < 3; ++k) shares[k] = 1 / (costs[k] * variances[k]);
  return phimis::with_floors(shares, {});
}

inline allotment allot(const phimis::analysis::problem<3>& on, const triple& alpha) {
  return {alpha, phimis::analysis::variance(on, alpha), phimis::analysis::mean_cost(alpha, variance_setting::costs)};
}

template <class Paper>
variance_study study(int number, const Paper& paper) {
  using namespace phimis;
  const per_technique<double, 3> no_costs = equal_costs<double, 3>();
  const per_technique<double, 3>& costs = variance_setting::costs;
  const analysis::problem<3> on(paper.f, paper.techniques(), paper.domain());
  const per_technique<measured, 3> alone = analysis::variance_alone(on);
  per_technique<double, 3> exact{{alone[0].value, alone[1].value, alone[2].value}};
  per_technique<double, 3> as_printed = exact;
  if constexpr (requires { paper.f_from_pi(0.5); }) {
    as_printed[2] = analysis::variance_alone(up_to_rounded_pi::problem_of(paper.f_from_pi))[2].value;
  }
  auto priced = without_floors<double, 3>();
  priced.costs = costs;
  return {.number = number,
          .problem = on,
          .alone = alone,
          .alone_as_printed = as_printed,
          .parts = analysis::moments_of_parts(balance{}, on),
          .equal = allot(on, equal_fractions<double, 3>()),
          .by_variance = allot(on, inverse_to(as_printed, no_costs)),
          .by_cost_and_variance = allot(on, inverse_to(as_printed, costs)),
          .by_true_variance = allot(on, inverse_to(exact, no_costs)),
          .by_cost_and_true_variance = allot(on, inverse_to(exact, costs)),
          .least_multi_sample = allot(on, analysis::optimum(multi_sample_variance{}, on).alpha),
          .least_one_sample = allot(on, analysis::optimum(one_sample_variance{}, on).alpha),
          .cheapest_multi_sample = allot(on, analysis::optimum(multi_sample_variance{}, on, priced).alpha),
          .cheapest_one_sample = allot(on, analysis::optimum(one_sample_variance{}, on, priced).alpha)};
}

}  // namespace papers

#endif  // PHIMIS_EXAMPLES_PAPERS_VARIANCE_STUDY_HPP
