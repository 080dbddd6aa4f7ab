// SPDX-License-Identifier: MIT
// joint_problem.hpp, joint_minimiser.hpp, joint_optimum.hpp
#include "catch.hpp"
#include "papers/tsallis_whole_line.hpp"
#include "random.hpp"
#include "two_triangles.hpp"

#include <phimis/analysis/joint_optimum.hpp>
#include <phimis/analysis/optimum.hpp>
#include <phimis/analysis/variance.hpp>
#include <phimis/estimator/control_variates.hpp>
#include <phimis/solver/joint_minimiser.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace {

using phimis::control_variate;
using phimis::joint_minimiser;
using phimis::joint_rule;
using phimis::per_technique;
using phimis::rule_options;
using phimis::rule_status;

static_assert(phimis::rule<joint_minimiser<2>> && phimis::rule<joint_minimiser<7>>);

double bent(double x) { return x * x + 0.3; }

/// Rows of M random pdfs, of an f that they do not span and that changes sign.
template <int M>
phimis::table<double, M> random_table(int n, std::uint64_t seed) {
  random_numbers random(seed);
  phimis::table<double, M> table;
  for (int j = 0; j < n; ++j) {
    phimis::row<double, M> row{random.between(-1, 2), random.between(0.5, 2), {}};
    double sum = 0;
    for (double& y : row.y) sum += y = random.over_decades(1e-3, 1);
    for (double& y : row.y) y /= sum;
    table.push(row);
  }
  return table;
}

/// Without floors, prior and normalisation: the problem as it stands.
template <int M>
rule_options<double, M> bare() {
  auto options = phimis::without_floors<double, M>();
  return options;
}

/// min_β Σ w (u − β·y)²/(α·y), by regression.
template <int M>
double controlled_sum(const phimis::table<double, M>& table, const phimis::fractions<double, M>& alpha) {
  phimis::least_squares<double, M> sums;
  for (std::ptrdiff_t j = 0; j < table.size(); ++j) {
    const auto row = table[j];
    per_technique<double, M> y{};
    double x = 0;
    for (int k = 0; k < M; ++k) x += alpha[k] * (y[k] = row.y[k]);
    const double root = std::sqrt(row.w / x);
    for (int k = 0; k < M; ++k) y[k] *= root;
    sums.add(y, row.u * root);
  }
  const double norm = sums.solve().residual_norm;
  return norm * norm;
}

template <int M>
void observe_all(joint_minimiser<M>& rule, const std::vector<phimis::observation<double, M>>& samples) {
  for (const auto& s : samples) rule.observe(s);
}

}  // namespace

TEST_CASE("The gradient and the Hessian of the joint problem are those of its minimum over the coefficients") {
  constexpr int m = 4;
  const auto table = random_table<m>(80, 1);
  const auto rows = table.view();
  const std::array<double, m> kappa{1, 1, 1, 1};
  for (const bool floored : {false, true}) {
    std::array<double, phimis::floored_simplex::doubles(m)> memory{};
    std::array<int, m> coordinates{};
    phimis::floored_simplex simplex(m, kappa.data(), memory.data(), coordinates.data());
    simplex.constrain([](int) { return false; }, [&](int k) { return floored ? 0.01 * (k + 1) : 0; });
    phimis::joint_problem<m> problem(rows, 1, simplex, kappa.data());
    problem.set_prior(0.7, {0.1, 0.2, 0.3, 0.4});
    const auto objective = [&](const std::array<double, m>& theta) {
      std::array<double, m> unused{};
      return problem.gradient(theta.data(), unused.data(), unused.data());  // λ: the objective, prior and all
    };
    const std::array<double, m> at{0.1, 0.3, 0.4, 0.2};
    std::array<double, m> gradient{};
    std::array<double, m> sizes{};
    std::array<double, m * m> hessian{};
    const int all[m] = {0, 1, 2, 3};
    problem.gradient(at.data(), gradient.data(), sizes.data());
    problem.hessian(all, m, hessian.data());
    const double h = 1e-5;
    for (std::size_t k = 0; k < m; ++k) {
      // Along the simplex: from the last coordinate to the k-th.
      auto above = at;
      auto below = at;
      above[k] += h;
      above[m - 1] -= h;
      below[k] -= h;
      below[m - 1] += h;
      if (k == m - 1) continue;
      const double slope = (objective(above) - objective(below)) / (2 * h);
      CHECK(-(gradient[k] - gradient[m - 1]) == Approx(slope).epsilon(1e-6));
      std::array<double, m> higher{};
      std::array<double, m> lower{};
      problem.gradient(above.data(), higher.data(), sizes.data());
      problem.gradient(below.data(), lower.data(), sizes.data());
      for (std::size_t l = 0; l + 1 < m; ++l) {
        const double wanted = -((higher[l] - higher[m - 1]) - (lower[l] - lower[m - 1])) / (2 * h);
        const double ours =
            hessian[l * m + k] - hessian[l * m + m - 1] - hessian[(m - 1) * m + k] + hessian[m * m - 1];
        CHECK(ours == Approx(wanted).epsilon(1e-5).margin(1e-6));
      }
    }
  }
}

TEST_CASE("The joint minimum is below every mixture on a grid, and the best of its control variates") {
  const auto table = random_table<3>(60, 2);
  const auto found = phimis::minimise_jointly<3>(table.view(), 2, bare<3>(), bare<3>().start, control_variate::off);
  CHECK(found.status == rule_status::updated);
  const double least = controlled_sum<3>(table, found.alpha);
  CHECK(found.objective * 4 == Approx(least).epsilon(1e-10));
  for (int i = 1; i < 40; ++i) {
    for (int j = 1; j < 40 - i; ++j) {
      const double a = i / 40.0;
      const double b = j / 40.0;
      REQUIRE(controlled_sum<3>(table, {{a, b, 1 - a - b}}) >= least * (1 - 1e-12));
    }
  }
}

TEMPLATE_TEST_CASE_SIG("The joint minimum satisfies its conditions on all coordinates", "", ((int M), M), 2, 3, 8, 16,
                       20) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const auto table = random_table<M>(30 * M, seed);
    auto options = phimis::without_floors<double, M>();
    if (seed % 2 == 0) options.floors = phimis::defensive_floors<double, M>();
    if (seed % 3 == 0) options.prior = 5;
    const auto found = phimis::minimise_jointly<M>(table.view(), 2, options, options.start, control_variate::off);
    CAPTURE(M, seed, found.solution.iterations, found.solution.evaluations);
    CHECK(found.status == rule_status::updated);
    CHECK(found.solution.residual < 1e-11);
    CHECK(found.solution.gap < 1e-11);
    double sum = 0;
    for (int k = 0; k < M; ++k) {
      CHECK(found.alpha[k] >= options.floors[k]);
      sum += found.alpha[k];
    }
    CHECK(sum == Approx(1).epsilon(1e-14));
  }
}

TEST_CASE("More techniques than rows, duplicates and columns of zeros leave a certified minimum") {
  phimis::table<double, 6> table;
  random_numbers random(3);
  for (int j = 0; j < 40; ++j) {
    const double a = random();
    const double b = random();
    const double c = random();
    const double sum = 2 * a + b + 2 * c;
    table.push({random.between(-1, 1), 1, {a / sum, b / sum, a / sum, 0, c / sum, c / sum}});
  }
  const auto found = phimis::minimise_jointly<6>(table.view(), 1, bare<6>(), bare<6>().start, control_variate::off);
  CHECK(found.status == rule_status::updated);
  CHECK(found.solution.residual < 1e-10);
  CHECK(found.alpha[3] == Approx(1.0 / 6));  // nothing is known of it
  phimis::table<double, 6> few;
  for (std::ptrdiff_t j = 0; j < 3; ++j) few.push(table[j]);
  // Three rows: control variates fit them.
  CHECK(phimis::minimise_jointly<6>(few.view(), 1, bare<6>(), bare<6>().start, control_variate::off).status ==
        rule_status::no_information);
}

TEST_CASE("A technique without a fraction that alone reaches a part of the line is released where it is needed") {
  // Rows 0..19: both; rows 20..39: only the second technique, f = 0. Its pdf as control variate is worth a fraction.
  random_numbers random(4);
  phimis::table<double, 2> table;
  for (int j = 0; j < 20; ++j) {
    const double y = random.between(0.1, 0.9);
    table.push({3 + 4 * (1 - y) + 0.01 * random(), 1, {y, 1 - y}});
  }
  for (int j = 0; j < 20; ++j) table.push({0, 0.05, {0, 1}});
  const auto found = phimis::minimise_jointly<2>(table.view(), 8, bare<2>(), {{1, 0}}, control_variate::off);
  CHECK(found.alpha[1] > 0.05);
  CHECK(found.solution.residual < 1e-11);
}

TEST_CASE("The exact joint optimum of the Tsallis paper's third example is that of independent prototypes") {
  const auto exact = papers::whole_3::exact();
  const auto equal = phimis::equal_fractions<double, 2>();
  const auto best = phimis::analysis::optimum(phimis::chi_squared{}, exact).alpha;
  CHECK(phimis::analysis::variance(exact, equal).one_sample.value == Approx(0.369).margin(0.0005));
  CHECK(phimis::analysis::variance(exact, best).one_sample.value == Approx(0.0910).margin(0.00005));
  CHECK(phimis::analysis::best_control_variates(exact, equal).variance.value == Approx(0.0615).margin(0.00005));
  // At α ≈ .995 by their floor; without one, the first technique reaches the whole domain and gets all.
  rule_options<double, 2> floors{.floors = {{0.005, 0.005}}};
  const auto joint = phimis::analysis::joint_optimum(exact, floors);
  CHECK(joint.alpha[0] == Approx(0.995).epsilon(1e-12));
  CHECK(joint.variance.value == Approx(0.0399).margin(0.00005));
  CHECK(joint.variance.error < 1e-12);
  const auto without = phimis::analysis::joint_optimum(exact);
  CHECK(without.alpha[0] == 1);
  CHECK(without.variance.value < joint.variance.value);
}

TEMPLATE_TEST_CASE("Near the exact joint optimum no fractions are better", "", papers::whole_1, papers::whole_2) {
  const auto exact = TestType::exact();
  const auto joint = phimis::analysis::joint_optimum(exact);
  CHECK(joint.residual < 1e-12);
  CHECK(joint.alpha[0] > 0.01);
  CHECK(joint.alpha[0] < 0.99);
  CHECK(joint.variance.value ==
        Approx(phimis::analysis::best_control_variates(exact, joint.alpha).variance.value).epsilon(1e-10));
  for (const double step : {-0.1, -0.01, 0.01, 0.1}) {
    const phimis::fractions<double, 2> near{{joint.alpha[0] + step, joint.alpha[1] - step}};
    CHECK(phimis::analysis::best_control_variates(exact, near).variance.value > joint.variance.value);
  }
  // Without control variates, and with them at the χ² optimum, the variance is larger.
  const auto best = phimis::analysis::optimum(phimis::chi_squared{}, exact).alpha;
  CHECK(phimis::analysis::best_control_variates(exact, best).variance.value > joint.variance.value);
  CHECK(phimis::analysis::variance(exact, best).multi_sample.value > joint.variance.value);
}

TEST_CASE("At best control variates both sampling models have the same variance") {
  // The means of the techniques, ∫ p_k (f − β·p)/p(α), are 0: nothing is between them.
  const auto exact = papers::whole_1::exact();
  const phimis::fractions<double, 2> alpha{{0.3, 0.7}};
  const auto best = phimis::analysis::best_control_variates(exact, alpha);
  for (int k = 0; k < 2; ++k) {
    const auto mean = exact.integral([&](double f, const per_technique<double, 2>& p, double) {
      const double q = phimis::mixture(alpha, p);
      return q > 0 ? p[k] * (f - best.beta[0] * p[0] - best.beta[1] * p[1]) / q : 0;
    });
    CHECK(std::fabs(mean.value) < 1e-11);
  }
}

TEST_CASE("The oracle refuses a defective pdf as a control variate") {
  struct half {
    double pdf(double x) const { return x < 0 || x > 1 ? 0 : 0.5; }
    double sample(phimis::detail::any_uniform_source next) const { return next(); }
  };
  const phimis::technique_set defective(half{}, half{});
  const phimis::analysis::problem on([](double x) { return x; }, defective, phimis::interval(0, 1), {},
                                     phimis::analysis::normalisation::defective);
  CHECK_THROWS_WITH(phimis::analysis::joint_optimum(on), contains_text("pdf 1 must promise to integrate to 1"));
  CHECK_THROWS_WITH(phimis::analysis::best_control_variates(on, phimis::equal_fractions<double, 2>()),
                    contains_text("pdf 1 must promise to integrate to 1"));
}

TEST_CASE("The joint rule finds the exact optimum from many samples") {
  const auto techniques = papers::whole_1::techniques();
  auto rule = joint_rule<2>();
  random_numbers random(5);
  phimis::draw_batch(papers::whole_1::f, techniques, phimis::equal_fractions<double, 2>(), {100000},
                     phimis::balance{}, random, [&](const auto& s) { rule.observe(s.observed); });
  CHECK(rule.status() == rule_status::start);
  CHECK(rule.update() == rule_status::updated);
  const auto joint = phimis::analysis::joint_optimum(papers::whole_1::exact());
  CHECK(rule.fractions()[0] == Approx(joint.alpha[0]).margin(0.005));
  CHECK(rule.coefficients()[0] == Approx(joint.beta[0]).epsilon(0.02));
  CHECK(rule.coefficients()[1] == Approx(joint.beta[1]).epsilon(0.02));
  CHECK(rule.variance() == Approx(joint.variance.value).epsilon(0.02));
  CHECK(rule.residual() < 1e-12);
  CHECK(rule.gap() < 1e-12);
  CHECK(rule.evaluations() < 30);
}

TEST_CASE("The joint rule leaves fractions where they are without information, and where control variates fit f") {
  auto rule = joint_rule<2>();
  CHECK(rule.update() == rule_status::no_information);
  observe_all<2>(rule, two_triangles::observe([](double) { return 0.0; }, 0.5, 20, 1));
  CHECK(rule.update() == rule_status::no_information);
  const auto span = [](double x) { return 2 * two_triangles::p1(x) - 0.5 * two_triangles::p2(x); };
  auto exact = joint_rule<2>({.start = {{0.3, 0.7}}});
  observe_all<2>(exact, two_triangles::observe(span, 0.5, 50, 2));
  CHECK(exact.update() == rule_status::no_information);
  CHECK(exact.fractions()[0] == 0.3);
}

TEST_CASE("The joint rule keeps a technique without density where it is") {
  auto rule = joint_rule<3>();
  for (const auto& s : two_triangles::observe(bent, 0.5, 50, 3)) {
    rule.observe({s.f, {{s.pdfs[0], 0, s.pdfs[1]}}, s.q, s.technique});
  }
  CHECK(rule.update() == rule_status::updated);
  CHECK(rule.fractions()[1] == Approx(1.0 / 3).epsilon(1e-12));
}

TEST_CASE("Frozen techniques stay, and costs move the joint optimum to the cheap") {
  const auto samples = two_triangles::observe([](double x) { return std::sin(7 * x) + 1.2; }, 0.5, 400, 4);
  rule_options<double, 2> frozen{.start = {{0.3, 0.7}}};
  frozen.frozen[0] = true;
  auto held = joint_rule<2>(frozen);
  observe_all<2>(held, samples);
  held.update();
  CHECK(held.fractions()[0] == 0.3);

  auto same = joint_rule<2>();
  auto costly = joint_rule<2>({.costs = {{5, 1}}});
  observe_all<2>(same, samples);
  observe_all<2>(costly, samples);
  CHECK(same.update() == rule_status::updated);
  CHECK(costly.update() == rule_status::updated);
  CHECK(costly.fractions()[0] < same.fractions()[0]);
  // Cost times variance is least there.
  const auto cost_times_variance = [&](double a) {
    return (5 * a + 1 - a) * controlled_sum<2>(costly.rows(), {{a, 1 - a}});
  };
  auto free = joint_rule<2>({.floors = {{0, 0}}, .costs = {{5, 1}}}, control_variate::off);
  observe_all<2>(free, samples);
  free.update();
  const double best = free.fractions()[0];
  for (const double step : {-0.02, 0.02}) CHECK(cost_times_variance(best + step) > cost_times_variance(best));
}

TEST_CASE("The prior of the joint rule draws fractions to the start") {
  const auto samples = two_triangles::observe([](double x) { return std::sin(7 * x) + 1.2; }, 0.5, 60, 5);
  double before = 1;
  for (const double prior : {0.0, 20.0, 200.0, 1e6}) {
    auto rule = joint_rule<2>({.prior = prior});
    observe_all<2>(rule, samples);
    rule.update();
    const double away = std::fabs(rule.fractions()[0] - 0.5);
    CHECK(away < before);
    before = away;
  }
  CHECK(before < 1e-3);
}

TEST_CASE("No scale of the integrand and no change of the measure moves the joint rule") {
  const auto f = [](double x) { return std::sin(7 * x) + 0.2; };  // of both signs
  const auto samples = two_triangles::observe(f, 0.5, 100, 6);
  auto one = joint_rule<2>();
  observe_all<2>(one, samples);
  one.update();
  for (const double unit : {1e-300, 1e-3, 1e300}) {
    auto scaled = joint_rule<2>();
    for (auto s : samples) {
      s.f *= unit;
      scaled.observe(s);
    }
    scaled.update();
    CHECK(scaled.fractions()[0] == Approx(one.fractions()[0]).epsilon(1e-10));
    CHECK(scaled.coefficients()[0] / unit == Approx(one.coefficients()[0]).epsilon(1e-10));
    auto measured = joint_rule<2>();
    for (auto s : samples) {
      s.f *= 1e100;
      for (int k = 0; k < 2; ++k) s.pdfs[k] *= 1e100;
      s.q *= 1e100;
      measured.observe(s);
    }
    measured.update();
    CHECK(measured.fractions()[0] == Approx(one.fractions()[0]).epsilon(1e-12));
  }
}

TEST_CASE("States of the joint rule merge, with themselves too") {
  const auto samples = two_triangles::observe(bent, 0.5, 90, 7);
  auto all = joint_rule<2>();
  auto left = joint_rule<2>();
  auto right = joint_rule<2>();
  for (std::size_t j = 0; j < samples.size(); ++j) {
    all.observe(samples[j]);
    (j < 31 ? left : right).observe(samples[j]);
  }
  left.merge(right);
  CHECK(left.counters().observations == 90);
  all.update();
  left.update();
  CHECK(left.fractions()[0] == Approx(all.fractions()[0]).epsilon(1e-12));
  all.merge(all);
  CHECK(all.rows().size() == 180);
}

TEST_CASE("The joint rule counts what is not finite and does not sum it") {
  auto rule = joint_rule<2>();
  rule.observe({std::nan(""), {{1, 1}}, 1, 0});
  rule.observe({1, {{1, -1}}, 1, 0});
  CHECK(rule.counters().nonfinite == 2);
  CHECK(rule.rows().size() == 0);
}

TEST_CASE("The joint rule refuses options out of range") {
  CHECK_THROWS_WITH(joint_rule<2>({.floors = {{0.6, 0.6}}}), contains_text("floors must sum to at most 1, got 1.2"));
  CHECK_THROWS_WITH(joint_rule<2>({.prior = -1}), contains_text("prior must be finite and not negative, got -1"));
  CHECK_THROWS_WITH(joint_rule<2>({.costs = {{1, 0}}}), contains_text("costs must be finite and greater than 0"));
}
