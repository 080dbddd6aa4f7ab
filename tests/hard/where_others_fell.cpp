// SPDX-License-Identifier: MIT
// Defects of other implementations, each as a test of what must hold here.
#include "any_rule.hpp"
#include "cases.hpp"
#include "catch.hpp"
#include "random.hpp"

#include <phimis/core/moments.hpp>
#include <phimis/estimator/control_variates.hpp>
#include <phimis/integrate.hpp>
#include <phimis/solver/minimise.hpp>
#include <phimis/technique/gaussian.hpp>

#include <Eigen/Core>

#include <cmath>
#include <cstdint>
#include <limits>

namespace {

using namespace hard;
using phimis::control_variate;
using phimis::rule_status;

const phimis::technique_set pair(power_of{0}, power_of{1});
const phimis::technique_set powers(power_of{0}, power_of{1}, power_of{2});

double f(double x) { return 0.3 + x * x; }

/// Whether a run has no number that is none.
template <class Run>
bool sound(const Run& run) {
  bool good = phimis::is_finite(run.estimate);
  for (const auto& line : run.trace) good = good && phimis::is_finite(line.estimate);
  for (const double a : run.fractions) good = good && phimis::is_density(a);
  return good;
}

}  // namespace

TEST_CASE("Control variates are subtracted where f is 0, too: left out they would be a bias") {
  const auto half = [](double x) { return x < 0.5 ? 0 : x; };  // ∫ = 3/8
  for (const auto model : {phimis::sampling_model::multi_sample, phimis::sampling_model::one_sample}) {
    phimis::moments<double> estimates, last;
    random_numbers random(1);
    const auto next = [&] { return random(); };
    const phimis::integrate_options options{.budget = 120, .iterations = 3, .growth = 1, .model = model};
    for (int i = 0; i < 2000; ++i) {
      const auto run = phimis::integrate(half, pair, options, next, phimis::fixed_rule<2>(),
                                         phimis::cross_fitted_control_variates{phimis::by_count{}});
      estimates.add(run.estimate);
      last.add(run.trace.back().estimate);
    }
    // |z| < 5: false alarm 6e-7. Samples with f = 0 are 3/8 of all: without them it is off by several per cent, z = 50.
    CHECK(std::fabs(estimates.mean - 0.375) <= 5 * std::sqrt(estimates.variance() / 2000));
    CHECK(std::fabs(last.mean - 0.375) <= 5 * std::sqrt(last.variance() / 2000));
  }
}

TEST_CASE("An iteration without variance has weight and no NaN in every combination") {
  const auto mix = [](double x) { return 0.5 + x; };  // p(α) at equal counts
  const auto check = [&](const auto& combination) {
    const auto run = phimis::integrate(mix, pair, {.budget = 60, .iterations = 3, .growth = 1},
                                       phimis::fixed_rule<2>(), combination);
    CHECK(sound(run));
    CHECK(run.estimate == Approx(1).epsilon(1e-14));
    CHECK(run.standard_error <= 1e-14);
  };
  check(phimis::inverse_variance{});
  check(phimis::by_count{});
  check(phimis::square_root{});
  check(phimis::pooled{});
}

TEST_CASE("Iterations of zeros alone leave fractions, and the run goes on when f is found") {
  int seen = 0;
  const auto late = [&](double x) { return ++seen > 80 ? f(x) : 0; };
  for (const auto& rule : every_rule<double, 2>()) {
    seen = 0;
    const auto run = phimis::integrate(late, pair, {.budget = 400, .iterations = 10, .growth = 1}, rule,
                                       phimis::inverse_variance{});
    CAPTURE(rule.name());
    CHECK(sound(run));
    CHECK(run.trace[1].fractions[0] == 0.5);
    CHECK(run.trace[2].fractions[0] == 0.5);
    CHECK(run.trace[9].standard_error > 0);
    if (rule.name() != "fixed" && !rule.infinite_at_zero()) CHECK(run.fractions[0] != 0.5);
  }
}

TEMPLATE_TEST_CASE("Of f times 1e-3 fractions move as of f", "", float, double) {
  const TestType scale = TestType(1) / 1024;
  const auto all = drawn<TestType>([](double x) { return 0.3 + x * x * x * x; }, powers, 90);
  for (auto& rule : every_rule<TestType, 3>()) {
    auto small = rule;
    teach(rule, all, 3);
    auto scaled = all;
    for (auto& o : scaled) o.f *= scale;
    teach(small, scaled, 3);
    CAPTURE(rule.name());
    CHECK(same(rule.fractions(), small.fractions()));
    if (rule.name() != "fixed") CHECK_FALSE(same(small.fractions(), phimis::equal_fractions<TestType, 3>()));
  }
}

TEMPLATE_TEST_CASE("A start at a vertex is left by every rule that minimises", "", float, double) {
  // f/p_1 and f/p_2 both vary by a factor of four: each technique is needed.
  const auto all = quadrature<TestType>(f, pair, {0, 1}, 5);
  for (const int vertex : {0, 1}) {
    auto options = starting_at<TestType, 2>({{TestType(1 - vertex), TestType(vertex)}});
    for (auto& rule : every_rule<TestType, 2>(options)) {
      if (rule.how() == way::otherwise || rule.name().find("printed") != std::string::npos) continue;
      CAPTURE(rule.name(), vertex);
      // At f(0)/p_2(0) = ∞ the steps of sums have no number to go by: they say so and count it.
      teach(rule, all);
      if (rule.how() == way::by_steps) continue;
      CHECK(rule.fractions()[0] > TestType(0.05));
      CHECK(rule.fractions()[1] > TestType(0.05));
    }
  }
}

TEMPLATE_TEST_CASE("A column of zeros, or the same column twice, has no fraction below 0 and no NaN", "", float,
                   double) {
  const auto all = drawn<TestType>(f, powers, 60);
  for (const int change : {0, 1, 2}) {
    auto changed = all;
    for (auto& o : changed) o.pdfs[2] = change == 0 ? 0 : change == 1 ? o.pdfs[0] : o.pdfs[1] * (1 + TestType(1e-7));
    for (const auto variate : {control_variate::on, control_variate::off}) {
      for (auto& rule : every_rule<TestType, 3>(phimis::without_floors<TestType, 3>(), variate)) {
        teach(rule, changed, 5);  // which checks the simplex
        for (const TestType a : rule.fractions()) CHECK_FALSE(std::signbit(a));
      }
    }
  }
}

TEST_CASE("Old observations keep the density that they were drawn from") {
  // 4000 quantiles of p_1 = 1, then of .2 p_1 + .8 p_2: with their own q, sums are integrals and the optimum is the oracle's.
  const phimis::analysis::problem on(f, pair, phimis::interval(0, 1));
  const auto options = phimis::without_floors<double, 2>();
  auto rules = exact_rules<double, 2>(options, control_variate::off);
  auto newest = rules;  // told that all were drawn from the second
  for (std::size_t i = 0; i < rules.size(); ++i) {
    for (int batch = 0; batch < 2; ++batch) {
      for (int j = 0; j < 4000; ++j) {
        const double u = (j + 0.5) / 4000;
        const double x = batch == 0 ? u : (-0.2 + std::sqrt(0.04 + 3.2 * u)) / 1.6;
        const double q = 0.2 + 1.6 * x;
        rules[i].observe({f(x), {{1, 2 * x}}, batch == 0 ? 1 : q, batch});
        newest[i].observe({f(x), {{1, 2 * x}}, q, batch});
      }
      rules[i].update();
    }
    newest[i].update();
    const any_divergence& divergence = *rules[i].divergence();
    const auto wanted = divergence.optimum(on, options).alpha;
    CAPTURE(rules[i].name(), rules[i].fractions()[0], wanted[0], newest[i].fractions()[0]);
    // The midpoint rule: 1/24 · 4000² of second derivatives; of a step 1/4000.
    CHECK(apart(rules[i].fractions(), wanted) <= (divergence.steps ? 2e-3 : 1e-5));
    if (divergence.name == "chi squared") CHECK(apart(newest[i].fractions(), wanted) > 0.02);
  }
}

TEST_CASE("Samples with f = 0 count in the pdf sums of the linear heuristic, which has f and not f/p") {
  // f = 0 below ½, x² above, from p_1 = 1 and p_2 = 2x, of which half a technique's samples are zeros. By quadrature
  // Σ_i α_i P_ik ∝ F_k: P_11 = 1, P_21 = 1, P_12 = 1, P_22 = 4/3, of p_i under technique k; F_1 = 7/24, F_2 = 15/32.
  const auto half = [](double x) { return x < 0.5 ? 0 : x * x; };
  const double f1 = 7.0 / 24;
  const double f2 = 15.0 / 32;
  // Eq. 17: α_1 = (P_22 F_1 − P_21 F_2)/(P_11 F_2 − P_21 F_2 − P_12 F_1 + P_22 F_1), here negative; so half of f is added 1.
  const double g1 = f1 + 1;
  const double g2 = f2 + 1;
  const double wanted = (4.0 / 3 * g1 - g2) / (g2 - g2 - g1 + 4.0 / 3 * g1);
  const auto sum = [&](double x) { return half(x) + 1; };
  for (auto& rule : every_rule<double, 2>(phimis::without_floors<double, 2>())) {
    if (rule.name().find("linear") == std::string::npos) continue;
    teach(rule, drawn(sum, pair, 20000));
    CAPTURE(rule.name());
    // Quantiles are a midpoint rule: 1/n of the jump at ½.
    CHECK(rule.fractions()[0] == Approx(wanted).epsilon(1e-3));
    auto zeros = every_rule<double, 2>(phimis::without_floors<double, 2>());
    for (auto& with_zeros : zeros) {
      if (with_zeros.name() != rule.name()) continue;
      // f = p_1 + 3 p_2 on half of the samples, at twice the height, 0 on the other: P sees all, F the mean.
      auto all = drawn([](double x) { return 2 + 12 * x; }, pair, 20000);
      for (std::size_t j = 0; j < all.size(); ++j) all[j].f = j / 2 % 2 == 0 ? all[j].f : 0;
      teach(with_zeros, all);
      CHECK(with_zeros.fractions()[0] == Approx(0.25).epsilon(1e-3));
      CHECK(with_zeros.counters().zero == 10000);
    }
  }
}

TEST_CASE(
    "A delta-like technique is divided by its count: its part of the integral does not grow with its fraction") {
  const phimis::gaussian narrow(0.5, 1e-8, phimis::interval(0, 1));
  const phimis::technique_set both(narrow, power_of{0});
  const auto spike = [&](double x) { return narrow.pdf(x) + 2; };
  for (const double share : {0.1, 0.5, 0.9}) {
    const auto run = phimis::integrate(spike, both, {.budget = 1000, .iterations = 2, .growth = 1},
                                       phimis::fixed_rule<2>({.start = {{share, 1 - share}}}), phimis::square_root{});
    // Each part is constant to 1e-7 where its technique samples.
    CHECK(run.estimate == Approx(3).epsilon(1e-6));
    CHECK(run.standard_error <= 1e-6);
  }
}

TEST_CASE("What is sampled and what is evaluated is one density, down to a width of 1e-8") {
  const phimis::gaussian narrow(0.5, 1e-8, phimis::interval(0, 1));
  for (int j = 0; j < 200; ++j) {
    const double u = (j + 0.5) / 200;
    const auto next = [&] { return u; };
    const double x = narrow.sample(next);
    // x has digits of 1e-16, the pdf a width of 1e-8: u to 1e-8.
    CHECK(std::fabs(narrow.invert(x) - u) <= 2e-8);
    const double h = 1e-10;
    const double mass = narrow.invert(x + h) - narrow.invert(x - h);
    CHECK(narrow.pdf(x) * 2 * h == Approx(mass).epsilon(1e-3));
  }
}

namespace {

/// A uniform technique that is broken at a tenth of its samples.
enum class fault { nan_point, no_pdf, infinite_pdf, nan_pdf, negative_pdf };
struct broken {
  fault how;
  double pdf(double x) const {
    if (x >= 0.1) return x <= 1 ? 1 : 0;
    if (how == fault::no_pdf) return 0;
    if (how == fault::infinite_pdf) return std::numeric_limits<double>::infinity();
    if (how == fault::nan_pdf) return std::numeric_limits<double>::quiet_NaN();
    return how == fault::negative_pdf ? -1 : 1;
  }
  template <class Next>
  double sample(Next&& next) const {
    const double x = next();
    return how == fault::nan_point && x < 0.1 ? std::numeric_limits<double>::quiet_NaN() : x;
  }
};

}  // namespace

TEST_CASE(
    "A sampler that returns NaN, a pdf of 0 at its own sample, infinite or none: counted, and no number is lost") {
  for (const fault how :
       {fault::nan_point, fault::no_pdf, fault::infinite_pdf, fault::nan_pdf, fault::negative_pdf}) {
    const phimis::technique_set techniques(broken{how}, power_of{1});
    for (const auto& rule : every_rule<double, 2>()) {
      const auto run = phimis::integrate(f, techniques, {.budget = 400, .iterations = 4, .growth = 4}, rule,
                                         phimis::square_root{});
      CAPTURE(rule.name(), static_cast<int>(how));
      CHECK(sound(run));
      CHECK(phimis::is_finite(run.standard_error));
      // A pdf of 0 is no fault where the other technique has density; it is one of p_1's own weights.
      if (how != fault::no_pdf) CHECK(run.nonfinite > 0);
      CHECK(run.rule.counters().nonfinite <= 200);
    }
  }
}

TEST_CASE("Values of f that are infinite or NaN are counted by every rule and estimate") {
  for (const double bad : {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
                           std::numeric_limits<double>::quiet_NaN()}) {
    const auto wild = [&](double x) { return x < 0.1 ? bad : f(x); };
    for (const auto& rule : every_rule<double, 2>()) {
      const auto run =
          phimis::integrate(wild, pair, {.budget = 400, .iterations = 4, .growth = 4}, rule, phimis::square_root{});
      CAPTURE(rule.name());
      CHECK(sound(run));
      CHECK(phimis::is_finite(run.standard_error));
      CHECK(run.nonfinite > 0);
      CHECK(run.rule.counters().nonfinite == run.nonfinite);
    }
  }
}
