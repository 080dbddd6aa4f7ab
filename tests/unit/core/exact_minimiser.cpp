// SPDX-License-Identifier: MIT
#include "catch.hpp"
#include "divergences.hpp"
#include "two_triangles.hpp"

#include <phimis/core/divergence_at.hpp>
#include <phimis/core/exact_minimiser.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <vector>

namespace {

using phimis::control_variate;
using phimis::rule_options;
using phimis::rule_status;

template <class Real>
using observations = std::vector<phimis::observation<Real, 2>>;
template <class Divergence, class Real>
using minimiser = phimis::exact_minimiser<Divergence, phimis::fixed_table<Real, 2, 400>>;

double interior(double x) { return 0.3 + x * x; }
double falling(double x) { return 2 * (1 - x) * (1 - x); }
double with_zeros(double x) { return x < 0.2 || x > 0.9 ? 0 : std::sin(7 * x) + 1.2; }

/// Two batches, drawn at fractions that differ: each sample with the density that it was drawn from.
template <class Real>
observations<Real> two_batches(double (*f)(double), int n, std::uint64_t seed) {
  auto all = two_triangles::observe<Real>(f, 0.5, n / 2, seed);
  for (const auto& o : two_triangles::observe<Real>(f, 0.2, n - n / 2, seed + 1)) all.push_back(o);
  return all;
}

template <class Real>
observations<double> in_double(const observations<Real>& all) {
  observations<double> result;
  for (const auto& o : all) result.push_back({o.f, {{o.pdfs[0], o.pdfs[1]}}, o.q, o.technique});
  return result;
}

/// The problem on the observations by its definition, in long double.
struct definition {
  struct term {
    long double f, p1, p2, q;
  };
  std::vector<term> terms;
  long double kappa1 = 1, kappa2 = 1;  // what makes each pdf integrate to one on the sample
  long double mean = 0;                // μ̂ = Σ f/q / n

  template <class Real>
  definition(const observations<Real>& all, control_variate variate) {
    long double mass1 = 0, mass2 = 0;
    const long double n = static_cast<long double>(all.size());
    for (const auto& o : all) {
      terms.push_back({std::fabs(static_cast<long double>(o.f)), o.pdfs[0], o.pdfs[1], o.q});
      mass1 += terms.back().p1 / terms.back().q;
      mass2 += terms.back().p2 / terms.back().q;
      mean += terms.back().f / terms.back().q / n;
    }
    if (variate == control_variate::on) {
      kappa1 = n / mass1;
      kappa2 = n / mass2;
    }
  }

  /// p(α) of a term up to a factor, as the sum of normalised pdfs whose shares are a convex combination.
  long double mixture(const term& at, long double a1, long double a2) const {
    const long double b1 = a1 / kappa1, b2 = a2 / kappa2;
    return (b1 * kappa1 * at.p1 + b2 * kappa2 * at.p2) / (b1 + b2);
  }

  struct condition {
    long double first, second, lambda;  // G_1, G_2 and the scale that a residual is relative to
  };
  template <class Divergence>
  condition at(const Divergence& divergence, long double a1, long double a2) const {
    condition sums{0, 0, 0};
    for (const term& j : terms) {
      const long double p = mixture(j, a1, a2);
      auto s = phimis::score_at(divergence, j.f > 0 ? j.f / mean / p : 0.0L);
      s.value -= phimis::score_at_zero(divergence);
      sums.first += kappa1 * j.p1 / j.q * s.value;
      sums.second += kappa2 * j.p2 / j.q * s.value;
      sums.lambda += p / j.q * (std::fabs(s.value) + (phimis::has_exponent<Divergence>::value ? 0 : s.slope));
    }
    return sums;
  }

  struct objective {
    long double value, size;
  };
  /// Σ p/q (φ(g/p) − φ(0)), where φ(0) is finite: the constant that makes a lost sample worth nothing.
  template <class Divergence>
  objective divergence(const Divergence& of, long double a1, long double a2) const {
    objective sum{0, 0};
    for (const term& j : terms) {
      const long double p = mixture(j, a1, a2);
      const long double phi = j.f > 0 ? true_phi_at(of, j.f / mean / p).value : phimis::phi_at(of, 0.0L);
      const long double part = p > 0 ? p / j.q * (phi + phimis::score_at_zero(of)) : 0;
      sum.value += part;
      sum.size += std::fabs(part);
    }
    return sum;
  }
};

template <class Divergence, class Real>
minimiser<Divergence, Real> learn(const Divergence& divergence, const observations<Real>& all, control_variate variate,
                                  const phimis::rule_options<Real, 2>& options = phimis::without_floors<Real, 2>()) {
  minimiser<Divergence, Real> rule(divergence, options, variate);
  for (const auto& o : all) rule.observe(o);
  rule.update();
  return rule;
}

template <class Divergence>
constexpr bool is_step() {
  return std::is_same<Divergence, phimis::total_variation>::value ||
         std::is_same<Divergence, phimis::reversed<phimis::total_variation>>::value;
}
/// Whether s jumps: the condition then has a sign change in place of a root.
inline bool steps(const phimis::pearson_vajda& d) { return d.k == 1; }
inline bool steps(const phimis::reversed<phimis::pearson_vajda>& d) { return d.forward.k == 1; }
template <class Divergence>
bool steps(const Divergence&) {
  return is_step<Divergence>();
}

}  // namespace

TEMPLATE_TEST_CASE("The fractions satisfy the optimality condition from any start, for every divergence", "", float,
                   double) {
  const bool single = std::is_same<TestType, float>::value;
  const long double tolerance = single ? 1e-5L : 1e-12L;
  for (double (*f)(double) : {interior, falling, with_zeros}) {
    const auto all = two_batches<TestType>(f, 200, 1);
    for (const auto variate : {control_variate::on, control_variate::off}) {
      const definition problem(all, variate);
      for_each_divergence([&](const char* name, const auto& divergence) {
        if (f == with_zeros && phimis::infinite_at_zero(divergence)) return;
        for (const double start : {0.0, 1e-9, 0.5, 0.999, 1.0}) {
          INFO(name << (variate == control_variate::on ? ", control variate" : "") << ", start " << start << ", f "
                    << (f == interior ? "interior" : f == falling ? "falling" : "with zeros"));
          auto options = phimis::without_floors<TestType, 2>();
          options.start = {{static_cast<TestType>(start), static_cast<TestType>(1 - start)}};
          const auto rule = learn(divergence, all, variate, options);
          CHECK(rule.status() == rule_status::updated);
          CHECK(rule.evaluations() <= 100);
          const long double a1 = rule.fractions()[0], a2 = rule.fractions()[1];
          REQUIRE(a1 >= 0);
          REQUIRE(a2 >= 0);
          REQUIRE(std::fabs(a1 + a2 - 1) <= std::numeric_limits<TestType>::epsilon());
          const auto at = problem.at(divergence, a1, a2);
          const long double residual = (at.first - at.second) / at.lambda;
          if (steps(divergence) && single) {
            // Rounding of t moves the step; the divergence is off by no more than its own rounding.
            const auto best = learn(divergence, in_double(all), variate);
            const auto found = problem.divergence(divergence, a1, a2);
            const auto least = problem.divergence(divergence, best.fractions()[0], best.fractions()[1]);
            CHECK(found.value - least.value <= 8 * std::numeric_limits<TestType>::epsilon() * found.size);
          } else if (steps(divergence)) {
            // The condition changes sign within a few last digits.
            const long double step = 1e-13L * std::min(a1, a2);
            const auto below = problem.at(divergence, a1 - step, a2 + step);
            const auto above = problem.at(divergence, a1 + step, a2 - step);
            CHECK((a1 == 0 || below.first >= below.second));
            CHECK((a2 == 0 || above.first <= above.second));
          } else if (a1 == 0) {
            CHECK(residual <= tolerance);
          } else if (a2 == 0) {
            CHECK(residual >= -tolerance);
          } else {
            CHECK(std::fabs(residual) <= tolerance);
          }
        }
      });
    }
  }
}

TEST_CASE("No fractions on a dense grid have a smaller divergence") {
  for (double (*f)(double) : {interior, falling, with_zeros}) {
    const auto all = two_batches<double>(f, 60, 2);
    for (const auto variate : {control_variate::on, control_variate::off}) {
      const definition problem(all, variate);
      for_each_divergence([&](const char* name, const auto& divergence) {
        using divergence_type = std::decay_t<decltype(divergence)>;
        if (f == with_zeros && phimis::infinite_at_zero(divergence)) return;
        // Where pdfs are not normalised on the sample, φ and φ + c(t − 1) differ: powers drop such a term.
        constexpr bool drops_a_term = phimis::has_exponent<divergence_type>::value &&
                                      !std::is_same<divergence_type, phimis::kullback_leibler>::value;
        if (variate == control_variate::off && drops_a_term) return;
        INFO(name << (variate == control_variate::on ? ", control variate" : ""));
        const auto rule = learn(divergence, all, variate);
        const auto found = problem.divergence(divergence, rule.fractions()[0], rule.fractions()[1]);
        long double least = found.value;
        for (int i = 0; i <= 1000; ++i) {
          const long double a = i / 1000.0L;
          const auto at = problem.divergence(divergence, a, 1 - a);
          if (at.value < least) least = at.value;
        }
        CHECK(found.value - least <= 1e-13L * found.size);
      });
    }
  }
}

TEMPLATE_TEST_CASE("A mixture without variance is found exactly from 20 samples", "", float, double) {
  // f = μ p(α): with the control variate every score is the same there. 20 samples round a few times each.
  const double tolerance = 2000 * static_cast<double>(std::numeric_limits<TestType>::epsilon());
  for (const double alpha : {0.3, 0.01, 0.85}) {
    const auto f = [alpha](double x) { return 7 * (alpha * two_triangles::p1(x) + (1 - alpha) * two_triangles::p2(x)); };
    const auto all = two_triangles::observe<TestType>(f, 0.5, 20, 3);
    for_each_divergence([&](const char* name, const auto& divergence) {
      INFO(name << ", alpha " << alpha);
      const auto rule = learn(divergence, all, control_variate::on);
      CHECK(rule.status() == rule_status::updated);
      CHECK(std::fabs(static_cast<double>(rule.fractions()[0]) - alpha) <= tolerance);
    });
    // Without it the noise of the sample remains.
    const auto noisy = learn(phimis::chi_squared{}, all, control_variate::off);
    CHECK(std::fabs(static_cast<double>(noisy.fractions()[0]) - alpha) > 1e-3);
  }
}

TEMPLATE_TEST_CASE("An integrand that is one technique's pdf takes that technique alone", "", float, double) {
  const auto all = two_triangles::observe<TestType>(two_triangles::p1, 0.5, 100, 4);
  for (const auto variate : {control_variate::on, control_variate::off}) {
    auto options = phimis::without_floors<TestType, 2>();
    options.floors = {{TestType(0.05), TestType(0.1)}};
    for_each_divergence([&](const char* name, const auto& divergence) {
      INFO(name);
      const auto floored = learn(divergence, all, variate, options);
      CHECK(floored.fractions()[1] == TestType(0.1));
      CHECK(floored.fractions()[0] == TestType(0.9));
      CHECK(floored.status() == rule_status::updated);
    });
  }
}

TEMPLATE_TEST_CASE("A technique that alone reaches f keeps a fraction", "", float, double) {
  // A tenth of the samples are where only the second technique has density, from a start that never uses it.
  auto all = two_triangles::observe<TestType>(two_triangles::p1, 0.5, 90, 5);
  for (int j = 0; j < 10; ++j) all.push_back({1, {{0, 2}}, 1, 1});
  for (const double gamma : {0.1, 1.0, 3.0}) {
    auto options = phimis::without_floors<TestType, 2>();
    options.start = {{1, 0}};
    const auto rule = learn(phimis::tsallis{gamma}, all, control_variate::on, options);
    CHECK(rule.status() == rule_status::updated);
    CHECK(rule.fractions()[1] > TestType(0.001));
    const definition problem(all, control_variate::on);
    const auto at = problem.at(phimis::tsallis{gamma}, rule.fractions()[0], rule.fractions()[1]);
    CHECK(std::fabs(at.first - at.second) <= (std::is_same<TestType, float>::value ? 1e-5L : 1e-12L) * at.lambda);
  }
}

TEMPLATE_TEST_CASE("One observation is no proof: with the control variate it moves nothing, without it takes the larger pdf",
                   "", float, double) {
  const observations<TestType> one{{3, {{1, 2}}, 1, 0}};
  const auto with = learn(phimis::chi_squared{}, one, control_variate::on);
  CHECK(std::fabs(with.fractions()[0] - TestType(0.5)) <= std::numeric_limits<TestType>::epsilon());
  const auto without = learn(phimis::chi_squared{}, one, control_variate::off);
  CHECK(without.fractions()[0] == 0);
  CHECK(without.fractions()[1] == 1);
}

TEMPLATE_TEST_CASE("No scale of f changes a fraction", "", float, double) {
  const bool single = std::is_same<TestType, float>::value;
  const TestType tolerance = 2000 * std::numeric_limits<TestType>::epsilon();
  const auto all = two_batches<TestType>(interior, 100, 6);
  for (const auto variate : {control_variate::on, control_variate::off}) {
    for (const TestType prior : {TestType(0), TestType(10)}) {
      auto options = phimis::without_floors<TestType, 2>();
      options.prior = prior;
      for_each_divergence([&](const char* name, const auto& divergence) {
        INFO(name << ", prior " << prior);
        const TestType wanted = learn(divergence, all, variate, options).fractions()[0];
        for (const double scale : {single ? 1e-30 : 1e-300, single ? 1e30 : 1e300, -1.0}) {
          auto scaled = all;
          for (auto& o : scaled) o.f *= static_cast<TestType>(scale);
          INFO("scale " << scale);
          CHECK(std::fabs(learn(divergence, scaled, variate, options).fractions()[0] - wanted) <= tolerance);
        }
      });
      const TestType wanted = learn(phimis::multi_sample_variance{}, all, variate, options).fractions()[0];
      for (const double scale : {single ? 1e-30 : 1e-300, single ? 1e30 : 1e300}) {
        auto scaled = all;
        for (auto& o : scaled) o.f *= static_cast<TestType>(scale);
        CHECK(std::fabs(learn(phimis::multi_sample_variance{}, scaled, variate, options).fractions()[0] - wanted) <=
              tolerance);
      }
    }
  }
}

TEMPLATE_TEST_CASE("Merged states are one state, in any grouping", "", float, double) {
  const auto all = two_batches<TestType>(interior, 300, 7);
  const TestType tolerance = 2000 * std::numeric_limits<TestType>::epsilon();
  random_numbers random(8);
  using rule_type = minimiser<phimis::hellinger, TestType>;
  rule_type whole;
  std::vector<rule_type> groups(8);
  for (const auto& o : all) {
    whole.observe(o);
    groups[random.bits() % 7].observe(o);
  }
  groups[2].update();  // what a group has learnt before is no matter
  while (groups.size() > 1) {
    groups[random.bits() % (groups.size() - 1)].merge(groups.back());
    groups.pop_back();
  }
  CHECK(groups[0].counters().observations == 300);
  CHECK(groups[0].table().size() == 300);
  CHECK(whole.update() == rule_status::updated);
  CHECK(groups[0].update() == rule_status::updated);
  CHECK(std::fabs(groups[0].fractions()[0] - whole.fractions()[0]) <= tolerance);
  static_assert(std::is_trivially_copyable<rule_type>::value, "");
}

TEMPLATE_TEST_CASE("Updates go on from all observations, not from the last fractions", "", float, double) {
  const auto all = two_batches<TestType>(interior, 200, 9);
  minimiser<phimis::kullback_leibler, TestType> often;
  for (std::size_t j = 0; j < all.size(); ++j) {
    often.observe(all[j]);
    if (j % 20 == 19) often.update();
  }
  const auto once = learn(phimis::kullback_leibler{}, all, control_variate::on);
  CHECK(std::fabs(often.fractions()[0] - once.fractions()[0]) <= 200 * std::numeric_limits<TestType>::epsilon());
  CHECK(often.evaluations() <= 10);
}

TEST_CASE("What finds the table full is counted as dropped, and the kept rows are a sound problem") {
  const auto first = two_triangles::observe(interior, 0.5, 50, 10);
  const auto second = two_triangles::observe(interior, 0.05, 50, 11);
  phimis::exact_minimiser<phimis::chi_squared, phimis::fixed_table<double, 2, 50>> full, other;
  for (const auto& o : first) full.observe(o);
  for (const auto& o : second) full.observe(o);
  CHECK(full.counters().observations == 100);
  CHECK(full.counters().dropped == 50);
  CHECK(full.table().size() == 50);
  full.update();
  CHECK(std::fabs(full.fractions()[0] - learn(phimis::chi_squared{}, first, control_variate::on).fractions()[0]) <= 1e-13);
  for (const auto& o : second) other.observe(o);
  full.merge(other);
  CHECK(full.counters().dropped == 100);
  CHECK(full.counters().observations == 150);
}

TEST_CASE("What is dropped changes no fraction, however large it is") {
  using rule_type = phimis::exact_minimiser<phimis::chi_squared, phimis::fixed_table<double, 2, 50>>;
  rule_type kept, huge;
  for (auto o : two_triangles::observe(interior, 0.5, 50, 12)) {
    kept.observe(o);
    o.f *= 1e250;
    huge.observe(o);
  }
  rule_type alone = kept;
  alone.update();
  kept.merge(huge);
  CHECK(kept.counters().dropped == 50);
  CHECK(kept.update() == rule_status::updated);
  CHECK(std::fabs(kept.fractions()[0] - alone.fractions()[0]) <= 1e-12);
}

TEMPLATE_TEST_CASE("A divergence that is infinite at f = 0 says so and leaves the fractions", "", float, double) {
  const auto all = two_batches<TestType>(with_zeros, 100, 13);
  auto options = phimis::without_floors<TestType, 2>();
  options.start = {{TestType(0.25), TestType(0.75)}};
  for_each_divergence([&](const char* name, const auto& divergence) {
    INFO(name);
    const auto rule = learn(divergence, all, control_variate::on, options);
    if (phimis::infinite_at_zero(divergence)) {
      CHECK(rule.status() == rule_status::infinite_divergence);
      CHECK(rule.fractions()[0] == TestType(0.25));
    } else {
      CHECK(rule.status() == rule_status::updated);
      CHECK(rule.fractions()[0] != TestType(0.25));
    }
  });
}

TEST_CASE("With a prior, Kullback-Leibler is the most likely mixture under a Dirichlet prior") {
  // Σ_j (f_j/q_j) log p_j(α) + prior μ̂ Σ_k π_k log α_k, its maximum by golden section in long double.
  const auto all = two_batches<double>(interior, 60, 14);
  for (const double prior : {0.5, 10.0, 300.0}) {
    for (const double pi : {0.1, 0.5, 0.8}) {
      const definition problem(all, control_variate::off);
      const auto likelihood = [&](long double a) {
        long double sum = 0;
        for (const auto& j : problem.terms) sum += j.f / j.q * std::log(a * j.p1 + (1 - a) * j.p2);
        return sum + prior * problem.mean * (pi * std::log(a) + (1 - pi) * std::log(1 - a));
      };
      long double low = 1e-9L, high = 1 - 1e-9L;
      const long double golden = (std::sqrt(5.0L) - 1) / 2;
      for (int i = 0; i < 120; ++i) {
        const long double x = high - golden * (high - low), y = low + golden * (high - low);
        (likelihood(x) < likelihood(y) ? low : high) = likelihood(x) < likelihood(y) ? x : y;
      }
      auto options = phimis::without_floors<double, 2>();
      options.start = {{pi, 1 - pi}};
      options.prior = prior;
      const auto rule = learn(phimis::kullback_leibler{}, all, control_variate::off, options);
      // A maximum is known to the square root of the precision of its value.
      CHECK(std::fabs(rule.fractions()[0] - static_cast<double>(low)) <= 1e-8);
      for (int i = 1; i < 1000; ++i) REQUIRE(likelihood(i / 1000.0L) <= likelihood(rule.fractions()[0]) + 1e-12L);
    }
  }
}

TEST_CASE("With a prior the optimality condition holds for every divergence") {
  // The prior adds prior · (s(μ̂ π_1/α_1) − s(μ̂ π_2/α_2)); with control variates α and π in units of normalised pdfs.
  const auto all = two_batches<double>(interior, 60, 15);
  auto options = phimis::without_floors<double, 2>();
  options.start = {{0.7, 0.3}};
  options.prior = 20;
  for (const auto variate : {control_variate::on, control_variate::off}) {
    const definition problem(all, variate);
    for_each_divergence([&](const char* name, const auto& divergence) {
      if (steps(divergence)) return;
      INFO(name);
      const auto rule = learn(divergence, all, variate, options);
      CHECK(rule.status() == rule_status::updated);
      const auto normalised = [&](long double a1, long double a2) {
        return (a1 / problem.kappa1) / (a1 / problem.kappa1 + a2 / problem.kappa2);
      };
      const long double a1 = rule.fractions()[0], a2 = rule.fractions()[1];
      const long double alpha = normalised(a1, a2), pi = normalised(0.7L, 0.3L);
      const auto at = problem.at(divergence, a1, a2);
      const long double pull = 20 * (phimis::score_at(divergence, pi / alpha).value -
                                     phimis::score_at(divergence, (1 - pi) / (1 - alpha)).value);
      CHECK(std::fabs(at.first - at.second + pull) <= 1e-12L * at.lambda);
    });
  }
}

TEST_CASE("The multi-sample variance ends in a minimum, and says that it may be a local one") {
  // Every point of a discrete space of 30 once, with q = 1/30: the sums are the exact ones.
  random_numbers random(16);
  for (int round = 0; round < 10; ++round) {
    observations<double> all;
    double mass1 = 0, mass2 = 0;
    for (int i = 0; i < 30; ++i) {
      all.push_back({random() < 0.2 ? 0 : random.over_decades(0.1, 1), {{random(), random()}}, 1.0 / 30, 0});
      mass1 += all.back().pdfs[0];
      mass2 += all.back().pdfs[1];
    }
    for (auto& o : all) o.pdfs = {{o.pdfs[0] / mass1, o.pdfs[1] / mass2}};
    const auto variance = [&all](long double a) {
      long double square = 0, m1 = 0, m2 = 0;
      for (const auto& o : all) {
        const long double p = a * o.pdfs[0] + (1 - a) * o.pdfs[1];
        square += o.f * o.f / p;
        m1 += o.f * o.pdfs[0] / p;
        m2 += o.f * o.pdfs[1] / p;
      }
      return square - a * m1 * m1 - (1 - a) * m2 * m2;
    };
    for (const auto variate : {control_variate::on, control_variate::off}) {
      for (const double start : {0.0, 0.5, 1.0}) {
        auto options = phimis::without_floors<double, 2>();
        options.start = {{start, 1 - start}};
        const auto rule = learn(phimis::multi_sample_variance{}, all, variate, options);
        REQUIRE(rule.status() == rule_status::local);
        const long double a = rule.fractions()[0];
        for (const long double step : {1e-5L, 1e-3L}) {
          if (a + step <= 1) CHECK(variance(a) <= variance(a + step));
          if (a - step >= 0) CHECK(variance(a) <= variance(a - step));
        }
      }
    }
  }
}

TEST_CASE("Of the two local minima of the multi-sample variance each start finds its own") {
  // Sbert, Havran & Szirmay-Kalos 2016 say that V[F] is convex: here it has minima at α = 0 and .203166.
  const observations<double> all{{1.29, {{.004, .949}}, 0.25, 0},
                                 {.03, {{.444, .031}}, 0.25, 0},
                                 {.0064, {{.518, .008}}, 0.25, 0},
                                 {.07, {{.034, .012}}, 0.25, 0}};
  auto options = phimis::without_floors<double, 2>();
  options.start = {{0, 1}};
  CHECK(learn(phimis::multi_sample_variance{}, all, control_variate::off, options).fractions()[0] == 0);
  options.start = {{0.3, 0.7}};
  CHECK(learn(phimis::multi_sample_variance{}, all, control_variate::off, options).fractions()[0] ==
        Approx(0.203166).epsilon(1e-5));
}
