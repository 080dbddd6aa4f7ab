// SPDX-License-Identifier: MIT
// Every function of core, called from device code. It is compiled, never run; functions that are not inlined compile sooner.
#include <phimis/core.hpp>

#include <type_traits>

using namespace phimis;  // a program, not a header

template <class Divergence>
__device__ __noinline__ double rules_of(const Divergence& divergence) {
  exact_minimiser<Divergence, fixed_table<double, 2, 32>> exact(divergence);
  exact.observe({1, {{1, 1}}, 1, 0});
  exact.update();
  exact.merge(exact);
  double sum = exact.fractions()[0] + exact.residual() + exact.evaluations() + infinite_at_zero(exact.divergence());
  if constexpr (!std::is_same<Divergence, multi_sample_variance>::value) {
    sum += score_at(divergence, 0.5).value + phi_at(divergence, 0.5);
  }
  if constexpr (has_exponent<Divergence>::value) {
    newton_raphson<Divergence> newton(divergence);
    newton.observe({1, {{1, 1}}, 1, 0});
    newton.update();
    newton.merge(newton);
    sum += newton.fractions()[0] + newton.divergence().exponent();
  }
  return sum;
}

template <class Divergence>
__device__ __noinline__ float of_three(const Divergence& divergence) {
  exact_minimiser<Divergence, fixed_table<float, 3, 32>> exact(divergence);
  exact.observe({1, {{1, 1, 2}}, 1, 0});
  exact.update();
  return exact.fractions()[0] + static_cast<float>(exact.gap());
}

template <class Divergence>
__device__ __noinline__ float streaming_by(const Divergence& divergence) {
  streaming_newton<Divergence, float, 5> rule(divergence);
  rule.observe({1, {{1, 1, 2, 3, 1}}, 1, 0});
  rule.update();
  rule.pool(rule.state(), 2);
  const auto kept = rule.state();
  rule.resume(kept);
  return rule.fractions()[0];
}

template <class Heuristic>
__device__ __noinline__ double contribution_by(const Heuristic& heuristic) {
  const fractions<double, 3> alpha = equal_fractions<double, 3>();
  return contribution(heuristic, 1, 1.0, alpha, {{1, 2, 3}});
}

template <class Rule>
__device__ __noinline__ double linear_by(Rule rule) {
  rule.observe({1, {{1, 2, 1}}, 1, 0});
  rule.observe({2, {{1, 1, 3}}, 1, 1});
  rule.update();
  rule.merge(rule);
  return rule.fractions()[0];
}

__global__ void all_of(double* out) {
  *out = rules_of(tsallis{1.5}) + rules_of(kullback_leibler{}) + rules_of(chi_squared{}) + rules_of(hellinger{}) +
         rules_of(one_sample_variance{}) + rules_of(multi_sample_variance{}) + rules_of(total_variation{}) +
         rules_of(pearson_vajda{3}) + rules_of(reversed<tsallis>{}) + rules_of(reversed<kullback_leibler>{}) +
         rules_of(reversed<hellinger>{}) + rules_of(reversed<total_variation>{}) +
         rules_of(reversed<pearson_vajda>{});
  *out += streaming_by(tsallis{1.5}) + streaming_by(kullback_leibler{}) + streaming_by(chi_squared{});
  *out += contribution_by(balance{}) + contribution_by(power{}) + contribution_by(power{3}) +
          contribution_by(cutoff{}) + contribution_by(maximum{});

  *out += static_cast<double>(of_three(tsallis{1.5}) + of_three(chi_squared{}) + of_three(multi_sample_variance{}) +
                              of_three(total_variation{}));
  *out += linear_by(linear_heuristic<double, 3>()) +
          linear_by(linear_heuristic<double, 3, negative_fractions::drop_most_negative>()) +
          linear_by(linear_heuristic<double, 3, negative_fractions::best_face, fixed_table<double, 3, 8>>());

  const fractions<float, 3> alpha = with_floors<float, 3>({{1, 2, 3}}, {{0.1f, 0.1f, 0.1f}});
  fixed_fractions<float, 3> fixed;
  fixed.observe({1, {{1, 1, 1}}, mixture(alpha, {{1, 1, 1}}), pick_technique(alpha, uniform<double>(1))});
  fixed.update();
  fixed.merge(fixed);
  *out += static_cast<double>(fixed.fractions()[0] + uniform<float>(1));
  *out += static_cast<double>(split_largest_remainder(alpha, 10)[0] + split_systematic(alpha, 10, 0.5)[0]);

  estimator<float, 3> estimate;
  estimate.add(0, 1.0f);
  estimate.merge(estimate);
  *out += static_cast<double>(estimate.estimate() + estimate.standard_error(sampling_model::one_sample) +
                              estimate.variance(sampling_model::multi_sample) + estimate.effective_sample_size());
}
