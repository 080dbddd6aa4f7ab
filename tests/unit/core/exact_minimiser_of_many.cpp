// SPDX-License-Identifier: MIT
#include "catch.hpp"
#include "divergences.hpp"
#include "random.hpp"

#include <phimis/core/divergence_at.hpp>
#include <phimis/core/exact_minimiser.hpp>
#include <phimis/core/kink.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace {

using phimis::control_variate;
using phimis::rule_status;

constexpr int M = 4;
using options = phimis::rule_options<double, M>;
using fractions = phimis::fractions<double, M>;
template <class Real>
using observations = std::vector<phimis::observation<Real, M>>;
template <class Divergence, class Real = double>
using minimiser = phimis::exact_minimiser<Divergence, phimis::fixed_table<Real, M, 600>>;

/// 1, 2x, 3(1 − x)², and a sine: densities on [0, 1].
phimis::per_technique<double, M> pdfs_at(double x) {
  return {{1, 2 * x, 3 * (1 - x) * (1 - x), 3.14159265358979323846 / 2 * std::sin(3.14159265358979323846 * x)}};
}

double interior(double x) { return 0.4 + x * x * x + std::exp(-20 * (x - 0.5) * (x - 0.5)) + (1 - x) * (1 - x); }
double with_zeros(double x) { return x < 0.2 || x > 0.9 ? 0 : std::sin(7 * x) + 1.2; }
double at_a_corner(double x) { return x * std::exp(2 * x); }

/// Uniform samples, as if the first technique had drawn them all: every density is right, and none is special.
template <class Real = double>
observations<Real> observe(double (*f)(double), int n, std::uint64_t seed) {
  random_numbers next(seed);
  observations<Real> all;
  for (int j = 0; j < n; ++j) {
    const double x = next();
    phimis::observation<Real, M> o{static_cast<Real>(f(x)), {}, 1, 0};
    for (int k = 0; k < M; ++k) o.pdfs[k] = static_cast<Real>(pdfs_at(x)[k]);
    all.push_back(o);
  }
  return all;
}

template <class Rule, class Real>
void feed(Rule& rule, const observations<Real>& all) {
  for (const auto& o : all) rule.observe(o);
}

/// The objective by its definition, in long double.
struct definition {
  std::vector<long double> f, q;
  std::vector<std::vector<long double>> p;
  long double kappa[M];  // what scales each pdf: normalisation on the sample, over the cost
  long double unit = 1;  // of f
  long double zero = 0;  // s(0), which is subtracted where pdfs are not normalised

  template <class Divergence, class Real>
  definition(const Divergence& divergence, const observations<Real>& all, control_variate variate,
             const options& given = {}) {
    long double mass[M] = {};
    long double mean = 0;
    const long double n = static_cast<long double>(all.size());
    for (const auto& o : all) {
      f.push_back(std::fabs(static_cast<long double>(o.f)));
      q.push_back(o.q);
      p.emplace_back();
      for (int k = 0; k < M; ++k) {
        p.back().push_back(o.pdfs[k]);
        mass[k] += p.back().back() / q.back();
      }
      mean += f.back() / q.back() / n;
    }
    for (int k = 0; k < M; ++k) kappa[k] = (variate == control_variate::on ? n / mass[k] : 1) / given.costs[k];
    if (phimis::detail::needs_mean(divergence)) unit = 1 / mean;
    if (variate == control_variate::off) zero = phimis::score_at_zero(divergence);
  }

  /// −∂/∂α_k of the objective at p = Σ α_k p_k / Σ α_k/κ_k, and λ. The pdfs scaled by κ have the shares α_k/κ_k.
  template <class Divergence>
  std::vector<long double> slopes(const Divergence& divergence, const fractions& alpha, long double& lambda) const {
    long double shares = 0;
    for (int k = 0; k < M; ++k) shares += alpha[k] / kappa[k];
    long double g[M] = {};
    long double along = 0;
    lambda = 0;
    for (std::size_t j = 0; j < f.size(); ++j) {
      long double mixture = 0;
      for (int k = 0; k < M; ++k) mixture += alpha[k] / shares * p[j][static_cast<std::size_t>(k)];
      if (!(mixture > 0)) continue;
      auto s = phimis::score_at(divergence, unit * f[j] / mixture);
      s.value -= zero;
      for (int k = 0; k < M; ++k) g[k] += p[j][static_cast<std::size_t>(k)] / q[j] * s.value;
      along += mixture / q[j] * s.value;
      lambda += mixture / q[j] * (std::fabs(s.value) + s.slope);
    }
    std::vector<long double> result;
    for (int k = 0; k < M; ++k) result.push_back((g[k] - along / kappa[k]) / shares);
    return result;
  }

  /// The largest violation of: slopes equal above the floors, not larger at them; relative to λ.
  template <class Divergence>
  double violation(const Divergence& divergence, const fractions& alpha, const options& given) const {
    long double lambda = 0;
    const auto slope = slopes(divergence, alpha, lambda);
    long double level = 0;
    long double above = 0;
    for (std::size_t k = 0; k < M; ++k) {
      const int i = static_cast<int>(k);
      const long double free = given.frozen[i] ? 0.0L : alpha[i] - static_cast<long double>(given.floors[i]);
      level += free * slope[k];
      above += free;
    }
    level /= above;
    long double worst = 0;
    for (std::size_t k = 0; k < M; ++k) {
      const int i = static_cast<int>(k);
      if (given.frozen[i]) continue;
      const long double excess = slope[k] - level;
      worst = std::max(worst, alpha[i] > given.floors[i] ? std::fabs(excess) : excess);
    }
    return static_cast<double>(worst / lambda);
  }
};

options with(const phimis::per_technique<double, M>& floors) {
  options result;
  result.floors = floors;
  return result;
}

double sum_of(const fractions& alpha) { return alpha[0] + alpha[1] + alpha[2] + alpha[3]; }

/// Kinks are rounded off within 1e-6 where there are more than two techniques; their conditions are not those of φ.
template <class Divergence>
bool has_kink(const Divergence& divergence) {
  if constexpr (phimis::detail::can_round_off<Divergence>::value) {
    return phimis::has_sharp_kink(divergence);
  } else {
    return false;
  }
}

}  // namespace

TEST_CASE("Four fractions satisfy the conditions of optimality for every divergence, floor and integrand") {
  for (double (*f)(double) : {interior, with_zeros, at_a_corner}) {
    const auto all = observe(f, 300, 7);
    for (const auto& floors : {phimis::per_technique<double, M>{}, {{0.1, 0, 0.05, 0.2}}, {{0.3, 0.3, 0.3, 0.05}}}) {
      for (const auto variate : {control_variate::on, control_variate::off}) {
        for_each_divergence([&](const char* name, const auto& divergence) {
          CAPTURE(name, floors[0], static_cast<int>(variate));
          minimiser<std::decay_t<decltype(divergence)>> rule(divergence, with(floors), variate);
          feed(rule, all);
          const rule_status status = rule.update();
          if (f == with_zeros && phimis::infinite_at_zero(divergence)) {
            CHECK(status == rule_status::infinite_divergence);
            return;
          }
          REQUIRE(status == rule_status::updated);
          CHECK(rule.residual() <= 1e-10);
          CHECK(std::fabs(sum_of(rule.fractions()) - 1) <= 4e-16);
          for (int k = 0; k < M; ++k) CHECK(rule.fractions()[k] >= floors[k]);
          if (has_kink(divergence)) return;
          const definition on(divergence, all, variate);
          CHECK(on.violation(divergence, rule.fractions(), rule.options()) <= 1e-10);
        });
      }
    }
  }
}

TEST_CASE("The conditions hold in float to its digits") {
  const auto all = observe<float>(interior, 300, 3);
  minimiser<phimis::chi_squared, float> rule{};
  feed(rule, all);
  REQUIRE(rule.update() == rule_status::updated);
  fractions alpha{};
  options given;
  for (int k = 0; k < M; ++k) {
    alpha[k] = static_cast<double>(rule.fractions()[k]);
    given.floors[k] = static_cast<double>(rule.options().floors[k]);
  }
  const definition on(phimis::chi_squared{}, all, control_variate::on);
  CHECK(on.violation(phimis::chi_squared{}, alpha, given) <= 1e-5);  // a hundred roundings of float
}

TEST_CASE("Total variation of four techniques is least within its gap") {
  const auto all = observe(interior, 200, 5);
  minimiser<phimis::total_variation> rule(phimis::total_variation{}, with({}), control_variate::off);
  feed(rule, all);
  REQUIRE(rule.update() == rule_status::updated);
  CHECK(rule.gap() <= 2e-6);
  double mean = 0;
  for (const auto& o : all) mean += o.f / o.q / 200;
  const auto objective = [&](const fractions& alpha) {
    double sum = 0;
    for (const auto& o : all) {
      // Less φ(0) ∫p, which is a constant of normalised pdfs: the score is then 0 where f is.
      const double p = phimis::mixture(alpha, o.pdfs);
      sum += (std::fabs(o.f / mean - p) - p) / o.q / 2;
    }
    return sum;
  };
  const double found = objective(rule.fractions());
  random_numbers next(1);
  for (int i = 0; i < 2000; ++i) {
    // Others, near and far: none is better by more than the gap, of which λ is at most Σ p/q.
    fractions other{};
    double sum = 0;
    const double reach = next.over_decades(1e-6, 1);
    for (int k = 0; k < M; ++k) sum += other[k] = std::max(0.0, rule.fractions()[k] + reach * next.between(-1, 1));
    if (!(sum > 0)) continue;
    for (int k = 0; k < M; ++k) other[k] /= sum;
    CHECK(objective(other) >= found - rule.gap() * 400);
  }
}

TEST_CASE("A zero-variance mixture of four is found from any sample") {
  auto all = observe(interior, 60, 11);
  const fractions truth{{0.1, 0.2, 0.3, 0.4}};
  for (auto& o : all) o.f = 7e5 * phimis::mixture(truth, o.pdfs);
  for_each_divergence([&](const char* name, const auto& divergence) {
    // A score without slope at t = 1 knows the mixture only through its kink.
    if (has_kink(divergence)) return;
    CAPTURE(name);
    minimiser<std::decay_t<decltype(divergence)>> rule(divergence, with({}));
    feed(rule, all);
    rule.update();
    // With normalised pdfs f/p is constant exactly where α is; a cubic φ is flat there.
    const double error = std::string(name).find("Vajda 3") != std::string::npos ? 1e-4 : 1e-9;
    for (int k = 0; k < M; ++k) CHECK(std::fabs(rule.fractions()[k] - truth[k]) <= error);
  });
}

TEST_CASE("Frozen techniques stay at the start and the others are optimal beside them") {
  const auto all = observe(interior, 300, 13);
  options given;
  given.start = {{0.1, 0.35, 0.25, 0.3}};
  given.floors = {};
  given.frozen = {{false, true, false, false}};
  minimiser<phimis::kullback_leibler> rule(phimis::kullback_leibler{}, given);
  feed(rule, all);
  REQUIRE(rule.update() == rule_status::updated);
  CHECK(rule.fractions()[1] == 0.35);
  const definition on(phimis::kullback_leibler{}, all, control_variate::on);
  CHECK(on.violation(phimis::kullback_leibler{}, rule.fractions(), given) <= 1e-12);
}

TEST_CASE("With three of four frozen there is nothing to learn") {
  options given;
  given.frozen = {{true, true, false, true}};
  minimiser<phimis::kullback_leibler> rule(phimis::kullback_leibler{}, given);
  feed(rule, observe(interior, 50, 13));
  CHECK(rule.update() == rule_status::no_information);
  CHECK(rule.fractions()[2] == 0.25);
}

TEMPLATE_TEST_CASE("Costs divide the densities of positive powers", "", phimis::chi_squared, phimis::kullback_leibler,
                   phimis::hellinger) {
  const auto all = observe(interior, 300, 17);
  options given;
  given.costs = {{1, 3, 0.5, 2}};
  given.floors = {{0.02, 0.02, 0.02, 0.02}};
  minimiser<TestType> rule(TestType{}, given);
  feed(rule, all);
  REQUIRE(rule.update() == rule_status::updated);
  const definition on(TestType{}, all, control_variate::on, given);
  CHECK(on.violation(TestType{}, rule.fractions(), given) <= 1e-10);

  minimiser<TestType> free_of_cost(TestType{}, with(given.floors));
  feed(free_of_cost, all);
  free_of_cost.update();
  const auto cost = [&](const fractions& alpha) { return phimis::mixture(alpha, given.costs); };
  CHECK(cost(rule.fractions()) < cost(free_of_cost.fractions()) - 0.01);
}

namespace {

/// V[F] and V[ℱ] times cost, by their definitions on a sample of pdfs that are taken as they are.
double cost_times_variance(const observations<double>& all, const options& given, const fractions& alpha,
                           phimis::sampling_model model) {
  long double second = 0;
  long double mu = 0;
  long double means[M] = {};
  const long double n = static_cast<long double>(all.size());
  for (const auto& o : all) {
    const long double p = phimis::mixture(alpha, o.pdfs);
    second += static_cast<long double>(o.f) * o.f / p / o.q / n;
    mu += static_cast<long double>(o.f) / o.q / n;
    for (int k = 0; k < M; ++k) means[k] += static_cast<long double>(o.f) * o.pdfs[k] / p / o.q / n;
  }
  long double squares = mu * mu;
  if (model == phimis::sampling_model::multi_sample) {
    squares = 0;
    for (int k = 0; k < M; ++k) squares += alpha[k] * means[k] * means[k];
  }
  return static_cast<double>((second - squares) * phimis::mixture(alpha, given.costs));
}

double changes_sign(double x) { return std::cos(5 * x) + 0.3; }

}  // namespace

TEMPLATE_TEST_CASE("Cost times variance is least where the rule says", "", phimis::one_sample_variance,
                   phimis::multi_sample_variance) {
  constexpr bool multi = std::is_same<TestType, phimis::multi_sample_variance>::value;
  const auto model = multi ? phimis::sampling_model::multi_sample : phimis::sampling_model::one_sample;
  for (double (*f)(double) : {interior, changes_sign}) {
    const auto all = observe(f, 200, 19);
    for (const auto& costs : {phimis::equal_costs<double, M>(), {{1, 3, 0.5, 2}}, {{1, 30, 1, 1}}}) {
      options given;
      given.costs = costs;
      given.floors = {{0.05, 0.01, 0.02, 0}};
      minimiser<TestType> rule(TestType{}, given, control_variate::off);
      feed(rule, all);
      const rule_status status = rule.update();
      CHECK(status == (multi ? rule_status::local : rule_status::updated));
      CHECK(rule.residual() <= 1e-10);
      const double least = cost_times_variance(all, given, rule.fractions(), model);
      random_numbers next(23);
      for (int i = 0; i < 3000; ++i) {
        // Half of the others lie within 1e-5, which tells a minimum from a point nearby; the other half anywhere.
        fractions other{};
        const double reach = i % 2 == 0 ? 1e-5 : 1;
        for (int k = 0; k < M; ++k) other[k] = std::max(0.0, rule.fractions()[k] + reach * next.between(-1, 1));
        other = phimis::with_floors(other, given.floors);
        // On these samples the local minimum of V[F] is the global one.
        CHECK(cost_times_variance(all, given, other, model) >= least * (1 - 1e-12));
      }
    }
  }
}

TEST_CASE("Two techniques with different costs: cost times variance") {
  phimis::rule_options<double, 2> given;
  given.costs = {{1, 5}};
  phimis::exact_minimiser<phimis::one_sample_variance, phimis::fixed_table<double, 2, 300>> rule(
      phimis::one_sample_variance{}, given, control_variate::off);
  const auto all = observe(interior, 300, 29);
  for (const auto& o : all) rule.observe({o.f, {{o.pdfs[1], o.pdfs[2]}}, o.q, 0});
  REQUIRE(rule.update() == rule_status::updated);
  const auto objective = [&](double first) {
    double second = 0;
    double mu = 0;
    for (const auto& o : all) {
      second += o.f * o.f / (first * o.pdfs[1] + (1 - first) * o.pdfs[2]) / o.q / 300;
      mu += o.f / o.q / 300;
    }
    return (second - mu * mu) * (first + 5 * (1 - first));
  };
  const double first = rule.fractions()[0];
  for (int i = 1; i < 1000; ++i) {
    const double other = 0.01 + 0.98 * i / 1000;
    CHECK(objective(other) >= objective(first) * (1 - 1e-12));
  }
}

TEST_CASE("A technique without density at any observation keeps its fraction") {
  auto all = observe(interior, 100, 31);
  for (auto& o : all) o.pdfs[2] = 0;
  options given;
  given.start = {{0.4, 0.2, 0.1, 0.3}};
  minimiser<phimis::chi_squared> rule(phimis::chi_squared{}, given);
  feed(rule, all);
  REQUIRE(rule.update() == rule_status::updated);
  CHECK(rule.fractions()[2] == 0.1);
  CHECK(rule.fractions()[0] != 0.4);
}

TEST_CASE("Duplicate techniques, and fewer observations than techniques, are no obstacle") {
  auto all = observe(interior, 100, 37);
  for (auto& o : all) o.pdfs[3] = o.pdfs[1];
  for (const std::size_t n : {std::size_t{100}, std::size_t{3}, std::size_t{1}}) {
    const observations<double> some(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(n));
    for_each_divergence([&](const char* name, const auto& divergence) {
      CAPTURE(name, n);
      minimiser<std::decay_t<decltype(divergence)>> rule(divergence, with({}), control_variate::off);
      feed(rule, some);
      REQUIRE(rule.update() == rule_status::updated);
      CHECK(rule.residual() <= 1e-9);
    });
  }
}

TEST_CASE("The scale of f and the measure change no fraction of four") {
  const auto all = observe(interior, 200, 41);
  minimiser<phimis::tsallis> plain(phimis::tsallis{4});
  feed(plain, all);
  plain.update();
  for (const double scale : {1e-300, 1e-30, 1e30, 1e300}) {
    minimiser<phimis::tsallis> rule(phimis::tsallis{4});
    for (auto o : all) {
      o.f *= scale;
      o.q *= 1e-5;
      for (int k = 0; k < M; ++k) o.pdfs[k] *= 1e-5;
      rule.observe(o);
    }
    REQUIRE(rule.update() == rule_status::updated);
    for (int k = 0; k < M; ++k) CHECK(std::fabs(rule.fractions()[k] - plain.fractions()[k]) <= 1e-12);
  }
}

TEST_CASE("Merged states of four techniques learn what one state would") {
  const auto all = observe(interior, 200, 43);
  minimiser<phimis::chi_squared> whole;
  minimiser<phimis::chi_squared> first;
  minimiser<phimis::chi_squared> second;
  feed(whole, all);
  for (std::size_t j = 0; j < all.size(); ++j) (j % 3 == 0 ? first : second).observe(all[j]);
  first.merge(second);
  whole.update();
  first.update();
  for (int k = 0; k < M; ++k) CHECK(std::fabs(first.fractions()[k] - whole.fractions()[k]) <= 1e-13);
}

TEST_CASE("A corner is left again when new observations ask for it") {
  minimiser<phimis::chi_squared> rule(phimis::chi_squared{}, with({}));
  feed(rule, observe(at_a_corner, 100, 47));
  REQUIRE(rule.update() == rule_status::updated);
  CHECK(rule.fractions()[2] == 0);
  feed(rule, observe(interior, 400, 48));
  REQUIRE(rule.update() == rule_status::updated);
  CHECK(rule.fractions()[2] > 0.05);
}

TEST_CASE("A prior of many samples holds four fractions at the start") {
  options given;
  given.start = {{0.4, 0.2, 0.1, 0.3}};
  given.prior = 1e6;
  minimiser<phimis::chi_squared> rule(phimis::chi_squared{}, given);
  feed(rule, observe(interior, 100, 53));
  REQUIRE(rule.update() == rule_status::updated);
  for (int k = 0; k < M; ++k) CHECK(std::fabs(rule.fractions()[k] - given.start[k]) <= 1e-3);
}

TEST_CASE("A prior of many samples holds fractions at the start where few observations show pdfs far from normalised") {
  options given;
  given.start = {{0.4, 0.2, 0.1, 0.3}};
  given.prior = 1e7;
  const auto check = [&](const auto& divergence) {
    for (const auto variate : {control_variate::on, control_variate::off}) {
      minimiser<std::decay_t<decltype(divergence)>> rule(divergence, given, variate);
      feed(rule, observe(interior, 4, 54));
      rule.update();
      for (int k = 0; k < M; ++k) CHECK(std::fabs(rule.fractions()[k] - given.start[k]) <= 1e-5);
    }
  };
  check(phimis::kullback_leibler{});
  check(phimis::chi_squared{});
  check(phimis::reversed<phimis::kullback_leibler>{});
  check(phimis::multi_sample_variance{});
}
