// SPDX-License-Identifier: MIT
#include "catch.hpp"
#include "three_powers.hpp"
#include "two_triangles.hpp"

#include <phimis/core/linear_heuristic.hpp>
#include <phimis/core/table.hpp>

#include <cmath>
#include <limits>
#include <type_traits>
#include <vector>

namespace {

using phimis::linear_heuristic;
using phimis::negative_fractions;
using phimis::rule_options;
using phimis::rule_status;

template <class Real, int M>
using dropping = linear_heuristic<Real, M, negative_fractions::drop_most_negative>;
template <class Real, int M>
using facing = linear_heuristic<Real, M, negative_fractions::best_face, phimis::fixed_table<Real, M, 128>>;
template <class Real, int M>
using projecting = linear_heuristic<Real, M>;

double f(double x) { return 0.2 + x * x; }

/// Solutions of these are negative: f falls, which none of the three powers does.
double falling(double x) { return 1.2 - x; }

/// Concave: the solution subtracts x²; the fit is a mixture of the first two.
double concave(double x) { return 0.1 + std::sqrt(x); }

template <class Rule, class Observations>
Rule learnt(Rule rule, const Observations& all) {
  for (const auto& o : all) rule.observe(o);
  rule.update();
  return rule;
}

template <class Rule>
constexpr double tolerance = 2e3 * static_cast<double>(std::numeric_limits<typename Rule::real>::epsilon());

template <class Rule>
bool same(const Rule& a, const Rule& b, double within = tolerance<Rule>) {
  for (int k = 0; k < Rule::techniques; ++k) {
    if (!(std::fabs(a.fractions()[k] - b.fractions()[k]) <= static_cast<typename Rule::real>(within))) return false;
  }
  return true;
}

template <class Rule>
rule_options<typename Rule::real, Rule::techniques> without_floors() {
  return phimis::without_floors<typename Rule::real, Rule::techniques>();
}

template <class Real>
auto samples(double (*of)(double), std::uint64_t seed = 1) {
  return three_powers::observe<Real>(of, {{40, 30, 50}}, seed);
}

}  // namespace

#define EVERY_TREATMENT_OF_THREE                                                                                \
  (dropping<float, 3>), (dropping<double, 3>), (facing<float, 3>), (facing<double, 3>), (projecting<float, 3>), \
      (projecting<double, 3>)

TEMPLATE_TEST_CASE("Two techniques get the fraction of Eq. 17 from their samples", "", float, double) {
  const auto all = two_triangles::observe<TestType>(f, 0.4, 100, 1);
  long double p[2][2] = {};
  long double sum[2] = {};
  for (const auto& o : all) {
    sum[o.technique] += o.f;
    for (int i = 0; i < 2; ++i) p[i][o.technique] += o.pdfs[i];
  }
  const long double first = p[1][1] * sum[0] - p[1][0] * sum[1];
  const long double second = p[0][0] * sum[1] - p[0][1] * sum[0];
  REQUIRE(first > 0);
  REQUIRE(second > 0);
  const double alpha = static_cast<double>(first / (first + second));
  const double within = 200 * static_cast<double>(std::numeric_limits<TestType>::epsilon());
  const auto check = [&](auto rule) {
    rule = learnt(rule, all);
    CHECK(rule.status() == rule_status::updated);
    CHECK(std::fabs(static_cast<double>(rule.fractions()[0]) - alpha) <= within);
    CHECK(rule.counters().left == 0);
  };
  check(dropping<TestType, 2>(phimis::without_floors<TestType, 2>()));
  check(facing<TestType, 2>(phimis::without_floors<TestType, 2>()));
  check(projecting<TestType, 2>(phimis::without_floors<TestType, 2>()));
}

TEMPLATE_TEST_CASE("An integrand in the span of the pdfs has its mixture found exactly, from any samples", "",
                   EVERY_TREATMENT_OF_THREE) {
  using real = typename TestType::real;
  const auto in_the_span = [](double x) { return 0.5 + 3 * 2 * x + 1.5 * 3 * x * x; };
  for (std::uint64_t seed = 1; seed < 6; ++seed) {
    const auto all = three_powers::observe<real>(in_the_span, {{20, 10, 15}}, seed);
    const TestType rule = learnt(TestType(without_floors<TestType>()), all);
    CHECK(rule.status() == rule_status::updated);
    const double within = std::is_same<real, float>::value ? 2e-3 : 1e-11;
    CHECK(std::fabs(static_cast<double>(rule.fractions()[0]) - 0.1) <= within);
    CHECK(std::fabs(static_cast<double>(rule.fractions()[1]) - 0.6) <= within);
    CHECK(std::fabs(static_cast<double>(rule.fractions()[2]) - 0.3) <= within);
  }
}

TEMPLATE_TEST_CASE("An integrand that is one pdf asks for that technique alone", "", EVERY_TREATMENT_OF_THREE) {
  using real = typename TestType::real;
  const auto all = three_powers::observe<real>([](double x) { return 4 * x; }, {{20, 10, 15}}, 1);
  const TestType rule = learnt(TestType(without_floors<TestType>()), all);
  const double within = std::is_same<real, float>::value ? 2e-3 : 1e-11;
  CHECK(std::fabs(static_cast<double>(rule.fractions()[1]) - 1) <= within);
}

TEMPLATE_TEST_CASE("Negative solutions are treated and counted", "", EVERY_TREATMENT_OF_THREE) {
  using real = typename TestType::real;
  const TestType rule = learnt(TestType(without_floors<TestType>()), samples<real>(falling));
  CHECK(rule.status() == rule_status::updated);
  CHECK(rule.counters().left == 1);
  real sum = 0;
  for (int k = 0; k < 3; ++k) {
    CHECK(rule.fractions()[k] >= 0);
    sum += rule.fractions()[k];
  }
  CHECK(std::fabs(sum - 1) <= 4 * std::numeric_limits<real>::epsilon());
  CHECK(rule.fractions()[0] > real(0.9));  // the constant is what falls least badly
}

TEMPLATE_TEST_CASE("Floors hold where a fraction would be negative, exactly", "", EVERY_TREATMENT_OF_THREE) {
  using real = typename TestType::real;
  auto options = without_floors<TestType>();
  options.floors = {{real(0.02), real(0.05), real(0.1)}};
  const TestType rule = learnt(TestType(options), samples<real>(falling));
  CHECK(rule.status() == rule_status::updated);
  CHECK(rule.fractions()[1] == real(0.05));
  CHECK(rule.fractions()[2] == real(0.1));
  CHECK(std::fabs(rule.fractions()[0] - real(0.85)) <= 4 * std::numeric_limits<real>::epsilon());
  // By default there are some.
  CHECK(learnt(TestType(), samples<real>(falling)).fractions()[2] == phimis::defensive_floors<real, 3>()[2]);
}

TEMPLATE_TEST_CASE("Floors are constraints: what is left is solved again", "", EVERY_TREATMENT_OF_THREE) {
  using real = typename TestType::real;
  // f in the span with α = (.1, .6, .3), and a floor of .3 under the first: not (.3, .6, .3) scaled.
  const auto in_the_span = [](double x) { return 0.5 + 3 * 2 * x + 1.5 * 3 * x * x; };
  auto options = without_floors<TestType>();
  options.floors = {{real(0.3), 0, 0}};
  const TestType rule = learnt(TestType(options), three_powers::tabulate<real>(in_the_span, 40));
  CHECK(rule.fractions()[0] == real(0.3));
  const double second = static_cast<double>(rule.fractions()[1]);
  CHECK(std::fabs(second - 0.7 * 0.6 / 0.9) > 0.05);
  CHECK(rule.counters().left == 0);  // below a floor is not outside [0, 1]
}

TEMPLATE_TEST_CASE("A frozen technique keeps its start", "", EVERY_TREATMENT_OF_THREE) {
  using real = typename TestType::real;
  for (const auto of : {f, falling}) {
    auto options = without_floors<TestType>();
    options.start = {{real(0.25), real(0.25), real(0.5)}};
    options.frozen[1] = true;
    const TestType rule = learnt(TestType(options), samples<real>(of));
    CHECK(rule.status() == rule_status::updated);
    CHECK(rule.fractions()[1] == real(0.25));
    CHECK(rule.fractions()[0] != real(0.25));
    CHECK(std::fabs(rule.fractions()[0] + rule.fractions()[2] - real(0.75)) <=
          4 * std::numeric_limits<real>::epsilon());
  }
}

TEMPLATE_TEST_CASE("No scale of f changes what is learnt", "", EVERY_TREATMENT_OF_THREE) {
  using real = typename TestType::real;
  constexpr bool single = std::is_same<real, float>::value;
  for (const auto of : {f, falling, concave}) {
    const auto all = samples<real>(of);
    const TestType plain = learnt(TestType(without_floors<TestType>()), all);
    for (const double unit : {single ? 1e-35 : 1e-300, -1.0, single ? 1e35 : 1e300}) {
      auto scaled = all;
      for (auto& o : scaled) o.f *= static_cast<real>(unit);
      CHECK(same(learnt(TestType(without_floors<TestType>()), scaled), plain));
    }
  }
}

TEMPLATE_TEST_CASE("A unit of the measure changes nothing that is learnt", "", EVERY_TREATMENT_OF_THREE) {
  using real = typename TestType::real;
  for (const auto of : {f, falling, concave}) {
    const auto all = samples<real>(of);
    const TestType plain = learnt(TestType(without_floors<TestType>()), all);
    for (const int exponent : {-60, 60}) {
      auto scaled = all;
      for (auto& o : scaled) {
        const real unit = std::ldexp(real(1), exponent);
        o.f *= unit;
        o.q *= unit;
        for (int k = 0; k < 3; ++k) o.pdfs[k] *= unit;
      }
      CHECK(same(learnt(TestType(without_floors<TestType>()), scaled), plain));
    }
  }
}

TEST_CASE("The projection does not depend on the parametrisation of x, the equations do") {
  // In y = x³ every density is divided by 3x², f as well.
  const auto all = samples<double>(concave);
  auto other = all;
  for (auto& o : other) {
    const double jacobian = 1 / o.pdfs[2];
    o.f *= jacobian;
    o.q *= jacobian;
    for (int k = 0; k < 3; ++k) o.pdfs[k] *= jacobian;
  }
  const auto options = phimis::without_floors<double, 3>();
  const auto plain = learnt(projecting<double, 3>(options), all);
  const auto changed = learnt(projecting<double, 3>(options), other);
  REQUIRE(plain.counters().left == 1);
  REQUIRE(changed.counters().left == 1);
  CHECK(same(plain, changed, 1e-12));

  const auto triangles = two_triangles::observe(f, 0.5, 100, 1);
  auto moved = triangles;
  for (auto& o : moved) {
    const double jacobian = 1 / o.pdfs[1];
    o.f *= jacobian;
    o.q *= jacobian;
    for (int k = 0; k < 2; ++k) o.pdfs[k] *= jacobian;
  }
  CHECK_FALSE(same(learnt(dropping<double, 2>(phimis::without_floors<double, 2>()), triangles),
                   learnt(dropping<double, 2>(phimis::without_floors<double, 2>()), moved), 1e-3));
}

TEMPLATE_TEST_CASE("Merged heuristics have learnt from all samples, in any grouping", "", EVERY_TREATMENT_OF_THREE) {
  using real = typename TestType::real;
  random_numbers random(2);
  for (const auto of : {f, falling, concave}) {
    const auto all = samples<real>(of);
    const TestType empty(without_floors<TestType>());
    const TestType whole = learnt(empty, all);
    for (int trial = 0; trial < 5; ++trial) {
      std::vector<TestType> groups(6, empty);
      for (const auto& o : all) groups[static_cast<std::size_t>(random.below(5))].observe(o);
      while (groups.size() > 1) {
        groups[static_cast<std::size_t>(random.below(static_cast<int>(groups.size()) - 1))].merge(groups.back());
        groups.pop_back();
      }
      CHECK(groups[0].counters().observations == 120);
      CHECK(groups[0].fractions()[0] == empty.fractions()[0]);
      CHECK(groups[0].update() == whole.status());
      CHECK(same(groups[0], whole));
    }
  }
  static_assert(std::is_trivially_copyable<TestType>::value, "");
}

TEMPLATE_TEST_CASE("A heuristic merged with itself has every sample twice, which changes nothing", "",
                   EVERY_TREATMENT_OF_THREE) {
  using real = typename TestType::real;
  TestType rule = learnt(TestType(without_floors<TestType>()), samples<real>(falling));
  const TestType before = rule;
  rule.merge(rule);
  CHECK(rule.counters().observations == 240);
  rule.update();
  CHECK(same(rule, before));
}

TEMPLATE_TEST_CASE("Without information the heuristic stays where it is", "", EVERY_TREATMENT_OF_THREE) {
  using real = typename TestType::real;
  auto options = without_floors<TestType>();
  options.start = {{real(0.25), real(0.25), real(0.5)}};
  const auto check = [&](const auto& all) {
    const TestType rule = learnt(TestType(options), all);
    CHECK(rule.status() == rule_status::no_information);
    CHECK(same(rule, TestType(options), 0));
  };
  SECTION("no samples") { check(std::vector<phimis::observation<real, 3>>()); }
  SECTION("every f is 0") {
    check(samples<real>([](double) { return 0.0; }));
  }
  SECTION("a pdf that is 0 at every sample") {
    auto all = samples<real>(f);
    for (auto& o : all) o.pdfs[1] = 0;
    check(all);
  }
  SECTION("all pdfs are the same") {
    auto all = samples<real>(f);
    for (auto& o : all) o.pdfs[1] = o.pdfs[2] = o.pdfs[0];
    const TestType rule = learnt(TestType(options), all);
    CHECK(phimis::is_density(rule.fractions()[0]));
  }
  SECTION("floors leave no choice") {
    options.floors = options.start;
    check(samples<real>(f));
  }
  SECTION("all techniques but one are frozen") {
    options.frozen = {{true, false, true}};
    check(samples<real>(f));
  }
}

TEMPLATE_TEST_CASE("A technique without samples has no equation: only the projection goes on", "",
                   EVERY_TREATMENT_OF_THREE) {
  using real = typename TestType::real;
  const auto all = three_powers::observe<real>(falling, {{40, 0, 50}}, 1);
  const TestType rule = learnt(TestType(without_floors<TestType>()), all);
  if (std::is_same<TestType, projecting<real, 3>>::value) {
    CHECK(rule.status() == rule_status::updated);
    CHECK(rule.fractions()[0] > real(0.9));
  } else {
    CHECK(rule.status() == rule_status::no_information);
  }
}

TEMPLATE_TEST_CASE("Two equal pdfs do not stop the projection", "", float, double) {
  auto all = samples<TestType>(falling);
  for (auto& o : all) o.pdfs[1] = o.pdfs[2];
  const auto rule = learnt(projecting<TestType, 3>(phimis::without_floors<TestType, 3>()), all);
  CHECK(rule.status() == rule_status::updated);
  CHECK(rule.fractions()[0] > TestType(0.8));
}

TEMPLATE_TEST_CASE("Samples of value 0 count, and bad ones are counted", "", EVERY_TREATMENT_OF_THREE) {
  using real = typename TestType::real;
  using limits = std::numeric_limits<real>;
  const auto half = [](double x) { return x < 0.5 ? 0 : x; };
  const auto all = three_powers::observe<real>(half, {{40, 30, 50}}, 3);
  const TestType whole = learnt(TestType(without_floors<TestType>()), all);
  CHECK(whole.counters().zero > 20);
  std::vector<phimis::observation<real, 3>> without_zeros;
  for (const auto& o : all) {
    if (o.f != 0) without_zeros.push_back(o);
  }
  CHECK_FALSE(same(learnt(TestType(without_floors<TestType>()), without_zeros), whole, 1e-3));

  TestType mixed(without_floors<TestType>());
  for (const auto& o : all) {
    mixed.observe(o);
    for (const real bad : {limits::quiet_NaN(), limits::infinity(), -limits::infinity()}) {
      auto spoilt = o;
      spoilt.f = bad;
      mixed.observe(spoilt);
      spoilt = o;
      spoilt.pdfs[1] = bad;
      mixed.observe(spoilt);
    }
  }
  mixed.observe({0, {{0, 0, 0}}, 1, 1});  // a lost sample
  mixed.update();
  CHECK(mixed.counters().nonfinite == 6 * 120);
  CHECK(mixed.counters().observations == 7 * 120 + 1);
  CHECK(same(mixed, whole, std::is_same<TestType, facing<real, 3>>::value ? 0.2 : tolerance<TestType>));
}

TEMPLATE_TEST_CASE("A prior pulls the heuristic to its start", "", EVERY_TREATMENT_OF_THREE) {
  using real = typename TestType::real;
  for (const auto of : {f, falling}) {
    const auto all = samples<real>(of);
    const auto at = [&](double prior) {
      auto options = without_floors<TestType>();
      options.start = {{real(0.25), real(0.45), real(0.3)}};
      options.prior = static_cast<real>(prior);
      return static_cast<double>(learnt(TestType(options), all).fractions()[1]);
    };
    const double free = at(0);
    CHECK(std::fabs(free - 0.45) > 0.05);
    CHECK(std::fabs(at(1e6) - 0.45) <= 2e-3);
    CHECK(std::fabs(at(1e4) - 0.45) < std::fabs(free - 0.45));
  }
}

TEST_CASE("The prior of the equations is prior/n P_kk (alpha_k - pi_k)") {
  const auto all = two_triangles::observe(f, 0.4, 100, 1);
  double p[2][2] = {};
  double sum[2] = {};
  for (const auto& o : all) {
    sum[o.technique] += o.f;
    for (int i = 0; i < 2; ++i) p[i][o.technique] += o.pdfs[i];
  }
  auto options = phimis::without_floors<double, 2>();
  options.start = {{0.7, 0.3}};
  options.prior = 30;
  const auto alpha = learnt(dropping<double, 2>(options), all).fractions();
  double ratio[2];
  for (int k = 0; k < 2; ++k) {
    const double left = alpha[0] * p[0][k] + alpha[1] * p[1][k] + 0.3 * p[k][k] * (alpha[k] - options.start[k]);
    ratio[k] = left / sum[k];
  }
  CHECK(ratio[0] == Approx(ratio[1]).epsilon(1e-12));
}

TEST_CASE("The best face has the least sample variance of Eq. 19") {
  // Two techniques: a negative solution leaves one of them alone.
  const auto fall = [](double x) { return 1 / (0.05 + x); };
  const auto all = two_triangles::observe(fall, 0.5, 100, 1);
  const auto rule = learnt(facing<double, 2>(phimis::without_floors<double, 2>()), all);
  REQUIRE(rule.counters().left == 1);
  double variance[2];
  for (int k = 0; k < 2; ++k) {
    phimis::moments<double> t;
    for (const auto& o : all) {
      if (o.technique == k) t.add(o.f / o.pdfs[k]);
    }
    variance[k] = t.squares;
  }
  CHECK(rule.fractions()[variance[0] < variance[1] ? 0 : 1] == 1);
}

TEST_CASE("Of faces with several techniques the best has the least sample variance as well") {
  int compared = 0;
  random_numbers random(1);
  for (std::uint64_t seed = 1; seed < 400; ++seed) {
    const double frequency = random.between(1, 8);
    const double phase = random.between(0, 6.3);
    const auto wave = [&](double x) { return 1.1 + std::cos(frequency * x + phase); };
    const auto all = three_powers::observe(wave, {{15, 10, 12}}, seed);
    const auto rule = learnt(facing<double, 3>(phimis::without_floors<double, 3>()), all);
    if (rule.counters().left == 0) continue;
    // The equations of each pair, and Eq. 19 at their solution.
    double least = 1e300;
    phimis::fractions<double, 3> best{};
    int feasible = 0;
    for (int out = 0; out < 3; ++out) {
      const int a = out == 0 ? 1 : 0;
      const int b = out == 2 ? 1 : 2;
      double p[3][3] = {};
      double sum[3] = {};
      for (const auto& o : all) {
        sum[o.technique] += o.f;
        for (int i = 0; i < 3; ++i) p[i][o.technique] += o.pdfs[i];
      }
      const double first = p[b][b] * sum[a] - p[b][a] * sum[b];
      const double second = p[a][a] * sum[b] - p[a][b] * sum[a];
      phimis::fractions<double, 3> alpha{};
      alpha[a] = first / (first + second);
      alpha[b] = second / (first + second);
      if (alpha[a] < 0 || alpha[b] < 0) continue;
      ++feasible;
      double variance = 0;
      for (int k = 0; k < 3; ++k) {
        phimis::moments<double> t;
        for (const auto& o : all) {
          if (o.technique == k) t.add(o.f / phimis::mixture(alpha, o.pdfs));
        }
        variance += alpha[k] * t.squares / static_cast<double>(t.count);
      }
      if (!(variance < least)) continue;
      least = variance;
      best = alpha;
    }
    if (feasible < 2) continue;
    ++compared;
    for (int k = 0; k < 3; ++k) CHECK(std::fabs(rule.fractions()[k] - best[k]) <= 1e-12);
  }
  CHECK(compared > 50);
}

TEST_CASE("Samples that find no room are in the sums alone") {
  linear_heuristic<double, 3, negative_fractions::best_face, phimis::fixed_table<double, 3, 20>> small(
      phimis::without_floors<double, 3>());
  const auto all = samples<double>(f);
  small = learnt(small, all);
  CHECK(small.counters().dropped == 20 + 10 + 30);
  CHECK(small.counters().observations == 120);
  const auto whole = learnt(dropping<double, 3>(phimis::without_floors<double, 3>()), all);
  if (whole.counters().left == 0) {
    for (int k = 0; k < 3; ++k) CHECK(small.fractions()[k] == Approx(whole.fractions()[k]).epsilon(1e-14));
  }
}

TEST_CASE("The sums take as much memory as the documentation says") {
  constexpr std::size_t base = sizeof(phimis::fixed_fractions<double, 4>);
  // P, F and two units; the projection's G, b and unit.
  CHECK(sizeof(dropping<double, 4>) <= base + 8 * (4 + 16 + 4 + 2) + 8);
  CHECK(sizeof(projecting<double, 4>) == base + 8 * (16 + 4 + 2) + 8 * (4 * 10 + 16 + 1));
}
