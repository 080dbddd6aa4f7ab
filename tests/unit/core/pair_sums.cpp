// SPDX-License-Identifier: MIT
#include "catch.hpp"
#include "divergences.hpp"
#include "random.hpp"

#include <phimis/core/divergence_at.hpp>
#include <phimis/core/pair_sums.hpp>

#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>
#include <vector>

namespace {

using phimis::pair_point;
using phimis::pair_sums;

template <class Real>
struct rows {
  std::vector<Real> u, w, y1, y2;
  phimis::columns<Real, 2> view() const {
    return {u.data(), w.data(), {y1.data(), y2.data()}, static_cast<std::ptrdiff_t>(u.size())};
  }
};

/// f = 0 in a tenth of the rows, where the divergence allows it.
template <class Real>
rows<Real> random_rows(int n, bool with_zeros, std::uint64_t seed) {
  random_numbers random(seed);
  rows<Real> result;
  for (int j = 0; j < n; ++j) {
    const double share = random() < 0.05 ? 0 : random() < 0.05 ? 1 : random();
    result.u.push_back(with_zeros && random() < 0.1 ? Real(0) : static_cast<Real>(random.over_decades(0.05, 20)));
    result.w.push_back(static_cast<Real>(random.over_decades(0.3, 3)));
    result.y1.push_back(static_cast<Real>(share));
    result.y2.push_back(static_cast<Real>(1 - share));
  }
  return result;
}

struct true_sums {
  long double zeta = 0, slope = 0, lambda = 0;
  long double zeta_size = 0, slope_size = 0;  // of the terms, without cancellation
};

/// The formulas of the header one by one, in long double.
template <class Divergence, class Real>
true_sums naively(const Divergence& divergence, const rows<Real>& on, const pair_point<long double>& at) {
  bool slope_counts = true;
  if constexpr (phimis::has_exponent<Divergence>::value) slope_counts = divergence.exponent() == 0;
  true_sums sums;
  for (std::size_t j = 0; j < on.u.size(); ++j) {
    const long double p1 = at.kappa[0] * static_cast<long double>(on.y1[j]);
    const long double p2 = at.kappa[1] * static_cast<long double>(on.y2[j]);
    const long double p = at.alpha[0] * p1 + at.alpha[1] * p2;
    const long double w = on.w[j];
    auto s = phimis::score_at(divergence, at.unit * static_cast<long double>(on.u[j]) / p);
    s.value -= phimis::score_at_zero(divergence);
    sums.zeta += w * (p1 - p2) * s.value;
    sums.slope += w * (p1 - p2) * (p1 - p2) / p * s.slope;
    sums.lambda += w * p * (std::fabs(s.value) + (slope_counts ? s.slope : 0));
    // Rounding of t moves s by t s' and t s' by a few times 1 + t s'.
    sums.zeta_size += w * (p1 + p2) * (1 + std::fabs(s.value) + s.slope);
    sums.slope_size += w * (p1 + p2) * (p1 + p2) / p * (1 + s.slope);
  }
  return sums;
}

template <class Real>
pair_point<long double> exact(const pair_point<Real>& at) {
  return {{at.alpha[0], at.alpha[1]}, {at.kappa[0], at.kappa[1]}, at.unit, at.mass};
}

}  // namespace

TEMPLATE_TEST_CASE("The sums are those of the formulas for every divergence and any number of rows", "", float, double) {
  // A block has 64 rows a lane and 16 lanes, a term about 10 roundings and two of a power of exponent up to 3.5.
  const long double rounding = (64 + 16 + 10 + 10) * static_cast<long double>(std::numeric_limits<TestType>::epsilon());
  for (const int n : {0, 1, 15, 16, 17, 1023, 1025, 5000}) {
    for_each_divergence([&](const char* name, const auto& divergence) {
      INFO(name << ", " << n << " rows");
      const auto on = random_rows<TestType>(n, !phimis::infinite_at_zero(divergence), 1 + static_cast<std::uint64_t>(n));
      const pair_point<TestType> at{{TestType(0.3), TestType(0.7)}, {TestType(1.1), TestType(0.9)}, TestType(0.5), 1};
      const pair_sums computed = phimis::sum_pair(divergence, on.view(), at);
      const true_sums wanted = naively(divergence, on, exact(at));
      CHECK(std::fabs(computed.zeta - wanted.zeta) <= rounding * wanted.zeta_size);
      CHECK(std::fabs(computed.slope - wanted.slope) <= rounding * wanted.slope_size);
      CHECK(std::fabs(computed.lambda - wanted.lambda) <= rounding * wanted.zeta_size);
      if (n == 0) CHECK((computed.zeta == 0 && computed.slope == 0 && computed.lambda == 0));
    });
  }
}

TEST_CASE("The slope is minus the derivative of zeta") {
  const auto on = random_rows<double>(300, false, 2);
  for_each_divergence([&](const char* name, const auto& divergence) {
    INFO(name);
    const auto zeta_at = [&](long double first) {
      return naively(divergence, on, pair_point<long double>{{first, 1 - first}, {1.1L, 0.9L}, 0.5L, 1}).zeta;
    };
    const pair_sums at = phimis::sum_pair(divergence, on.view(), pair_point<double>{{0.3, 0.7}, {1.1, 0.9}, 0.5, 1});
    const true_sums size = naively(divergence, on, pair_point<long double>{{0.3L, 0.7L}, {1.1L, 0.9L}, 0.5L, 1});
    // h² = 1e-12 times third derivatives, and ε/h = 1e-13; no row has its kink within h of .3.
    const long double h = 1e-6L;
    CHECK(std::fabs(at.slope - (zeta_at(0.3L - h) - zeta_at(0.3L + h)) / (2 * h)) <= 1e-8L * size.slope_size);
  });
}

TEST_CASE("Where one fraction is 0, rows that only the other technique reaches count without NaN") {
  // t = 0 where f = 0 even if the mixture vanishes there.
  rows<double> on;
  on.u = {0, 2, 0};
  on.w = {1, 1, 2};
  on.y1 = {1, 0, 0.5};
  on.y2 = {0, 1, 0.5};
  const pair_sums at = phimis::sum_pair(phimis::chi_squared{}, on.view(), pair_point<double>{{0, 1}, {1, 1}, 1, 3});
  CHECK(at.zeta == -4);
  CHECK(at.slope == 8);
  CHECK(at.lambda == 4);
}

namespace {

/// V[F] for N = 1 on a space of points with counting measure, in long double.
struct discrete {
  std::vector<long double> p1, p2, f;

  explicit discrete(int n, std::uint64_t seed) {
    random_numbers random(seed);
    long double mass1 = 0, mass2 = 0;
    for (int i = 0; i < n; ++i) {
      p1.push_back(random.over_decades(0.01, 1));
      p2.push_back(random.over_decades(0.01, 1));
      f.push_back(i % 5 == 0 ? 0 : random.over_decades(0.01, 1));
      mass1 += p1.back();
      mass2 += p2.back();
    }
    for (auto& p : p1) p /= mass1;
    for (auto& p : p2) p /= mass2;
  }
  long double variance(long double alpha) const {
    long double square = 0, m1 = 0, m2 = 0;
    for (std::size_t i = 0; i < f.size(); ++i) {
      const long double p = alpha * p1[i] + (1 - alpha) * p2[i];
      square += f[i] * f[i] / p;
      m1 += f[i] * p1[i] / p;
      m2 += f[i] * p2[i] / p;
    }
    return square - alpha * m1 * m1 - (1 - alpha) * m2 * m2;
  }
  template <class Real>
  rows<Real> as_rows() const {
    rows<Real> result;
    for (std::size_t i = 0; i < f.size(); ++i) {
      const long double sum = p1[i] + p2[i];
      result.u.push_back(static_cast<Real>(f[i] / sum));
      result.w.push_back(static_cast<Real>(sum));
      result.y1.push_back(static_cast<Real>(p1[i] / sum));
      result.y2.push_back(static_cast<Real>(p2[i] / sum));
    }
    return result;
  }
};

}  // namespace

TEMPLATE_TEST_CASE("The sums of the multi-sample variance are its first two derivatives", "", float, double) {
  for (int i = 0; i < 20; ++i) {
    const discrete space(40, 3 + static_cast<std::uint64_t>(i));
    const auto on = space.template as_rows<TestType>();
    for (const double alpha : {0.05, 0.4, 0.9}) {
      const TestType first = static_cast<TestType>(alpha);
      const pair_sums computed = phimis::sum_pair(phimis::multi_sample_variance{}, on.view(),
                                                  pair_point<TestType>{{first, 1 - first}, {1, 1}, 1, 1});
      const long double a = static_cast<long double>(first);
      const long double h = 1e-4L;  // h² = 1e-8 of higher derivatives, which are up to (p1 − p2)⁴/p⁴ < 1e8 / 1e4 times
      const long double below = space.variance(a - h), at = space.variance(a), above = space.variance(a + h);
      const long double first_derivative = (above - below) / (2 * h);
      const long double second_derivative = (above - 2 * at + below) / (h * h);
      const long double tolerance = 1e-5L + 1000 * static_cast<long double>(std::numeric_limits<TestType>::epsilon());
      CHECK(std::fabs(computed.zeta + first_derivative) <= tolerance * (1 + std::fabs(first_derivative)));
      CHECK(std::fabs(computed.slope - second_derivative) <= tolerance * (1 + std::fabs(second_derivative)));
    }
  }
}

TEST_CASE("Normalising factors of the pdfs are factors of the pdfs in the multi-sample variance") {
  // κ_k of rows whose pdfs were divided by κ_k, and n = mass, give the same sums.
  const discrete space(30, 4);
  auto on = space.as_rows<double>();
  const pair_sums wanted =
      phimis::sum_pair(phimis::multi_sample_variance{}, on.view(), pair_point<double>{{0.3, 0.7}, {1, 1}, 1, 1});
  for (auto& y : on.y1) y /= 4;
  for (auto& y : on.y2) y /= 2;
  const pair_sums computed =
      phimis::sum_pair(phimis::multi_sample_variance{}, on.view(), pair_point<double>{{0.3, 0.7}, {4, 2}, 1, 1});
  CHECK(computed.zeta == Approx(wanted.zeta).epsilon(1e-13));
  CHECK(computed.slope == Approx(wanted.slope).epsilon(1e-13));
  CHECK(computed.lambda == Approx(wanted.lambda).epsilon(1e-13));
}
