// SPDX-License-Identifier: MIT
#include "catch.hpp"
#include "random.hpp"

#include <phimis/core/technique_sums.hpp>

#include <cmath>
#include <limits>
#include <type_traits>
#include <vector>

namespace {

template <class Real>
using sums = phimis::technique_sums<Real, 3>;

template <class Real>
std::vector<phimis::observation<Real, 3>> observations(double f_unit, double density_unit) {
  random_numbers random(1);
  std::vector<phimis::observation<Real, 3>> all;
  for (int j = 0; j < 60; ++j) {
    const int k = random.below(3);
    const Real f = static_cast<Real>(j % 7 == 0 ? 0 : f_unit * random.between(-1, 2));
    const auto p = [&] { return static_cast<Real>(density_unit * random.over_decades(1e-3, 1e3)); };
    all.push_back({f, {{p(), p(), p()}}, static_cast<Real>(density_unit), k});
  }
  return all;
}

template <class Real>
sums<Real> of(const std::vector<phimis::observation<Real, 3>>& all) {
  sums<Real> result;
  for (const auto& o : all) result.add(o);
  return result;
}

/// P_ik/P_11 and F_k/F_1, which have no unit.
template <class Real>
bool close(const sums<Real>& a, const sums<Real>& b, double tolerance) {
  for (int k = 0; k < 3; ++k) {
    if (std::fabs(a.f(k) / a.f(0) - b.f(k) / b.f(0)) > tolerance * std::fabs(b.f(k) / b.f(0))) return false;
    for (int i = 0; i < 3; ++i) {
      const double ours = a.p(i, k) / a.p(0, 0);
      const double theirs = b.p(i, k) / b.p(0, 0);
      if (std::fabs(ours - theirs) > tolerance * theirs) return false;
    }
  }
  return true;
}

}  // namespace

TEMPLATE_TEST_CASE("Sums are those of each technique's own samples", "", float, double) {
  const auto all = observations<TestType>(1, 1);
  const auto ours = of(all);
  long double p[3][3] = {};
  long double f[3] = {};
  for (const auto& o : all) {
    f[o.technique] += std::fabs(static_cast<long double>(o.f));
    for (int i = 0; i < 3; ++i) p[i][o.technique] += o.pdfs[i];
  }
  const double tolerance = 100 * static_cast<double>(std::numeric_limits<TestType>::epsilon());
  const double density_unit = ours.p(0, 0) / static_cast<double>(p[0][0]);
  const double f_unit = ours.f(0) / static_cast<double>(f[0]);
  for (int k = 0; k < 3; ++k) {
    CHECK(ours.f(k) == Approx(f_unit * static_cast<double>(f[k])).epsilon(tolerance));
    for (int i = 0; i < 3; ++i) {
      CHECK(ours.p(i, k) == Approx(density_unit * static_cast<double>(p[i][k])).epsilon(tolerance));
    }
  }
}

TEMPLATE_TEST_CASE("No scale of f or of the measure overflows the sums", "", float, double) {
  constexpr bool single = std::is_same<TestType, float>::value;
  const double tolerance = 100 * static_cast<double>(std::numeric_limits<TestType>::epsilon());
  const auto plain = of(observations<TestType>(1, 1));
  for (const double unit : {single ? 1e-34 : 1e-300, single ? 1e34 : 1e300}) {
    CHECK(close(of(observations<TestType>(unit, 1)), plain, tolerance));
    CHECK(close(of(observations<TestType>(1, unit)), plain, tolerance));
  }
}

TEMPLATE_TEST_CASE("Merged sums are those of all samples, in any grouping", "", float, double) {
  const auto all = observations<TestType>(1, 1);
  const double tolerance = 100 * static_cast<double>(std::numeric_limits<TestType>::epsilon());
  random_numbers random(2);
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<sums<TestType>> groups(6);
    for (const auto& o : all) groups[static_cast<std::size_t>(random.below(5))].add(o);  // the last stays empty
    while (groups.size() > 1) {
      groups[static_cast<std::size_t>(random.below(static_cast<int>(groups.size()) - 1))].merge(groups.back());
      groups.pop_back();
    }
    CHECK(close(groups[0], of(all), tolerance));
  }
  static_assert(std::is_trivially_copyable<sums<TestType>>::value, "");
}
