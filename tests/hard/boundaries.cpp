// SPDX-License-Identifier: MIT
// Optima on the boundary of the simplex: at a vertex, on an edge, at a floor, with and without a multiplier.
//
// Where the densities p_k/p_1 rise, and f/p_1 falls, technique 1 alone is best for every divergence: p_1 has its mass where
// f/p_1 is larger, s does not decrease, so E_1[s] >= E_k[s] (Chebyshev).
#include "any_rule.hpp"
#include "cases.hpp"
#include "catch.hpp"

#include <phimis/analysis/optimum.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace {

using namespace hard;
using phimis::control_variate;
using phimis::rule_status;

const phimis::technique_set pair(power_of{-1}, power_of{1});
const phimis::technique_set powers(power_of{0}, power_of{1}, power_of{2});

/// f/p_1 of the pair and of the powers falls.
double falling(double x) { return (1 - x) * (1 - x) + 0.1 * (1 - x); }
/// f/p_2 of the pair and f/p_3 of the powers rises.
double rising(double x) { return x * x * x; }

/// V[F], which has no score and so no Chebyshev, against the oracle from the same start.
template <class Real, int M, class Integrand, class Techniques>
void check_variance(const Integrand& f, const Techniques& techniques, const phimis::rule_options<Real, M>& options,
                    control_variate variate) {
  const phimis::analysis::problem on(f, techniques, phimis::interval(0, 1));
  auto same_start = phimis::without_floors<double, M>();
  double sum = 0;
  for (const Real a : options.start) sum += static_cast<double>(a);  // thirds of a float are not those of a double
  for (int k = 0; k < M; ++k) {
    same_start.start[k] = static_cast<double>(options.start[k]) / sum;
    same_start.floors[k] = static_cast<double>(options.floors[k]);
  }
  const auto wanted = phimis::analysis::optimum(phimis::multi_sample_variance{}, on, same_start);
  auto rule = exact_rules<Real, M>(options, variate).back();
  CHECK(teach(rule, quadrature<Real>(f, techniques, {0, 1}, 3)) == rule_status::local);
  CAPTURE(M, static_cast<int>(variate), options.start[0], options.start[1], rule.fractions()[0], wanted.alpha[0]);
  // All these are at bounds: what is left is the rounding of 1 less the floors.
  CHECK(wanted.error <= 4 * std::numeric_limits<double>::epsilon());
  CHECK(apart(rule.fractions(), wanted.alpha) <= wanted.error + std::numeric_limits<Real>::epsilon());
}

template <class Real, int M, class Integrand, class Techniques>
void check_vertex(const Integrand& f, const Techniques& techniques, int vertex) {
  const auto all = quadrature<Real>(f, techniques, {0, 1}, 3);
  for (int from = -1; from < M; ++from) {
    auto start = phimis::equal_fractions<Real, M>();
    for (int k = 0; k < M && from >= 0; ++k) start[k] = k == from ? Real(1) : Real(0);
    for (const auto variate : {control_variate::on, control_variate::off}) {
      for (auto& rule : exact_rules<Real, M>(starting_at<Real, M>(start), variate)) {
        if (rule.divergence()->variance) continue;  // has no score; below
        CAPTURE(rule.name(), from, static_cast<int>(variate));
        CHECK(teach(rule, all) == rule_status::updated);
        CHECK(rule.fractions()[vertex] == 1);
      }
      check_variance<Real, M>(f, techniques, starting_at<Real, M>(start), variate);
    }
  }
}

}  // namespace

TEMPLATE_TEST_CASE("The vertex of two techniques is the optimum of every divergence, and is found from every start",
                   "", float, double) {
  check_vertex<TestType, 2>(falling, pair, 0);
  check_vertex<TestType, 2>(rising, pair, 1);
}

TEMPLATE_TEST_CASE("The vertex of three techniques is the optimum of every divergence, and is found from every start",
                   "", float, double) {
  check_vertex<TestType, 3>(falling, powers, 0);
  check_vertex<TestType, 3>(rising, powers, 2);
}

TEMPLATE_TEST_CASE("Rules that go by steps go to the vertex and stay", "", float, double) {
  const auto all = quadrature<TestType>(falling, pair, {0, 1}, 3);
  for (auto& rule : every_rule<TestType, 2>(phimis::without_floors<TestType, 2>())) {
    if (rule.how() != way::by_steps) continue;
    CAPTURE(rule.name());
    // The printed step may jump over the simplex forever.
    if (rule.name().find("printed") != std::string::npos) {
      teach(rule, all);
      continue;
    }
    teach(rule, all, 100);
    CHECK(rule.fractions()[0] >= 1 - TestType(1e-3));
  }
}

TEMPLATE_TEST_CASE("At the edge with floors the floor is hit exactly, by every exact rule", "", float, double) {
  auto options = phimis::without_floors<TestType, 3>();
  options.floors = {{TestType(0.01), TestType(0.05), TestType(0.002)}};
  const auto all = quadrature<TestType>(falling, powers, {0, 1}, 3);
  for (auto& rule : exact_rules<TestType, 3>(options, control_variate::off)) {
    if (rule.divergence()->variance) continue;  // below
    CAPTURE(rule.name());
    CHECK(teach(rule, all) == rule_status::updated);
    CHECK(rule.fractions()[1] == options.floors[1]);
    CHECK(rule.fractions()[2] == options.floors[2]);
  }
  check_variance<TestType, 3>(falling, powers, options, control_variate::off);
}

TEMPLATE_TEST_CASE("On an edge where the multiplier is 0 the third technique has nothing", "", float, double) {
  // f = ½p_1 + ½p_3: t = 1 everywhere and all G are equal, whatever the divergence.
  const auto f = [](double x) { return 0.5 + 1.5 * x * x; };
  const auto all = quadrature<TestType>(f, powers, {0, 1}, 3);
  // t is 1 up to its rounding ε, and α up to that of t over the least singular value of the pdfs, .1; a kink is rounded off
  // within 1e-6; of |t − 1|³, whose score is flat, t is 1 up to √ε.
  const double epsilon = std::numeric_limits<TestType>::epsilon();
  for (auto& rule : exact_rules<TestType, 3>(phimis::without_floors<TestType, 3>())) {
    const auto status = teach(rule, all);
    CAPTURE(rule.name(), rule.fractions()[0], rule.fractions()[1], rule.fractions()[2]);
    CHECK((status == rule_status::updated || status == rule_status::local));
    const bool flat = rule.name().find("Vajda 3") != std::string::npos;
    const double tolerance = 30 * std::max(flat ? std::sqrt(epsilon) : 10 * epsilon, 1e-7);
    CHECK(apart(rule.fractions(), phimis::fractions<double, 3>{{0.5, 0, 0.5}}) <= tolerance);
  }
}

TEST_CASE("V[F] near a vertex is that of the oracle") {
  const phimis::analysis::problem on(falling, pair, phimis::interval(0, 1));
  for (const double start : {0.0, 0.5, 1.0}) {
    const auto options = starting_at<double, 2>({{start, 1 - start}});
    auto rule = exact_rules<double, 2>(options, control_variate::off).back();
    CHECK(teach(rule, quadrature(falling, pair, {0, 1}, 3)) == rule_status::local);
    CHECK(apart(rule.fractions(), multi_sample_variance().optimum(on, options).alpha) <= 1e-9);
  }
}
