// SPDX-License-Identifier: MIT
#include "catch.hpp"
#include "random.hpp"

#include <phimis/core/projection_sums.hpp>

#include <cmath>
#include <limits>
#include <type_traits>
#include <vector>

namespace {

using alpha3 = phimis::fractions<double, 3>;
template <class Real>
using sums = phimis::projection_sums<Real, 3>;

/// f = Σ a_k p_k, or noise.
template <class Real>
std::vector<phimis::row<Real, 3>> rows(bool in_the_span) {
  random_numbers random(1);
  std::vector<phimis::row<Real, 3>> all;
  for (int j = 0; j < 60; ++j) {
    const double p[3] = {random(), random(), random()};
    const double f = j % 7 == 0 && !in_the_span ? 0 : in_the_span ? 2 * p[0] + 5 * p[2] : random();
    const phimis::observation<Real, 3> o{
        static_cast<Real>(f),
        {{static_cast<Real>(p[0]), static_cast<Real>(p[1]), static_cast<Real>(p[2])}},
        static_cast<Real>(random.between(0.3, 1)),
        0};
    phimis::row<Real, 3> row;
    REQUIRE(phimis::to_row(o, row));
    all.push_back(row);
  }
  return all;
}

struct equations {
  double g[3][3];
  double b[3];
};

template <class Real>
equations at(const sums<Real>& of, const alpha3& alpha, double prior = 0,
             const phimis::fractions<Real, 3>& start = phimis::equal_fractions<Real, 3>()) {
  equations result{};
  of.equations(alpha, start, prior, 60, result.g, result.b);
  return result;
}

bool close(const equations& a, const equations& b, double tolerance) {
  const double unit = a.b[0] / b.b[0];
  for (int i = 0; i < 3; ++i) {
    if (!(std::fabs(a.b[i] - unit * b.b[i]) <= tolerance * a.b[i])) return false;
    for (int k = 0; k < 3; ++k) {
      if (!(std::fabs(a.g[i][k] - b.g[i][k]) <= tolerance * b.g[i][k])) return false;
    }
  }
  return true;
}

template <class Real>
sums<Real> of(const std::vector<phimis::row<Real, 3>>& all) {
  sums<Real> result;
  for (const auto& row : all) result.add(row);
  return result;
}

const alpha3 somewhere{{0.25, 0.15, 0.6}};

}  // namespace

TEMPLATE_TEST_CASE("At an anchor the weight is one over its mixture", "", float, double) {
  const auto all = rows<TestType>(false);
  const double tolerance = 100 * static_cast<double>(std::numeric_limits<TestType>::epsilon());
  for (int c = 0; c < 3; ++c) {
    alpha3 anchor{};
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
      anchor[k] = sums<TestType>::anchor(c, k);
      sum += anchor[k];
    }
    CHECK(sum == Approx(1).epsilon(1e-15));
    equations direct{};
    for (const auto& row : all) {
      double x = 0;
      for (int k = 0; k < 3; ++k) x += anchor[k] * static_cast<double>(row.y[k]);
      for (int i = 0; i < 3; ++i) {
        const double weight = static_cast<double>(row.w) / x * static_cast<double>(row.y[i]);
        direct.b[i] += weight * static_cast<double>(row.u);
        for (int k = 0; k < 3; ++k) direct.g[i][k] += weight * static_cast<double>(row.y[k]);
      }
    }
    CHECK(close(at(of(all), anchor), direct, tolerance));
  }
}

TEST_CASE("The weight of any mixture among the anchors is bounded by theirs") {
  random_numbers random(3);
  for (int trial = 0; trial < 1000; ++trial) {
    double lambda[3] = {random(), random(), random()};
    const double sum = lambda[0] + lambda[1] + lambda[2];
    double p[3] = {random(), random(), random()};
    double mixture = 0;
    double bound = 0;
    for (int c = 0; c < 3; ++c) {
      double anchor = 0;
      for (int k = 0; k < 3; ++k) anchor += sums<double>::anchor(c, k) * p[k];
      mixture += lambda[c] / sum * anchor;
      bound += lambda[c] / sum / anchor;
    }
    CHECK(1 / mixture <= bound * (1 + 1e-14));
  }
}

TEST_CASE("An f in the span of the pdfs solves the equations of every weight") {
  const auto all = of(rows<double>(true));
  for (const alpha3& alpha : {somewhere, alpha3{{1, 0, 0}}, alpha3{{0, 0.5, 0.5}}}) {
    const equations e = at(all, alpha);
    // b ∝ G (2, 0, 5)
    const double unit = e.b[0] / (2 * e.g[0][0] + 5 * e.g[0][2]);
    for (int i = 0; i < 3; ++i) {
      CHECK(e.b[i] == Approx(unit * (2 * e.g[i][0] + 5 * e.g[i][2])).epsilon(1e-13));
    }
  }
}

TEST_CASE("A prior alone asks for the start") {
  const auto all = of(rows<double>(false));
  const alpha3 start{{0.2, 0.5, 0.3}};
  const equations free = at(all, somewhere, 0, start);
  const equations pulled = at(all, somewhere, 1e9, start);
  for (int i = 0; i < 3; ++i) {
    const double a = pulled.b[i] / pulled.g[i][i];
    const double first = pulled.b[0] / pulled.g[0][0];
    CHECK(a / first == Approx(start[i] / start[0]).epsilon(1e-6));
    CHECK(pulled.g[i][(i + 1) % 3] == free.g[i][(i + 1) % 3]);
  }
}

TEST_CASE("At an anchor the prior is a row of each technique, with the weight of that anchor") {
  const auto rows_of_noise = rows<double>(false);
  const auto all = of(rows_of_noise);
  const alpha3 start{{0.2, 0.5, 0.3}};
  double mean = 0;  // in units of the largest u
  double largest = 0;
  for (const auto& row : rows_of_noise) largest = std::fmax(largest, row.u);
  for (const auto& row : rows_of_noise) mean += row.w * row.u / largest / 60;
  for (int c = 0; c < 3; ++c) {
    alpha3 anchor{};
    for (int k = 0; k < 3; ++k) anchor[k] = sums<double>::anchor(c, k);
    const equations free = at(all, anchor, 0, start);
    const equations pulled = at(all, anchor, 7, start);
    for (int i = 0; i < 3; ++i) {
      CHECK(pulled.g[i][i] - free.g[i][i] == Approx(7 / anchor[i]).epsilon(1e-12));
      CHECK(pulled.b[i] - free.b[i] == Approx(7 / anchor[i] * mean * start[i]).epsilon(1e-12));
    }
  }
}

TEST_CASE("The fit solves the equations whose weight is that of its own mixture") {
  const auto all = of(rows<double>(false));
  const auto options = phimis::without_floors<double, 3>();
  const phimis::movable_techniques<3> on(options);
  double tau[3];
  REQUIRE(all.fit(on, options.start, 0.0, 60, tau));
  const auto solution = [&](const alpha3& alpha) {
    equations e = at(all, alpha);
    double x[3];
    REQUIRE(phimis::solve_nonnegative<3>(e.g, e.b, 3, x));
    return alpha3{{x[0] / (x[0] + x[1] + x[2]), x[1] / (x[0] + x[1] + x[2]), x[2] / (x[0] + x[1] + x[2])}};
  };
  const alpha3 again = solution(on.at(tau));
  const alpha3 elsewhere = solution(somewhere);
  double distance = 0;
  for (int k = 0; k < 3; ++k) {
    CHECK(std::fabs(again[k] - tau[k]) <= 1e-5);
    distance = std::fmax(distance, std::fabs(elsewhere[k] - tau[k]));
  }
  CHECK(distance > 1e-3);
}

TEMPLATE_TEST_CASE("Projections of merged states are those of all rows, in any grouping", "", float, double) {
  const auto all = rows<TestType>(false);
  const double tolerance = 100 * static_cast<double>(std::numeric_limits<TestType>::epsilon());
  random_numbers random(2);
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<sums<TestType>> groups(6);
    for (const auto& row : all) groups[static_cast<std::size_t>(random.below(5))].add(row);
    while (groups.size() > 1) {
      groups[static_cast<std::size_t>(random.below(static_cast<int>(groups.size()) - 1))].merge(groups.back());
      groups.pop_back();
    }
    CHECK(close(at(groups[0], somewhere), at(of(all), somewhere), tolerance));
  }
  static_assert(std::is_trivially_copyable<sums<TestType>>::value, "");
}

TEMPLATE_TEST_CASE("The scale of f is one factor of the right side", "", float, double) {
  constexpr bool single = std::is_same<TestType, float>::value;
  const double tolerance = 100 * static_cast<double>(std::numeric_limits<TestType>::epsilon());
  const auto plain = rows<TestType>(false);
  for (const double unit : {single ? 1e-30 : 1e-300, single ? 1e30 : 1e300}) {
    auto scaled = plain;
    for (auto& row : scaled) row.u *= static_cast<TestType>(unit);
    CHECK(close(at(of(scaled), somewhere), at(of(plain), somewhere), tolerance));
  }
}
