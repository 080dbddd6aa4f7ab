// SPDX-License-Identifier: MIT
#include "catch.hpp"

#include <phimis/quadrature/panels.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace {

using phimis::interval;

/// Σ weight x^k of both rules, and ∫ x^k over [−1, 1].
struct power_sums {
  long double kronrod = 0, gauss = 0, exact = 0;
};
power_sums of_power(int k) {
  power_sums sums;
  for (const auto& node : phimis::kronrod_nodes()) {
    const long double power = std::pow(static_cast<long double>(node.x), k);
    sums.kronrod += node.weight * power;
    sums.gauss += node.gauss_weight * power;
  }
  sums.exact = k % 2 == 0 ? 2.0L / (k + 1) : 0;
  return sums;
}

template <class F>
double integrate(const F& f, const std::vector<double>& edges) {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) sum += phimis::integrate_panel(f, edges[i], edges[i + 1]);
  return sum;
}

template <class F>
auto family(const F& f) {
  return [f](double x) { return std::array{f(x)}; };
}

}  // namespace

TEST_CASE("The 31-point rule is exact to degree 47 and its embedded rule to degree 29") {
  for (int k = 0; k <= 47; ++k) {
    INFO("x^" << k);
    CHECK(std::fabs(of_power(k).kronrod - of_power(k).exact) <= 1e-15L);
  }
  for (int k = 0; k <= 29; ++k) CHECK(std::fabs(of_power(k).gauss - of_power(k).exact) <= 1e-15L);
  // No further: a rule that were exact for everything would be a wrong test.
  CHECK(std::fabs(of_power(30).gauss - of_power(30).exact) > 1e-10L);
  CHECK(std::fabs(of_power(64).kronrod - of_power(64).exact) > 1e-14L);
}

TEST_CASE("Nodes increase inside [-1, 1] and half of them are the embedded rule's") {
  const auto& nodes = phimis::kronrod_nodes();
  int embedded = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    CHECK(nodes[i].weight > 0);
    CHECK(std::fabs(nodes[i].x) < 1);
    if (i > 0) CHECK(nodes[i].x > nodes[i - 1].x);
    CHECK(nodes[i].x == -nodes[30 - i].x);
    embedded += nodes[i].gauss_weight > 0;
  }
  CHECK(embedded == 15);
}

TEST_CASE("A panel integrates polynomials on its own interval exactly") {
  const auto f = [](double x) { return 5 * x * x * x * x; };
  CHECK(phimis::integrate_panel(f, 1, 3) == Approx(242).epsilon(1e-15));
  CHECK(phimis::integrate_panel(f, 3, 1) == Approx(-242).epsilon(1e-15));
  CHECK(phimis::integrate_panel(f, 2, 2) == 0);
}

TEST_CASE("A smooth function needs few panels, and each function of a family is resolved") {
  const auto smooth = phimis::smooth_panels(family([](double x) { return std::cos(x); }), interval(0, 1));
  CHECK(smooth.size() == 5);
  const auto both = phimis::smooth_panels(
      [](double x) { return std::array{std::cos(x), 1e-200 / (1e-6 + (x - 0.3) * (x - 0.3))}; }, interval(0, 1));
  CHECK(both.size() > 12);  // the scale of a function is its own
  CHECK(integrate([](double x) { return 1e-3 / (1e-6 + (x - 0.3) * (x - 0.3)); }, both) ==
        Approx(std::atan(300.0) + std::atan(700.0)).epsilon(1e-13));
}

TEST_CASE("Edges begin and end with the domain, increase, and hold every breakpoint inside") {
  const std::vector<double> breakpoints{0.7, 0.2, 5, 0.2, 0, -3};
  const auto edges = phimis::smooth_panels(family([](double x) { return std::sin(x); }), interval(0, 1), breakpoints);
  CHECK(edges.front() == 0);
  CHECK(edges.back() == 1);
  for (std::size_t i = 1; i < edges.size(); ++i) CHECK(edges[i] > edges[i - 1]);
  for (const double x : {0.2, 0.7}) CHECK(std::find(edges.begin(), edges.end(), x) != edges.end());
  CHECK(edges.size() == 13);  // three intervals of four panels
}

TEST_CASE("Jumps at breakpoints cost nothing, jumps elsewhere are hunted down") {
  const auto step = [](double x) { return x < 1.0 / 3 ? 1.0 : 4.0; };
  const std::vector<double> known{1.0 / 3};
  const auto told = phimis::smooth_panels(family(step), interval(0, 1), known);
  CHECK(told.size() == 9);
  CHECK(integrate(step, told) == Approx(3).epsilon(1e-15));
  const auto found = phimis::smooth_panels(family(step), interval(0, 1));
  CHECK(found.size() > 30);
  CHECK(integrate(step, found) == Approx(3).epsilon(1e-11));  // the last panel is 2^-42 wide
}

TEST_CASE("Singular derivatives are resolved to the tolerance") {
  const auto f = [](double x) { return std::sqrt(x); };
  CHECK(integrate(f, phimis::smooth_panels(family(f), interval(0, 1))) == Approx(2.0 / 3).epsilon(1e-14));
  const auto coarse = phimis::smooth_panels(family(f), interval(0, 1), {}, 1e-6);
  CHECK(coarse.size() < phimis::smooth_panels(family(f), interval(0, 1)).size());
  CHECK(integrate(f, coarse) == Approx(2.0 / 3).epsilon(1e-5));
}
