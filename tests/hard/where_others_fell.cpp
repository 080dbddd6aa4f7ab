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
#include <type_traits>

namespace {

using namespace hard;
using phimis::control_variate;
using phimis::rule_status;

const phimis::technique_set pair(power_of{0}, power_of{1});

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
  for_two_and_three([&](const auto& techniques) {
    constexpr int M = std::decay_t<decltype(techniques)>::techniques;
    const auto all = drawn<TestType>([](double x) { return 0.3 + x * x * x * x; }, techniques, 90);
    for (auto& rule : every_rule<TestType, M>()) {
      auto small = rule;
      teach(rule, all, 3);
      auto scaled = all;
      for (auto& o : scaled) o.f *= scale;
      teach(small, scaled, 3);
      CAPTURE(rule.name());
      CHECK(same(rule.fractions(), small.fractions()));
      if (rule.name() != "fixed") CHECK_FALSE(same(small.fractions(), phimis::equal_fractions<TestType, M>()));
    }
  });
}

TEMPLATE_TEST_CASE("A start at a vertex is left by every rule that minimises", "", float, double) {
  // f/p_1 and f/p_2 both vary by a factor of four: each technique is needed. f/p_2 is infinite at 0 alone, where there is no
  // node: no rule lacks a number there.
  const auto all = quadrature<TestType>(f, pair, {0, 1}, 5);
  const phimis::analysis::problem on(f, pair, phimis::interval(0, 1));
  for (const int vertex : {0, 1}) {
    const auto options = starting_at<TestType, 2>({{TestType(1 - vertex), TestType(vertex)}});
    for (auto& rule : every_rule<TestType, 2>(options)) {
      CAPTURE(rule.name(), vertex);
      if (rule.name() == "joint") {
        // f less its best fit is even around ½ and p_2 − p_1 odd: p = 1 is stationary, and best. Flat there, so that a
        // residual of 1e-13 is an α of its root.
        CHECK(teach(rule, all) == rule_status::updated);
        CHECK(rule.fractions()[0] >= TestType(1 - 1e-6));
      }
      if (rule.how() == way::otherwise) continue;
      if (rule.how() == way::by_steps) {
        auto first = rule;
        CHECK(teach(first, all, 1) == rule_status::updated);
        CHECK(first.fractions()[vertex] < 1);
      }
      // From p_2 alone the streaming rule for V[F], whose steps are short, needs the most: 90.
      teach(rule, all, 100);
      CAPTURE(rule.fractions()[0]);
      CHECK((rule.status() == rule_status::updated || rule.status() == rule_status::local));
      CHECK(rule.counters().left == 0);
      CHECK(rule.counters().nonfinite == 0);
      CHECK(rule.fractions()[0] > TestType(0.05));
      CHECK(rule.fractions()[1] > TestType(0.05));
      const any_divergence& divergence = *rule.divergence();
      if (!divergence.power && !divergence.variance) continue;  // kinks: five panels are no integral of them
      // Each of 100 rows is off by ε/2 of its part of λ, and ζ has the slope .6 |β| λ: of log t 1, of V[F] 2 for β.
      const double beta = divergence.variance ? 2 : divergence.exponent == 0 ? 1 : std::fabs(divergence.exponent);
      const auto wanted = divergence.optimum(on, phimis::without_floors<double, 2>()).alpha;
      CAPTURE(wanted[0]);
      CHECK(apart(rule.fractions(), wanted) <= 100 * std::numeric_limits<TestType>::epsilon() / beta);
    }
  }
}

TEMPLATE_TEST_CASE("A column of zeros, or the same column twice, has no fraction below 0 and no NaN", "", float,
                   double) {
  for_two_and_three([](const auto& techniques) {
    constexpr int M = std::decay_t<decltype(techniques)>::techniques;
    const auto all = drawn<TestType>(f, techniques, 60);
    for (const int change : {0, 1, 2}) {
      auto changed = all;
      for (auto& o : changed)
        o.pdfs[M - 1] = change == 0 ? 0 : change == 1 ? o.pdfs[0] : o.pdfs[M - 2] * (1 + TestType(1e-7));
      for (const auto variate : {control_variate::on, control_variate::off}) {
        for (auto& rule : every_rule<TestType, M>(phimis::without_floors<TestType, M>(), variate)) {
          CAPTURE(M, change, static_cast<int>(variate));
          teach(rule, changed, 5);  // which checks the simplex
          for (const TestType alpha : rule.fractions()) CHECK_FALSE(std::signbit(alpha));
        }
      }
    }
  });
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

TEMPLATE_TEST_CASE("Samples with f = 0 count in the pdf sums of the linear heuristic, which has f and not f/p", "",
                   float, double) {
  // f = 1 above ¼, 0 below; p_1 = 1, p_2 = 2x. Means over all samples of a technique, P_ik = ∫ p_i p_k, F_k = ∫ f p_k:
  //   P_11 = P_21 = P_12 = 1, P_22 = 4/3, F_1 = 3/4, F_2 = 15/16
  //   Eq. 17: α_1 = (P_22 F_1 − P_21 F_2)/(P_11 F_2 − P_21 F_2 − P_12 F_1 + P_22 F_1) = (1/16)/(1/4) = ¼
  // Without the samples of which f is 0, P_ik = ∫ f p_i p_k, f is p_1 and α_1 = 1.
  constexpr int n =
      1600;  // of each technique: ¼ of the first and 1/16 of the second are whole numbers, so F is exact
  const auto all = drawn<TestType>([](double x) { return x < 0.25 ? 0 : 1; }, pair, 2 * n);
  int met = 0;
  for (auto& rule : every_rule<TestType, 2>(phimis::without_floors<TestType, 2>())) {
    if (rule.name().find("linear") == std::string::npos) continue;
    ++met;
    CHECK(teach(rule, all) == rule_status::updated);
    CAPTURE(rule.name(), rule.fractions()[0]);
    // P_22 is the mean of 2√u over quantiles u: off by 2 · .061/n^{3/2} = 2e-6, and ∂α_1/∂P_22 = 9/4. Sums of n floats are
    // off by n ε/2 = 1e-4 of themselves, which reach α_1 7.5-fold.
    CHECK(std::fabs(static_cast<double>(rule.fractions()[0]) - 0.25) <= (is_float<TestType> ? 8e-4 : 1e-5));
    CHECK(rule.counters().zero == n / 4 + n / 16);
    CHECK(rule.counters().left == 0);
  }
  CHECK(met == 3);
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

/// A uniform technique that is broken at a tenth of its samples, which it counts.
enum class fault { nan_point, no_pdf, infinite_pdf, nan_pdf, negative_pdf };
struct broken {
  fault how;
  std::int64_t* met;
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
    if (x < 0.1) ++*met;
    return how == fault::nan_point && x < 0.1 ? std::numeric_limits<double>::quiet_NaN() : x;
  }
};

}  // namespace

TEST_CASE(
    "A sampler that returns NaN, a pdf of 0 at its own sample, infinite or none: counted, and no number is lost") {
  for (const fault how :
       {fault::nan_point, fault::no_pdf, fault::infinite_pdf, fault::nan_pdf, fault::negative_pdf}) {
    std::int64_t met = 0;
    std::int64_t below = 0;  // samples of either technique where the pdf is broken
    const auto counted = [&](double x) {
      below += x < 0.1 ? 1 : 0;
      return f(x);
    };
    const phimis::technique_set techniques(broken{how, &met}, power_of{1});
    for (const auto& rule : every_rule<double, 2>()) {
      met = below = 0;
      const auto run = phimis::integrate(counted, techniques, {.budget = 400, .iterations = 4, .growth = 4}, rule,
                                         phimis::square_root{});
      CAPTURE(rule.name(), static_cast<int>(how));
      CHECK(sound(run));
      CHECK(phimis::is_finite(run.standard_error));
      CHECK(met > 0);
      // A pdf of 0 is no fault where the other technique has density: nothing is infinite.
      const std::int64_t faulty = how == fault::nan_point ? met : how == fault::no_pdf ? 0 : below;
      CHECK(run.nonfinite == faulty);
      // But it is one of p_1's own weights f/p_1, which this rule alone looks at.
      const bool own_weights = how == fault::no_pdf && rule.name() == "inverse variance";
      CHECK(run.rule.counters().nonfinite == (own_weights ? met : faulty));
    }
  }
}

TEST_CASE("What a broken technique does to an estimate is what its faults weigh") {
  // Beside another uniform technique, at equal counts: a sample that is not finite counts as 0.
  const double broken_part = 0.03 + 0.001 / 3;  // ∫ f over [0, .1]
  const auto bias = [&](fault how) {
    if (how == fault::nan_point) return -broken_part / 2;  // p_1's samples are lost
    if (how == fault::no_pdf) return broken_part;          // of all samples the weight is 1/½ in place of 1
    return -broken_part;                                   // all samples are lost
  };
  for (const fault how :
       {fault::nan_point, fault::no_pdf, fault::infinite_pdf, fault::nan_pdf, fault::negative_pdf}) {
    std::int64_t met = 0;
    int draws = 0;
    const auto next = [&] { return (draws++ % 200 + 0.5) / 200; };  // quantiles of one technique, then of the other
    const phimis::technique_set techniques(broken{how, &met}, power_of{0});
    const auto run = phimis::integrate(f, techniques, {.budget = 400, .iterations = 1}, next, phimis::fixed_rule<2>(),
                                       phimis::by_count{});
    CAPTURE(static_cast<int>(how), run.estimate);
    CHECK(draws == 400);
    CHECK(met == 20);
    CHECK(run.nonfinite == (how == fault::nan_point ? 20 : how == fault::no_pdf ? 0 : 40));
    // The midpoint rule, an edge at .1: f''/24/200² = 2e-6, twice as much where weights are 2.
    CHECK(std::fabs(run.estimate - (0.3 + 1.0 / 3 + bias(how))) <= 5e-6);
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
