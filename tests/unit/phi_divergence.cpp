// SPDX-License-Identifier: MIT
#include "catch.hpp"
#include "divergences.hpp"
#include "two_triangles.hpp"

#include <phimis/concepts.hpp>
#include <phimis/divergence/phi_divergence.hpp>
#include <phimis/solver/rules.hpp>

#include <cmath>
#include <limits>

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

const phimis::phi_divergence t_log_t([](auto t) { return t * log(t); });
const phimis::phi_divergence square([](auto t) { return t * t - 1.0; });
const phimis::phi_divergence cube([](auto t) {
  const auto d = abs(t - 1.0);
  return d * d * d;
});
const phimis::phi_divergence distance([](auto t) { return abs(t - 1.0) / 2.0; });
const phimis::phi_divergence root([](auto t) { return (sqrt(t) - 1.0) * (sqrt(t) - 1.0); });
const phimis::phi_divergence jensen_shannon([](auto t) { return t * log(t) - (1.0 + t) * log((1.0 + t) / 2.0); });

/// φ of the user = factor · φ of the library + c (t − 1).
template <class User, class BuiltIn>
void check_same(const char* name, const User& user, const BuiltIn& built_in, double factor, double c) {
  INFO(name);
  const auto close = [](double a, double b) { return std::fabs(a - b) <= 1e-13 * (1 + std::fabs(a) + std::fabs(b)); };
  for (const double t : {0.01, 0.4, 0.9, 1.3, 7.0, 100.0}) {
    INFO("t " << t);
    const auto taylor = user.taylor(t);
    const true_phi wanted = true_phi_at(built_in, t);
    CHECK(close(taylor.value, factor * static_cast<double>(wanted.value) + c * (t - 1)));
    CHECK(close(taylor.first, factor * static_cast<double>(wanted.first) + c));
    CHECK(close(taylor.second, factor * static_cast<double>(wanted.second)));
    // s = t φ' − φ shifts by c forward and −φ'(1/t) by −c reversed.
    const auto s = phimis::score_at(user, t);
    const auto true_s = true_score_at(built_in, t);
    CHECK(close(s.value, factor * static_cast<double>(true_s.value) + c));
    CHECK(close(s.slope, factor * static_cast<double>(true_s.slope)));
    const phimis::reversed<User> back{user};
    const auto back_s = phimis::score_at(back, t);
    const auto true_back = true_score_at(phimis::reversed<BuiltIn>{built_in}, t);
    CHECK(close(back_s.value, factor * static_cast<double>(true_back.value) - c));
    CHECK(close(back_s.slope, factor * static_cast<double>(true_back.slope)));
  }
}

double interior(double x) { return 0.6 + 0.8 * x * x; }

template <class Divergence>
double learn(const Divergence& divergence) {
  auto rule = phimis::exact_rule(divergence);
  for (const auto& o : two_triangles::observe(interior, 0.5, 200, 1)) rule.observe(o);
  CHECK(rule.update() == phimis::rule_status::updated);
  return rule.fractions()[0];
}

}  // namespace

TEST_CASE("A user's phi has the derivatives of the built-in one") {
  check_same("t log t", t_log_t, phimis::kullback_leibler{}, 1, 0);
  check_same("t^2 - 1", square, phimis::chi_squared{}, 1, 1);
  check_same("|t - 1|^3", cube, phimis::pearson_vajda{3}, 1, 0);
  check_same("|t - 1|/2", distance, phimis::total_variation{}, 1, 0);
  check_same("(sqrt t - 1)^2", root, phimis::hellinger{}, 2, -1);
}

TEST_CASE("A user's phi learns the fractions of the built-in one") {
  CHECK(learn(t_log_t) == Approx(learn(phimis::kullback_leibler{})).epsilon(1e-10));
  CHECK(learn(square) == Approx(learn(phimis::chi_squared{})).epsilon(1e-10));
  CHECK(learn(cube) == Approx(learn(phimis::pearson_vajda{3})).epsilon(1e-10));
  CHECK(learn(distance) == Approx(learn(phimis::total_variation{})).epsilon(1e-10));
  CHECK(learn(root) == Approx(learn(phimis::hellinger{})).epsilon(1e-10));
  CHECK(learn(phimis::reversed{root}) == Approx(learn(phimis::reversed{phimis::hellinger{}})).epsilon(1e-10));
  CHECK(learn(phimis::reversed{t_log_t}) == Approx(learn(phimis::reversed{phimis::kullback_leibler{}})).epsilon(1e-10));
}

TEST_CASE("A user's phi is taken at its limits at 0 and infinity") {
  struct limits {
    double at_zero, slope_at_infinity;
  };
  const auto check = [](const char* name, const auto& d, limits wanted) {
    INFO(name);
    const auto at_zero = d.taylor(0.0);
    CHECK(at_zero.value == Approx(wanted.at_zero).margin(1e-300));
    CHECK(phimis::phi_at(d, 0.0) == Approx(wanted.at_zero).margin(1e-300));
    CHECK(phimis::score_at(d, 0.0).value == Approx(-wanted.at_zero).margin(1e-300));
    CHECK(phimis::score_at(d, 0.0).slope == 0);
    const phimis::reversed back{d};
    CHECK(phimis::infinite_at_zero(back) == (wanted.slope_at_infinity == infinity));
    if (wanted.slope_at_infinity < infinity) {
      CHECK(phimis::score_at(back, 0.0).value == Approx(-wanted.slope_at_infinity));
      CHECK(phimis::phi_at(back, 0.0) == Approx(wanted.slope_at_infinity));
    } else {
      CHECK(phimis::score_at(back, 0.0).value == -infinity);
    }
    CHECK_FALSE(phimis::infinite_at_zero(d));
  };
  check("t log t", t_log_t, {0, infinity});
  check("t^2 - 1", square, {-1, infinity});
  check("|t - 1|^3", cube, {1, infinity});
  check("|t - 1|/2", distance, {0.5, 0.5});
  check("(sqrt t - 1)^2", root, {1, 1});
  check("Jensen-Shannon", jensen_shannon, {std::log(2.0), std::log(2.0)});
}

TEST_CASE("Jensen-Shannon, which the library does not have, is symmetric and minimised") {
  for (const double t : {0.1, 0.7, 3.0}) {
    // φ* = φ.
    CHECK(phimis::phi_at(phimis::reversed{jensen_shannon}, t) == Approx(phimis::phi_at(jensen_shannon, t)).epsilon(1e-13));
    const double first = std::log(2 * t / (1 + t));
    CHECK(jensen_shannon.taylor(t).first == Approx(first).epsilon(1e-13));
    CHECK(jensen_shannon.taylor(t).second == Approx(1 / t - 1 / (1 + t)).epsilon(1e-13));
  }
  const double alpha = learn(jensen_shannon);
  CHECK(learn(phimis::reversed{jensen_shannon}) == Approx(alpha).epsilon(1e-10));
  // No fraction on a grid is better. The pdfs are normalised on the sample, as the rule does.
  const auto all = two_triangles::observe(interior, 0.5, 200, 1);
  double mass1 = 0, mass2 = 0, mean = 0;
  for (const auto& o : all) {
    mass1 += o.pdfs[0] / o.q / 200;
    mass2 += o.pdfs[1] / o.q / 200;
    mean += o.f / o.q / 200;
  }
  const auto divergence = [&](double a) {
    double sum = 0;
    const double b1 = a, b2 = 1 - a;
    for (const auto& o : all) {
      const double p = (b1 * o.pdfs[0] + b2 * o.pdfs[1]) / (b1 * mass1 + b2 * mass2);
      const double t = o.f / mean / p;
      sum += p / o.q * (t * std::log(t) - (1 + t) * std::log((1 + t) / 2));
    }
    return sum;
  };
  for (int i = 0; i <= 500; ++i) REQUIRE(divergence(alpha) <= divergence(i / 500.0) + 1e-12);
}

TEST_CASE("A user's phi serves float as well") {
  const auto taylor = t_log_t.taylor(3.0f);
  static_assert(std::is_same_v<decltype(taylor), const phimis::phi_taylor<float>>);
  CHECK(taylor.first == Approx(1 + std::log(3.0)).epsilon(1e-6));
  static_assert(phimis::divergence<std::decay_t<decltype(t_log_t)>>);
}
