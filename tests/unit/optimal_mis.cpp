// SPDX-License-Identifier: MIT
#include "catch.hpp"
#include "colour.hpp"
#include "two_triangles.hpp"

#include <phimis/estimator/control_variates.hpp>
#include <phimis/estimator/optimal_mis.hpp>
#include <phimis/phimis.hpp>

#include <cmath>
#include <limits>
#include <random>
#include <type_traits>
#include <vector>

namespace {

using phimis::control_coefficients;
using phimis::fractions;
using phimis::optimal_form;
using phimis::optimal_mis;
using phimis::sampling_model;

static_assert(std::is_trivially_copyable_v<optimal_mis<double, 3>>, "a pixel's state");

constexpr double infinity = std::numeric_limits<double>::infinity();
double bent(double x) { return x * x + 0.3; }
double half_empty(double x) { return x < 0.5 ? 0 : x; }

/// Optimal MIS as the paper has it, by the 2×2 system of the technique matrix and the contribution vector.
template <class F>
double by_hand(const F& f, const std::vector<phimis::observation<double, 2>>& samples, double first) {
  double a[2][2] = {};
  double b[2] = {};
  for (const auto& s : samples) {
    const double balance[2] = {first * s.pdfs[0] / s.q, (1 - first) * s.pdfs[1] / s.q};
    const double sampled = (s.technique == 0 ? first : 1 - first) * s.pdfs[s.technique];
    const double own = balance[s.technique];
    for (int k = 0; k < 2; ++k) {
      for (int l = 0; l < 2; ++l) a[k][l] += balance[k] * balance[l];
      b[k] += f(s) / sampled * own * balance[k];
    }
  }
  const double det = a[0][0] * a[1][1] - a[0][1] * a[1][0];
  // In units of balance weights the coefficients are β_k/α_k.
  return first * (b[0] * a[1][1] - b[1] * a[0][1]) / det + (1 - first) * (a[0][0] * b[1] - a[1][0] * b[0]) / det;
}

optimal_mis<double, 2> direct(const std::vector<phimis::observation<double, 2>>& samples, double first) {
  optimal_mis<double, 2> sum(fractions<double, 2>{{first, 1 - first}});
  for (const auto& s : samples) sum.add(s.technique, s.f, s.pdfs);
  return sum;
}

}  // namespace

TEST_CASE("The direct form solves the paper's linear system") {
  for (const double first : {0.5, 0.2}) {
    const auto samples = two_triangles::observe(bent, first, 50, 1);
    const auto value = [](const auto& s) { return s.f; };
    CHECK(direct(samples, first).estimate() == Approx(by_hand(value, samples, first)).epsilon(1e-12));
  }
}

TEST_CASE("Samples with f = 0 enter the technique matrix") {
  const auto samples = two_triangles::observe(half_empty, 0.5, 50, 2);
  const auto value = [](const auto& s) { return s.f; };
  std::vector<phimis::observation<double, 2>> positive;
  for (const auto& s : samples) {
    if (s.f > 0) positive.push_back(s);
  }
  REQUIRE(positive.size() < samples.size());
  CHECK(direct(samples, 0.5).estimate() == Approx(by_hand(value, samples, 0.5)).epsilon(1e-12));
  CHECK(std::fabs(direct(positive, 0.5).estimate() - by_hand(value, samples, 0.5)) > 0.01);
}

TEST_CASE(
    "The direct form is the regression of all samples on the pdfs: pooled control variates at fixed fractions") {
  const phimis::technique_set techniques(phimis::gaussian(2, 1), phimis::gaussian(8, 2));
  const auto f = [](double x) { return x > 0 && x < 9 ? std::sqrt(x) + std::sin(x) : 0; };
  optimal_mis<double, 2> streamed;
  std::mt19937_64 engine(1);
  auto next = [&] { return phimis::uniform(engine()); };
  for (int b = 0; b < 5; ++b) {
    phimis::draw_batch(f, techniques, phimis::equal_fractions<double, 2>(), {100}, phimis::balance{}, next,
                       [&](const auto& s) { streamed.add(s.observed.technique, s.value, s.observed.pdfs); });
  }
  const phimis::integrate_options options{.growth = 1, .seed = 1};
  const auto shrunk =
      phimis::integrate(f, techniques, options, phimis::fixed_rule<2>(), phimis::pooled_control_variates{});
  const auto pooled = phimis::integrate(f, techniques, options, phimis::fixed_rule<2>(),
                                        phimis::pooled_control_variates{phimis::shrinkage::off});
  CHECK(streamed.samples() == pooled.samples);
  CHECK(streamed.estimate() == Approx(pooled.estimate).epsilon(1e-12));
  for (int k = 0; k < 2; ++k) CHECK(streamed.coefficients().beta[k] == Approx(pooled.control.beta[k]).epsilon(1e-12));
  // The spread of all residuals, and that within each technique: equal up to the mean residual of a technique.
  CHECK(streamed.standard_error(sampling_model::multi_sample) == Approx(pooled.standard_error).epsilon(0.01));
  // Shrinkage is that of one sample among 500.
  CHECK(std::fabs(streamed.estimate() - shrunk.estimate) < 0.01 * shrunk.standard_error);
  CHECK(streamed.coefficients().beta[0] == Approx(shrunk.control.beta[0]).epsilon(0.01));
  CHECK(streamed.coefficients().beta[0] != shrunk.control.beta[0]);
}

TEST_CASE("The standard error of the direct form counts its coefficients") {
  const auto samples = two_triangles::observe(bent, 0.5, 12, 12);
  const auto sum = direct(samples, 0.5);
  const auto control = sum.coefficients();
  double squares = 0;
  for (const auto& s : samples) {
    const double rest = (s.f - control.beta[0] * s.pdfs[0] - control.beta[1] * s.pdfs[1]) / s.q;
    squares += rest * rest;
  }
  CHECK(sum.standard_error(sampling_model::one_sample) == Approx(std::sqrt(squares / (12 * 10))).epsilon(1e-12));
}

TEST_CASE("Optimal weights sum to one, and weigh contributions into the estimate") {
  const double first = 0.3;
  const fractions<double, 2> alpha{{first, 1 - first}};
  const auto samples = two_triangles::observe(bent, first, 100, 3);
  const auto sum = direct(samples, first);
  const auto control = sum.coefficients();
  double estimate = 0;
  for (const auto& s : samples) {
    const double w[2] = {phimis::optimal_weight(0, control, s.f, alpha, s.pdfs),
                         phimis::optimal_weight(1, control, s.f, alpha, s.pdfs)};
    CHECK(w[0] + w[1] == Approx(1).epsilon(1e-13));
    estimate += w[s.technique] * s.f / (100 * alpha[s.technique] * s.pdfs[s.technique]);
  }
  CHECK(estimate == Approx(sum.estimate()).epsilon(1e-12));
}

TEST_CASE("Without coefficients the optimal weight is that of the balance heuristic") {
  const fractions<double, 2> alpha{{0.3, 0.7}};
  const phimis::per_technique<double, 2> pdfs{{2, 0.5}};
  CHECK(phimis::optimal_weight(0, {}, 4.0, alpha, pdfs) == Approx(phimis::balance{}(0, alpha, pdfs)).epsilon(1e-15));
}

TEST_CASE("The progressive form serves a batch with the coefficients of those before") {
  const fractions<double, 2> alpha{{0.5, 0.5}};
  const auto earlier = two_triangles::observe(bent, 0.5, 40, 4);
  const auto later = two_triangles::observe(bent, 0.5, 40, 5);
  optimal_mis<double, 2> progressive(alpha, optimal_form::progressive);
  phimis::estimator<double, 2> wanted;
  for (const auto& s : earlier) {
    progressive.add(s.technique, s.f, s.pdfs);
    wanted.add(s.technique, s.f / s.q);
  }
  CHECK(progressive.coefficients().rank == 0);
  progressive.update();
  const auto control = progressive.coefficients();
  phimis::control_fit<double, 2> fit(alpha);
  for (const auto& s : earlier) fit.add(s.f, s.pdfs, s.q);
  CHECK(control.beta[0] == fit.solve().beta[0]);
  for (const auto& s : later) {
    progressive.add(s.technique, s.f, s.pdfs);
    wanted.add(s.technique, phimis::controlled_contribution(control, s.f, s.pdfs, s.q));
  }
  CHECK(progressive.coefficients().beta[0] == control.beta[0]);
  CHECK(progressive.estimate() == Approx(wanted.estimate()).epsilon(1e-14));
  CHECK(progressive.standard_error(sampling_model::one_sample) ==
        Approx(wanted.standard_error(sampling_model::one_sample)).epsilon(1e-12));
}

TEST_CASE("States of Optimal MIS merge") {
  const auto samples = two_triangles::observe(bent, 0.5, 60, 6);
  const auto all = direct(samples, 0.5);
  auto merged = direct({samples.begin(), samples.begin() + 13}, 0.5);
  merged.merge(direct({samples.begin() + 13, samples.end()}, 0.5));
  CHECK(merged.samples() == 60);
  CHECK(merged.estimate() == Approx(all.estimate()).epsilon(1e-13));
  CHECK(merged.standard_error(sampling_model::multi_sample) ==
        Approx(all.standard_error(sampling_model::multi_sample)).epsilon(1e-12));
}

TEST_CASE("With too few samples, and after a lost one, Optimal MIS is the balance heuristic") {
  const auto few = two_triangles::observe(bent, 0.5, 6, 7);
  phimis::estimator<double, 2> balance;
  for (const auto& s : few) balance.add(s.technique, s.f / s.q);
  CHECK(direct(few, 0.5).estimate() == Approx(balance.estimate()).epsilon(1e-14));
  CHECK(direct(few, 0.5).standard_error(sampling_model::multi_sample) ==
        Approx(balance.standard_error(sampling_model::multi_sample)).epsilon(1e-14));

  auto lost = direct(two_triangles::observe(bent, 0.5, 40, 8), 0.5);
  CHECK(lost.coefficients().rank == 2);
  lost.add(0, 0, {{0, 0}});
  CHECK(lost.coefficients().rank == 0);
  CHECK(lost.samples() == 41);
  auto merged = direct(two_triangles::observe(bent, 0.5, 40, 8), 0.5);
  merged.merge(lost);
  CHECK(merged.coefficients().rank == 0);

  CHECK(optimal_mis<double, 2>().estimate() == 0);
  CHECK(optimal_mis<double, 2>().standard_error(sampling_model::multi_sample) == infinity);
}

TEST_CASE("Optimal MIS counts a value that is not finite, as 0") {
  const auto samples = two_triangles::observe(bent, 0.5, 40, 9);
  auto defect = direct(samples, 0.5);
  auto zero = direct(samples, 0.5);
  defect.add(0, infinity, {{1, 1}});
  zero.add(0, 0, {{1, 1}});
  CHECK(defect.nonfinite() == 1);
  CHECK(zero.nonfinite() == 0);
  CHECK(defect.estimate() == zero.estimate());
}

TEST_CASE("Where the pdfs span the integrand Optimal MIS finds it from any samples") {
  const auto span = [](double x) { return 2 * two_triangles::p1(x) - 0.5 * two_triangles::p2(x); };
  const auto sum = direct(two_triangles::observe(span, 0.5, 20, 10), 0.5);
  CHECK(sum.estimate() == Approx(1.5).epsilon(1e-13));
  CHECK(sum.standard_error(sampling_model::multi_sample) < 1e-13);
}

TEST_CASE("Optimal MIS of three techniques, two of them the same, and of colours") {
  const auto samples = two_triangles::observe(bent, 0.5, 60, 11);
  optimal_mis<colour<float>, 3> sum(fractions<double, 3>{{0.5, 0.25, 0.25}});
  for (const auto& s : samples) {
    const float f = static_cast<float>(s.f);
    sum.add(s.technique, {{f, 2 * f, 0}}, {{s.pdfs[0], s.pdfs[1], s.pdfs[1]}});
  }
  CHECK(sum.coefficients().rank == 2);
  const double wanted = direct(samples, 0.5).estimate();
  CHECK(static_cast<double>(sum.estimate()[0]) == Approx(wanted).epsilon(1e-5));
  CHECK(static_cast<double>(sum.estimate()[1]) == Approx(2 * wanted).epsilon(1e-5));
  CHECK(sum.estimate()[2] == 0);
}
