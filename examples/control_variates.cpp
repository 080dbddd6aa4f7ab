// SPDX-License-Identifier: MIT
// What do the pdfs gain as control variates, and fractions that are learnt together with them? Bias, also in standard
// errors, and N·MSE of 500 samples in 5 iterations on the examples of the Tsallis paper with whole Gaussians.
//
// test: --runs 300
#include "papers/tsallis_whole_line.hpp"

#include <phimis/analysis/joint_optimum.hpp>
#include <phimis/analysis/optimum.hpp>
#include <phimis/estimator/control_variates.hpp>
#include <phimis/solver/joint_minimiser.hpp>

#include <array>
#include <cmath>
#include <concepts>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <tuple>

namespace {

using oracle = phimis::analysis::problem<2>;
int runs = 10000;
bool as_promised = true;

/// A policy, or what makes one from exact integrals.
template <class Policy>
auto made(const Policy& policy, const oracle& exact) {
  if constexpr (std::invocable<Policy, const oracle&>) return policy(exact);
  if constexpr (!std::invocable<Policy, const oracle&>) return policy;
}

/// Of all runs. N·MSE must not be above the best that was measured before the library was written.
template <class Paper, class... Policies>
void measure(bool unbiased, double bound, const Policies&... policies) {
  static const oracle exact = Paper::exact();
  const double mu = exact.mean().value;
  const auto techniques = Paper::techniques();
  const auto fixed = std::tuple(made(policies, exact)...);
  phimis::moments<double> off, squares;
  for (int run = 1; run <= runs; ++run) {
    const phimis::integrate_options options{.seed = static_cast<std::uint64_t>(run)};
    const auto result = std::apply(
        [&](const auto&... each) { return phimis::integrate(Paper::f, techniques, options, each...); }, fixed);
    off.add(result.estimate - mu);
    squares.add(500 * (result.estimate - mu) * (result.estimate - mu));
  }
  const double z = off.mean / std::sqrt(off.variance() / runs);
  const double error = std::sqrt(squares.variance() / runs);
  std::printf(" %+.3f %% (%+.1f) | %.4g ± %.1g |", 100 * off.mean / mu, z, squares.mean, error);
  if ((unbiased && std::fabs(z) > 4.5) || squares.mean > bound + 4 * error) as_promised = false;
}

template <class... Policies>
void line(const char* name, bool unbiased, const std::array<double, 3>& bound, const Policies&... policies) {
  std::printf("| %s |", name);
  measure<papers::whole_1>(unbiased, bound[0], policies...);
  measure<papers::whole_2>(unbiased, bound[1], policies...);
  measure<papers::whole_3>(unbiased, bound[2], policies...);
  std::puts("");
}

}  // namespace

int main(int argc, char** argv) {
  using namespace phimis;
  if (argc == 3 && std::string_view(argv[1]) == "--runs") runs = std::atoi(argv[2]);
  if (runs < 2 || (argc != 1 && argc != 3)) return std::puts("usage: control_variates [--runs RUNS]   (10000)"), 2;
  const auto equal = fixed_rule<2>();
  const auto learnt = exact_rule(chi_squared{}, {.prior = 1});
  const auto joint = joint_rule<2>();
  const auto best = [](const oracle& on) {
    return fixed_rule<2>({.start = analysis::optimum(chi_squared{}, on).alpha});
  };
  std::puts("| | T1: bias | N·MSE | T2: bias | N·MSE | T3: bias | N·MSE |\n|---|---|---|---|---|---|---|");
  line("equal", true, {75.7, .1272, .2866}, equal);
  line("equal, pooled_control_variates", false, {66.9, .0155, .0622}, equal, pooled_control_variates{});
  line("equal, cross_fitted_control_variates", true, {66.9, .0155, .0622}, equal, cross_fitted_control_variates{});
  line("exact χ² optimum", true, {52.1, .0211, .0909}, best);
  line("χ²", true, {56.7, .0431, .137}, learnt);
  line("χ², by_count", true, {57.3, .0431, .137}, learnt, by_count{});
  line("χ², pooled", false, {53.8, .0236, .1013}, learnt, pooled{});
  line("χ², pooled_control_variates", false, {53.6, .0193, .08}, learnt, pooled_control_variates{});
  line("joint, progressive_control_variates", true, {75.7, .1272, .2866}, joint, progressive_control_variates{});
  line("joint, cross_fitted_control_variates", true, {57.3, .0211, .0622}, joint, cross_fitted_control_variates{});
  line("joint, pooled_control_variates", false, {53.6, .0155, .0622}, joint, pooled_control_variates{});
  return as_promised ? 0 : 1;
}
