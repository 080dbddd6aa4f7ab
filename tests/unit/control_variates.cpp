// SPDX-License-Identifier: MIT
// control_coefficients.hpp, control_fit.hpp, control_variates.hpp, run_estimate.hpp
#include "catch.hpp"
#include "colour.hpp"
#include "random.hpp"
#include "two_triangles.hpp"

#include <phimis/estimator/control_variates.hpp>
#include <phimis/phimis.hpp>

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace {

using phimis::control_coefficients;
using phimis::control_fit;
using phimis::controlled_contribution;
using phimis::cross_fitted_control_variates;
using phimis::fractions;
using phimis::per_technique;
using phimis::pooled;
using phimis::pooled_control_variates;
using phimis::progressive_control_variates;
using phimis::sampling_model;
using phimis::shrinkage;

static_assert(phimis::detail::run_policy<pooled> && phimis::detail::run_policy<pooled_control_variates>);
static_assert(phimis::detail::run_policy<progressive_control_variates<>> &&
              phimis::detail::run_policy<cross_fitted_control_variates<phimis::square_root>>);
static_assert(!phimis::detail::run_policy<phimis::by_count> && !phimis::combination<pooled_control_variates>);

const double not_a_number = std::numeric_limits<double>::quiet_NaN();

struct falling {
  double pdf(double x) const { return x < 0 || x > 1 ? 0 : 2 * (1 - x); }
  template <phimis::uniform_source Next>
  double sample(Next&& next) const {
    return 1 - std::sqrt(1 - next());
  }
};
struct rising {
  double pdf(double x) const { return x < 0 || x > 1 ? 0 : 2 * x; }
  template <phimis::uniform_source Next>
  double sample(Next&& next) const {
    return std::sqrt(next());
  }
};
/// Uniform on a part of the line; what falls below `lost_below` is lost.
struct part {
  double lower, upper, lost_below = -1;
  double pdf(double x) const { return x < lower || x >= upper || x < lost_below ? 0 : 1 / (upper - lower); }
  template <phimis::uniform_source Next>
  double sample(Next&& next) const {
    return lower + (upper - lower) * next();
  }
};

const phimis::technique_set triangles(falling{}, rising{});
double bent(double x) { return x * x + 0.3; }
double in_span(double x) { return 2 * x + 3 * (1 - x); }  // p_2 + 1.5 p_1

/// The samples of one batch of the two triangles.
std::vector<phimis::drawn_sample<double, 2>> batch_of(double first, std::int64_t n, std::uint64_t seed) {
  random_numbers random(seed);
  std::vector<phimis::drawn_sample<double, 2>> all;
  phimis::draw_batch(bent, triangles, fractions<double, 2>{{first, 1 - first}}, {n}, phimis::balance{}, random,
                     [&](const auto& s) { all.push_back(s); });
  return all;
}

}  // namespace

TEST_CASE("A controlled contribution subtracts the pdfs and adds their integrals") {
  const control_coefficients<double, 2> control{{{2, -1}}, 2};
  CHECK(control.integral() == 1);
  // f − β·p = 5 − 2·1.5 + 1·0.5 = 2.5, over q = 2
  CHECK(controlled_contribution<double, 2>(control, 5, {{1.5, 0.5}}, 2) == Approx(1 + 1.25));
}

TEST_CASE("Where f is 0 the pdfs are subtracted like anywhere else") {
  const control_coefficients<double, 2> control{{{2, -1}}, 2};
  CHECK(controlled_contribution<double, 2>(control, 0, {{1.5, 0.5}}, 2) == Approx(1 - 1.25));
}

TEST_CASE("Without coefficients a contribution is f/q") {
  CHECK(controlled_contribution<double, 2>({}, 5, {{1.5, 0.5}}, 2) == 2.5);
  CHECK(controlled_contribution<double, 2>({}, 0, {{0, 0}}, 0) == 0);
}

TEST_CASE("A multiple of the fractions is no control variate") {
  const fractions<double, 2> alpha{{0.3, 0.7}};
  const control_coefficients<double, 2> control{{{3, 7}}, 1};
  for (const double x : {0.1, 0.5, 0.9}) {
    const auto pdfs = triangles.pdfs(x);
    const double q = phimis::mixture(alpha, pdfs);
    CHECK(controlled_contribution(control, bent(x), pdfs, q) == Approx(bent(x) / q).epsilon(1e-14));
  }
}

TEST_CASE("On one batch the fitted residuals have the mean 0: the estimate is the sum of the coefficients") {
  const auto batch = batch_of(0.4, 100, 1);
  control_fit<double, 2> fit(fractions<double, 2>{{0.4, 0.6}});
  for (const auto& s : batch) fit.add(s.value, s.observed.pdfs, s.observed.q);
  const auto control = fit.solve(shrinkage::off);
  CHECK(control.rank == 2);
  phimis::estimator<double, 2> all;
  for (const auto& s : batch) {
    all.add(s.observed.technique, controlled_contribution(control, s.value, s.observed.pdfs, s.observed.q));
  }
  CHECK(all.estimate() == Approx(control.integral()).epsilon(1e-13));
}

TEST_CASE("Batches with their own densities are fitted to any mixture: the weighted normal equations hold") {
  const fractions<double, 2> target{{0.8, 0.2}};
  control_fit<double, 2> fit(target);
  auto all = batch_of(0.5, 60, 2);
  const auto more = batch_of(0.2, 40, 3);
  all.insert(all.end(), more.begin(), more.end());
  for (const auto& s : all) fit.add(s.value, s.observed.pdfs, s.observed.q);
  const auto control = fit.solve(shrinkage::off);
  double slope[2] = {};
  double mean = 0;
  for (const auto& s : all) {
    const auto& p = s.observed.pdfs;
    const double rest = s.value - control.beta[0] * p[0] - control.beta[1] * p[1];
    for (int k = 0; k < 2; ++k) slope[k] += rest * p[k] / (s.observed.q * phimis::mixture(target, p));
    mean += rest / s.observed.q;
  }
  CHECK(std::fabs(slope[0]) < 1e-11);
  CHECK(std::fabs(slope[1]) < 1e-11);
  CHECK(std::fabs(mean) < 1e-11);  // Σ α_k p_k/p(α) = 1: no constant is needed
}

TEST_CASE("A fit needs four samples a technique, and none of them lost") {
  const auto batch = batch_of(0.5, 16, 4);
  control_fit<double, 2> fit(fractions<double, 2>{{0.5, 0.5}});
  for (int j = 0; j < 7; ++j)
    fit.add(batch[2 * static_cast<std::size_t>(j)].value, batch[2 * static_cast<std::size_t>(j)].observed.pdfs, 1);
  CHECK(fit.solve().rank == 0);
  CHECK(fit.solve().integral() == 0);
  fit.add(batch[15].value, batch[15].observed.pdfs, 1);
  CHECK(fit.samples() == control_fit<double, 2>::least);
  CHECK(fit.solve().rank == 2);
  fit.add(0, {{0, 0}}, 0);
  CHECK(fit.lost() == 1);
  CHECK(fit.solve().rank == 0);
}

TEST_CASE("Shrinkage is that of one sample: it fades as samples grow") {
  double before = 1;
  for (const int n : {20, 200, 2000}) {
    control_fit<double, 2> fit(fractions<double, 2>{{0.5, 0.5}});
    for (const auto& s : batch_of(0.5, n, 7)) fit.add(s.value, s.observed.pdfs, s.observed.q);
    const double away = std::fabs(fit.solve().beta[0] / fit.solve(shrinkage::off).beta[0] - 1);
    CHECK(away < 0.5 * before);
    before = away;
  }
  CHECK(before < 1e-3);
}

TEST_CASE("A technique that was hardly seen has no wild coefficient") {
  // Ten samples of one technique alone, where the other's density is all but 0: a one-sample draw that happens.
  control_fit<double, 2> fit(fractions<double, 2>{{0.5, 0.5}});
  random_numbers random(8);
  for (int j = 0; j < 10; ++j) {
    const double p2 = random.between(0.1, 0.2);
    fit.add(random.between(2, 4), {{random.over_decades(1e-20, 1e-6), p2}}, p2 / 2);
  }
  CHECK(std::fabs(fit.solve(shrinkage::off).beta[0]) > 1e5);
  CHECK(std::fabs(fit.solve().beta[0]) < 50);
  CHECK(std::fabs(fit.solve().beta[1]) < 50);
}

TEST_CASE("A technique without a fraction is no control variate") {
  control_fit<double, 2> fit(fractions<double, 2>{{1, 0}});
  for (const auto& s : batch_of(0.5, 40, 5)) fit.add(s.value, s.observed.pdfs, s.observed.q);
  CHECK(fit.solve().rank == 1);
  CHECK(fit.solve().beta[1] == 0);
}

TEST_CASE("A fit leaves out what is no density and counts a value that is not finite as 0") {
  control_fit<double, 2> fit(fractions<double, 2>{{0.5, 0.5}});
  fit.add(1, {{not_a_number, 1}}, 1);
  fit.add(1, {{-1, 2}}, 1);
  fit.add(1, {{1, 1}}, std::numeric_limits<double>::infinity());
  fit.add(1, {{1, 1}}, 0);
  CHECK(fit.samples() == 0);
  CHECK(fit.lost() == 0);
  for (const auto& s : batch_of(0.5, 20, 6)) fit.add(s.value, s.observed.pdfs, s.observed.q);
  auto zero = fit;
  fit.add(not_a_number, {{1, 1}}, 1);
  zero.add(0, {{1, 1}}, 1);
  CHECK(fit.solve().beta[0] == zero.solve().beta[0]);
}

TEMPLATE_TEST_CASE("Where the pdfs span f the first split iteration, and all samples, give the integral exactly", "",
                   pooled_control_variates, cross_fitted_control_variates<>) {
  for (const auto model : {sampling_model::multi_sample, sampling_model::one_sample}) {
    const auto result = phimis::integrate(in_span, triangles, {.budget = 60, .iterations = 1, .model = model},
                                          phimis::fixed_rule<2>(), TestType{});
    CHECK(result.estimate == Approx(2.5).epsilon(1e-14));
    CHECK(result.standard_error < 1e-14);
    CHECK(result.control.rank == 2);
  }
}

TEST_CASE(
    "The first iteration of the progressive form is plain, later ones have the coefficients of what came before") {
  const auto result = phimis::integrate(in_span, triangles, {.budget = 60, .iterations = 3, .growth = 1}, phimis::fixed_rule<2>(),
                                        progressive_control_variates{});
  const auto plain = phimis::integrate(in_span, triangles, {.budget = 60, .iterations = 3, .growth = 1}, phimis::fixed_rule<2>());
  CHECK(result.trace[0].estimate == Approx(plain.trace[0].estimate).epsilon(1e-14));
  CHECK(result.trace[0].standard_error == Approx(plain.trace[0].standard_error).epsilon(1e-12));
  CHECK(result.trace[1].estimate == Approx(2.5).epsilon(1e-13));
  CHECK(result.trace[2].standard_error < 1e-13);
}

TEST_CASE("Each half of the first iteration is a batch of its own, with the control variates of the other") {
  // 5 and 15 of 20 samples, in turns: 3 and 7, 2 and 8.
  const phimis::rule_options<double, 2> uneven{.start = {{0.25, 0.75}}};
  std::vector<phimis::drawn_sample<double, 2>> samples;
  random_numbers source(9);
  phimis::draw_batch(bent, triangles, uneven.start, {20}, phimis::balance{}, source,
                     [&](const auto& s) { samples.push_back(s); });
  const fractions<double, 2> alpha[2] = {{{0.3, 0.7}}, {{0.2, 0.8}}};
  control_fit<double, 2> fit[2] = {control_fit<double, 2>(uneven.start), control_fit<double, 2>(uneven.start)};
  for (std::size_t j = 0; j < 20; ++j) {
    const auto& p = samples[j].observed.pdfs;
    fit[1 - j % 2].add(samples[j].value, p, phimis::mixture(alpha[j % 2], p));
  }
  double wanted = 0;
  for (std::size_t j = 0; j < 20; ++j) {
    const auto& p = samples[j].observed.pdfs;
    wanted += controlled_contribution(fit[j % 2].solve(), samples[j].value, p, phimis::mixture(alpha[j % 2], p)) / 20;
  }
  random_numbers again(9);
  const auto result = phimis::integrate(bent, triangles, {.budget = 20, .iterations = 1}, phimis::fixed_rule(uneven),
                                        cross_fitted_control_variates{}, again);
  CHECK(result.trace[0].counts[0] == 5);
  CHECK(result.estimate == Approx(wanted).epsilon(1e-13));
}

TEST_CASE("An iteration with a single sample of a technique is not split") {
  // 10 samples at .95 and .05: nine and one.
  const phimis::rule_options<double, 2> uneven{.start = {{0.95, 0.05}}, .floors = {{0, 0}}};
  const phimis::integrate_options options{.budget = 40, .iterations = 4};
  const auto split =
      phimis::integrate(bent, triangles, options, phimis::fixed_rule(uneven), cross_fitted_control_variates{});
  const auto whole =
      phimis::integrate(bent, triangles, options, phimis::fixed_rule(uneven), progressive_control_variates{});
  CHECK(split.trace[0].counts[1] == 1);
  CHECK(split.estimate == whole.estimate);
  CHECK(split.standard_error == whole.standard_error);
}

TEST_CASE("The combination within a policy is that of its iterations") {
  const phimis::integrate_options options{.budget = 100, .iterations = 4};
  const auto fixed = phimis::fixed_rule<2>();
  const auto last = phimis::integrate(bent, triangles, options, fixed,
                                      progressive_control_variates{phimis::fixed_weights({0, 0, 0, 1})});
  CHECK(last.estimate == Approx(last.trace[3].estimate).epsilon(1e-14));
  CHECK(last.standard_error == Approx(last.trace[3].standard_error).epsilon(1e-14));
}

TEST_CASE("With too few samples control variates are off, and the estimate is what it is without them") {
  const phimis::integrate_options options{.budget = 6, .iterations = 2};
  const auto fixed = phimis::fixed_rule<2>();
  const auto plain = phimis::integrate(bent, triangles, options, fixed);
  const auto in_pool = phimis::integrate(bent, triangles, options, fixed, pooled{});
  for (const double estimate :
       {phimis::integrate(bent, triangles, options, fixed, progressive_control_variates{phimis::by_count{}}).estimate,
        phimis::integrate(bent, triangles, options, fixed, pooled_control_variates{}).estimate}) {
    CHECK(estimate == Approx(plain.estimate).epsilon(1e-14));
  }
  const auto controlled = phimis::integrate(bent, triangles, options, fixed, pooled_control_variates{});
  CHECK(controlled.control.rank == 0);
  CHECK(controlled.standard_error == Approx(in_pool.standard_error).epsilon(1e-14));
}

TEST_CASE("A lost sample, which shows that a pdf is defective, turns control variates off") {
  const phimis::technique_set losing(part{0, 1, 0.25}, part{0.25, 1, 0.25});
  const auto f = [](double x) { return x < 0.25 ? 0.0 : x; };
  const phimis::integrate_options options{.budget = 200, .iterations = 4};
  const auto fixed = phimis::fixed_rule<2>();
  const auto controlled = phimis::integrate(f, losing, options, fixed, pooled_control_variates{});
  CHECK(controlled.control.rank == 0);
  CHECK(controlled.estimate ==
        Approx(phimis::integrate(f, losing, options, fixed, pooled{}).estimate).epsilon(1e-14));
}

TEMPLATE_TEST_CASE("A technique that is given up leaves the estimate right, with a part of the line of its own", "",
                   pooled_control_variates, progressive_control_variates<>, cross_fitted_control_variates<>) {
  // f is 0 where only the second technique samples; the second has no fraction and must not be subtracted.
  const phimis::technique_set parts(part{0, 1}, part{1, 2}, part{0, 0.5});
  const auto f = [](double x) { return x < 1 ? x : 0.0; };
  const phimis::rule_options<double, 3> two_of_three{.start = {{0.5, 0, 0.5}}, .floors = {{0, 0, 0}}};
  const auto result =
      phimis::integrate(f, parts, {.budget = 4000, .iterations = 4}, phimis::fixed_rule(two_of_three), TestType{});
  CHECK(std::fabs(result.estimate - 0.5) < 5 * result.standard_error);
  CHECK(result.control.beta[1] == 0);
}

TEST_CASE("Duplicate techniques change nothing but how coefficients are shared") {
  const phimis::technique_set doubled(falling{}, rising{}, rising{});
  const phimis::rule_options<double, 3> as_two{.start = {{0.5, 0.25, 0.25}}, .floors = {{0, 0, 0}}};
  const phimis::integrate_options options{.budget = 400, .iterations = 2, .growth = 1, .seed = 3};
  const auto three = phimis::integrate(bent, doubled, options, phimis::fixed_rule(as_two), pooled_control_variates{});
  const auto two = phimis::integrate(bent, triangles, options, phimis::fixed_rule<2>(), pooled_control_variates{});
  CHECK(three.control.rank == 2);
  CHECK(std::fabs(three.estimate - two.estimate) < 0.01 * two.standard_error);  // two are shrunk less than one
  CHECK(three.control.beta[1] == Approx(three.control.beta[2]).epsilon(1e-10));
}

TEST_CASE("A colour has its own coefficients in each component") {
  const auto in_span_of_all = [](double x) { return colour<double>{{in_span(x), 2 * x, -2 * in_span(x)}}; };
  const phimis::integrate_options options{.budget = 200, .iterations = 2};
  const auto exact =
      phimis::integrate(in_span_of_all, triangles, options, phimis::fixed_rule<2>(), pooled_control_variates{});
  const double wanted[] = {2.5, 1, -5};
  for (int i = 0; i < 3; ++i) {
    CHECK(exact.estimate[i] == Approx(wanted[i]).epsilon(1e-13));
    CHECK(exact.standard_error[i] < 1e-13);
  }
  // One component that the pdfs do not span: the shrinkage, by the luminance, is that of all.
  const auto f = [](double x) { return colour<double>{{in_span(x), bent(x), 0}}; };
  const auto result = phimis::integrate(f, triangles, options, phimis::fixed_rule<2>(), pooled_control_variates{});
  const auto only = phimis::integrate(bent, triangles, options, phimis::fixed_rule<2>(), pooled_control_variates{});
  CHECK(result.estimate[0] == Approx(2.5).epsilon(1e-4));
  CHECK(result.estimate[1] == Approx(only.estimate).epsilon(1e-4));
  CHECK(result.standard_error[1] == Approx(only.standard_error).epsilon(0.01));
  CHECK(result.estimate[2] == 0);
}

TEMPLATE_TEST_CASE("No scale of the integrand changes a controlled estimate by more than its scale", "",
                   pooled_control_variates, progressive_control_variates<>, cross_fitted_control_variates<>) {
  const phimis::integrate_options options{.budget = 200, .iterations = 4};
  const auto one = phimis::integrate(bent, triangles, options, TestType{});
  for (const double unit : {1e-300, 1e300}) {
    const auto scaled =
        phimis::integrate([unit](double x) { return unit * bent(x); }, triangles, options, TestType{});
    CHECK(scaled.estimate / unit == Approx(one.estimate).epsilon(1e-10));
    CHECK(scaled.standard_error / unit == Approx(one.standard_error).epsilon(1e-8));
  }
}

TEMPLATE_TEST_CASE("Values that are not finite are counted and count as 0 with control variates too", "",
                   pooled_control_variates, progressive_control_variates<>, cross_fitted_control_variates<>) {
  const auto defect = [](double x) { return x > 0.9 ? not_a_number : bent(x); };
  const auto zero = [](double x) { return x > 0.9 ? 0.0 : bent(x); };
  const phimis::integrate_options options{.budget = 200, .iterations = 4};
  const auto fixed = phimis::fixed_rule<2>();
  const auto with_defect = phimis::integrate(defect, triangles, options, fixed, TestType{});
  const auto with_zero = phimis::integrate(zero, triangles, options, fixed, TestType{});
  CHECK(with_defect.nonfinite > 0);
  CHECK(with_defect.estimate == with_zero.estimate);
}

TEMPLATE_TEST_CASE("An integrand that is 0 everywhere has the estimate 0 and an unknown standard error", "",
                   pooled_control_variates, progressive_control_variates<>, cross_fitted_control_variates<>) {
  const auto result =
      phimis::integrate([](double) { return 0.0; }, triangles, {.budget = 100, .iterations = 4}, TestType{});
  CHECK(result.estimate == 0);
  CHECK(result.standard_error == std::numeric_limits<double>::infinity());
  CHECK(result.status == phimis::integration_status::all_zero);
}

TEST_CASE("The standard error of a fit to its own samples counts its coefficients") {
  phimis::estimator<double, 3> four;
  for (const double y : {1.0, 2.0, 3.0, 5.0}) four.add(0, y);
  const double plain = four.standard_error(sampling_model::one_sample);
  CHECK(phimis::fitted_standard_error(four, sampling_model::one_sample, 0) == plain);
  CHECK(phimis::fitted_standard_error(four, sampling_model::one_sample, 1) == plain);
  CHECK(phimis::fitted_standard_error(four, sampling_model::one_sample, 3) == Approx(std::sqrt(3.0) * plain));
  CHECK(phimis::fitted_standard_error(four, sampling_model::one_sample, 4) ==
        std::numeric_limits<double>::infinity());
}
