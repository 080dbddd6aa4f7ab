// SPDX-License-Identifier: MIT
// Orders of Tsallis divergences near their limits: γ → 0 is the reversed Kullback–Leibler divergence, γ = 1 the
// Kullback–Leibler divergence, γ → ∞ asks for the least maximum of f/p.
#include "any_rule.hpp"
#include "cases.hpp"
#include "catch.hpp"

#include <phimis/solver/rules.hpp>

#include <algorithm>
#include <cmath>

namespace {

using namespace hard;
using phimis::control_variate;
using phimis::rule_status;

const phimis::technique_set pair(power_of{0}, power_of{1});
double f(double x) { return 0.3 + x * x; }

template <class Divergence>
double oracle(const Divergence& divergence) {
  static const phimis::analysis::problem exact(f, pair, phimis::interval(0, 1));
  return phimis::analysis::optimum(divergence, exact).alpha[0];
}

/// α_1 of an order by each rule that takes it. check(name, α_1).
template <class Real, class Check>
void learn(const phimis::tsallis& order, const Check& check) {
  const auto all = quadrature<Real>(f, pair, {0, 1}, 5);
  const auto options = phimis::without_floors<Real, 2>();
  for (const auto variate : {control_variate::on, control_variate::off}) {
    any_rule<Real, 2> exact("exact", way::at_once, nullptr,
                            phimis::exact_rule<2, phimis::tsallis, Real>(order, options, variate));
    CHECK(teach(exact, all) == rule_status::updated);
    check("exact", static_cast<double>(exact.fractions()[0]));
  }
  any_rule<Real, 2> newton(
      "Newton", way::by_steps, nullptr,
      phimis::newton_rule<phimis::tsallis, Real>(order, phimis::newton_form::safeguarded, options));
  teach(newton, all);
  check("Newton", static_cast<double>(newton.fractions()[0]));
  any_rule<Real, 2> streaming("streaming", way::by_steps, nullptr,
                              phimis::streaming_rule<2, phimis::tsallis, Real>(order, options, Real(0)));
  teach(streaming, all);
  check("streaming", static_cast<double>(streaming.fractions()[0]));
}

}  // namespace

TEST_CASE("As the order goes to 0 the fractions go to those of the reversed Kullback-Leibler divergence") {
  const double limit = oracle(phimis::reversed<phimis::kullback_leibler>{});
  for (const double gamma : {1e-2, 1e-4, 1e-6, 1e-8}) {
    const double truth = oracle(phimis::tsallis{gamma});
    CAPTURE(gamma, truth, limit);
    // (t^γ − 1)/γ = log t + γ (log t)²/2 + …; and ε/γ of what is left of t^γ.
    CHECK(std::fabs(truth - limit) <= gamma + 1e-15 / gamma);
    learn<double>({gamma}, [&](const char* name, double found) {
      CAPTURE(name, found);
      CHECK(std::fabs(found - limit) <= gamma + 1e-14 / gamma);
    });
  }
}

TEST_CASE("An order within 1e-8 of one is the Kullback-Leibler divergence to 1e-8") {
  const double limit = oracle(phimis::kullback_leibler{});
  for (const double gamma : {1 - 1e-8, 1 + 1e-8}) {
    CHECK(std::fabs(oracle(phimis::tsallis{gamma}) - limit) <= 1e-8);
    learn<double>({gamma}, [&](const char* name, double found) {
      CAPTURE(name, gamma);
      CHECK(std::fabs(found - limit) <= 1e-8);
    });
    learn<float>({gamma}, [&](const char* name, double found) {
      CAPTURE(name, gamma);
      CHECK(std::fabs(found - limit) <= 1e-5);
    });
  }
}

TEST_CASE("Orders of 20 and 40 have the fractions of the oracle and near the least maximum of f/p") {
  // max f/p(α) on a grid: f/p_1 is large at x = 1, f/p_2 at x = 0.
  const auto largest = [](double a) {
    double most = 0;
    for (int i = 0; i <= 400; ++i) most = std::max(most, f(i / 400.0) / (a + (1 - a) * i / 200.0));
    return most;
  };
  double best = 1;
  for (int i = 1; i < 1000; ++i) best = largest(i / 1000.0) < largest(best) ? i / 1000.0 : best;
  for (const double gamma : {20.0, 40.0}) {
    const double truth = oracle(phimis::tsallis{gamma});
    CAPTURE(gamma, truth, best);
    learn<double>({gamma}, [&](const char* name, double found) {
      CAPTURE(name, found);
      CHECK(std::fabs(found - truth) <= 1e-9);
    });
    learn<float>({gamma}, [&](const char* name, double found) {
      CAPTURE(name, found);
      CHECK(std::fabs(found - truth) <= 1e-4);
    });
    // (∫ (f/p)^γ p)^{1/γ} is within a factor of e^{O(log γ/γ)} of the maximum.
    CHECK(largest(truth) <= std::exp(std::log(gamma) / gamma) * largest(best));
  }
}

TEMPLATE_TEST_CASE("No order makes a number that is none", "", float, double) {
  for (const double gamma : {1e-12, 1e-3, 0.999999, 1.000001, 7.5, 100.0, 1000.0}) {
    CAPTURE(gamma);
    const auto all = drawn<TestType>([](double x) { return x < 0.3 ? 0 : f(x); }, pair, 60);
    any_rule<TestType, 2> exact("exact", way::at_once, nullptr,
                                phimis::exact_rule<2, phimis::tsallis, TestType>(phimis::tsallis{gamma}));
    any_rule<TestType, 2> newton("Newton", way::by_steps, nullptr,
                                 phimis::newton_rule<phimis::tsallis, TestType>(phimis::tsallis{gamma}));
    any_rule<TestType, 2> streaming("streaming", way::by_steps, nullptr,
                                    phimis::streaming_rule<2, phimis::tsallis, TestType>(phimis::tsallis{gamma}));
    teach(exact, all);
    teach(newton, all, 10);
    teach(streaming, all, 10);
  }
}
