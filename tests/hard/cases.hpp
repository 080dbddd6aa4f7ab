// SPDX-License-Identifier: MIT
#ifndef PHIMIS_TESTS_HARD_CASES_HPP
#define PHIMIS_TESTS_HARD_CASES_HPP

#include "any_rule.hpp"
#include "catch.hpp"
#include "invariants.hpp"

#include <phimis/technique/technique_set.hpp>

#include <boost/math/quadrature/gauss.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

// What hard cases share: techniques by formula, observations that are quadrature, and how a rule is taught with them.

namespace hard {

/// Uniform between two points.
struct uniform_on {
  double lower, upper;
  double pdf(double x) const { return x >= lower && x < upper ? 1 / (upper - lower) : 0; }
  template <class Next>
  double sample(Next&& next) const {
    return lower + (upper - lower) * next();
  }
};

/// p = (n + 1) xⁿ on [0, 1], or (n + 1)(1 − x)ⁿ with n < 0 for n's magnitude.
struct power_of {
  int n;
  double pdf(double x) const {
    if (x < 0 || x > 1) return 0;
    return n < 0 ? (1 - n) * std::pow(1 - x, -n) : (n + 1) * std::pow(x, n);
  }
  template <class Next>
  double sample(Next&& next) const {
    const double root = std::pow(next(), 1.0 / (std::abs(n) + 1));
    return n < 0 ? 1 - root : root;
  }
};

/// Two powers of x, for which there are Newton's rules, and three.
template <class Body>
void for_two_and_three(const Body& body) {
  body(phimis::technique_set(power_of{0}, power_of{1}));
  body(phimis::technique_set(power_of{0}, power_of{1}, power_of{2}));
}

template <class Real, int M>
using observations = std::vector<phimis::observation<Real, M>>;

/// f and pdfs at the nodes of a Gauss rule of 20 points on each of `panels` panels between neighbouring edges: observations
/// whose sums are integrals. Of n observations each has q = 1/(n · weight).
template <class Real = double, class Integrand, class... Techniques>
auto quadrature(const Integrand& f, const phimis::technique_set<Techniques...>& techniques,
                const std::vector<double>& edges, int panels = 20) {
  constexpr int M = sizeof...(Techniques);
  using rule = boost::math::quadrature::gauss<double, 20>;
  observations<Real, M> all;
  const double n = 20.0 * panels * static_cast<double>(edges.size() - 1);
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    const double half = (edges[i + 1] - edges[i]) / panels / 2;
    for (int panel = 0; panel < panels; ++panel) {
      for (std::size_t node = 0; node < rule::abscissa().size(); ++node) {
        for (const int side : {-1, 1}) {
          const double x = edges[i] + half * (2 * panel + 1 + side * rule::abscissa()[node]);
          phimis::observation<Real, M> o{static_cast<Real>(f(x)), {}, 0, 0};
          const auto p = techniques.pdfs(x);
          for (int k = 0; k < M; ++k) o.pdfs[k] = static_cast<Real>(p[k]);
          o.q = static_cast<Real>(1 / (n * half * rule::weights()[node]));
          o.technique = static_cast<int>(all.size() % M);
          all.push_back(o);
        }
      }
    }
  }
  return all;
}

/// n observations of f, drawn in turn from each technique at equally spaced quantiles.
template <class Real = double, class Integrand, class... Techniques>
auto drawn(const Integrand& f, const phimis::technique_set<Techniques...>& techniques, int n) {
  constexpr int M = sizeof...(Techniques);
  observations<Real, M> all;
  for (int j = 0; j < n; ++j) {
    const auto next = [&] { return (j / M + 0.5) / ((n + M - 1) / M); };
    const double x = techniques.sample(j % M, next);
    phimis::observation<Real, M> o{static_cast<Real>(f(x)), {}, 0, j % M};
    const auto p = techniques.pdfs(x);
    double q = 0;
    for (int k = 0; k < M; ++k) {
      o.pdfs[k] = static_cast<Real>(p[k]);
      q += p[k] / M;
    }
    o.q = static_cast<Real>(q);
    all.push_back(o);
  }
  return all;
}

/// A batch for a rule: all observations, then an update; a rule that goes by steps has the batch again at each step. On the
/// way, what holds of every rule must hold.
template <class Rule, class Observations>
phimis::rule_status teach(Rule& rule, const Observations& all, int steps = 40) {
  for (int step = 0; step < (rule.how() == way::by_steps ? steps : 1); ++step) {
    for (const auto& o : all) rule.observe(o);
    const auto before = rule.fractions();
    rule.update();
    const std::string broken = invariants::wrong_update(rule, before);
    INFO(rule.name());
    CHECK(broken == "");
  }
  return rule.status();
}

template <class Real, int M>
phimis::rule_options<Real, M> starting_at(const phimis::fractions<Real, M>& start) {
  auto options = phimis::without_floors<Real, M>();
  options.start = start;
  return options;
}

/// Each number to the last digit, by value: no NaN can be the same.
template <class Real, int M>
bool same(const phimis::per_technique<Real, M>& a, const phimis::per_technique<Real, M>& b) {
  for (int k = 0; k < M; ++k) {
    if (!phimis::is_finite(a[k]) || !(a[k] == b[k])) return false;
  }
  return true;
}

/// The largest difference of two fractions.
template <class A, class B>
double apart(const A& a, const B& b) {
  double most = 0;
  for (int k = 0; k < A::size(); ++k) {
    if (!phimis::is_finite(a[k])) return 1e300;
    most = std::max(most, std::fabs(static_cast<double>(a[k]) - static_cast<double>(b[k])));
  }
  return most;
}

template <class Real>
constexpr bool is_float = std::is_same_v<Real, float>;

}  // namespace hard

#endif  // PHIMIS_TESTS_HARD_CASES_HPP
