// SPDX-License-Identifier: MIT
#include "catch.hpp"
#include "colour.hpp"
#include "random.hpp"

#include <phimis/core/estimator.hpp>

#include <cmath>
#include <limits>
#include <type_traits>
#include <vector>

namespace {

constexpr int M = 3;
using phimis::sampling_model;

struct sample {
  int technique;
  double y;
};

std::vector<sample> random_samples(int n, std::uint64_t seed) {
  random_numbers random(seed);
  std::vector<sample> all;
  for (int i = 0; i < n; ++i) {
    const int k = i < M ? i : random.below(M);
    all.push_back({k, random() < 0.2 ? 0 : random.between(-1, 3) + k});
  }
  return all;
}

struct naive {
  long double estimate = 0, one_sample = 0, multi_sample = 0, ess = 0, freedom = 0;
};

/// The formulas of the papers, in long double and two passes.
naive naively(const std::vector<sample>& all) {
  const long double N = static_cast<long double>(all.size());
  naive result;
  long double sum = 0, squares = 0, absolute = 0, spread = 0;
  for (const sample& s : all) {
    sum += s.y;
    squares += static_cast<long double>(s.y) * s.y;
    absolute += std::fabs(s.y);
  }
  result.estimate = sum / N;
  for (const sample& s : all) spread += (s.y - result.estimate) * (s.y - result.estimate);
  result.one_sample = spread / (N - 1) / N;
  long double inverse = 0;
  for (int k = 0; k < M; ++k) {
    long double n = 0, mean = 0, own = 0;
    for (const sample& s : all) {
      n += s.technique == k;
      mean += s.technique == k ? s.y : 0;
    }
    if (n < 1) continue;
    mean /= n;
    for (const sample& s : all) own += s.technique == k ? (s.y - mean) * (s.y - mean) : 0;
    const long double others = (N * result.estimate - mean) / (N - 1);
    const long double variance = n > 1 ? own / (n - 1) : (mean - others) * (mean - others);
    result.multi_sample += n * variance / (N * N);
    inverse += n * variance * n * variance / (n > 1 ? n - 1 : 1);
  }
  result.freedom = result.multi_sample * N * N * result.multi_sample * N * N / inverse;
  result.ess = squares > 0 ? absolute * absolute / squares : 0;
  return result;
}

void check(const phimis::estimator<double, M>& computed, const std::vector<sample>& all) {
  const naive wanted = naively(all);
  const auto agrees = [](double a, long double b) { return std::fabs(a - static_cast<double>(b)) <= 1e-13 * std::fabs(a); };
  CHECK(computed.samples() == static_cast<std::int64_t>(all.size()));
  CHECK(agrees(computed.estimate(), wanted.estimate));
  CHECK(agrees(computed.variance(sampling_model::one_sample), wanted.one_sample));
  CHECK(agrees(computed.variance(sampling_model::multi_sample), wanted.multi_sample));
  CHECK(agrees(computed.standard_error(sampling_model::multi_sample), std::sqrt(wanted.multi_sample)));
  CHECK(agrees(computed.effective_sample_size(), wanted.ess));
  CHECK(agrees(computed.degrees_of_freedom(sampling_model::multi_sample), wanted.freedom));
  CHECK(computed.degrees_of_freedom(sampling_model::one_sample) == static_cast<double>(all.size() - 1));
}

}  // namespace

TEST_CASE("Estimate, both variances and effective sample size are those of the formulas") {
  for (const int n : {5, 20, 300}) {
    const auto all = random_samples(n, static_cast<std::uint64_t>(n));
    phimis::estimator<double, M> computed;
    std::int64_t zero = 0;
    for (const sample& s : all) {
      computed.add(s.technique, s.y);
      zero += s.y == 0;
    }
    check(computed, all);
    CHECK(computed.zero() == zero);
    CHECK(computed.nonfinite() == 0);
  }
}

TEST_CASE("Degrees of freedom are those of the technique that has the variance") {
  phimis::estimator<double, M> computed;
  CHECK(computed.degrees_of_freedom(sampling_model::multi_sample) == 0);
  for (int j = 0; j < 8; ++j) computed.add(0, 1);
  CHECK(computed.degrees_of_freedom(sampling_model::multi_sample) == 7);
  for (int j = 0; j < 5; ++j) computed.add(1, j);
  CHECK(computed.degrees_of_freedom(sampling_model::multi_sample) == Approx(4));
  CHECK(computed.degrees_of_freedom(sampling_model::one_sample) == 12);
}

TEMPLATE_TEST_CASE("Degrees of freedom do not overflow where contributions are far apart", "", float, double) {
  phimis::estimator<TestType, 2> computed;
  const TestType huge = std::sqrt(std::numeric_limits<TestType>::max()) / 100;
  for (int j = 0; j < 4; ++j) computed.add(0, static_cast<TestType>(j));
  for (int j = 0; j < 3; ++j) computed.add(1, huge * static_cast<TestType>(j));
  CHECK(computed.degrees_of_freedom(sampling_model::multi_sample) == Approx(2));
}

TEST_CASE("A technique with one sample counts by its distance to the mean of the others") {
  const std::vector<sample> all{{0, 1}, {0, 2}, {0, 4}, {1, 7}};
  phimis::estimator<double, M> computed;
  for (const sample& s : all) computed.add(s.technique, s.y);
  check(computed, all);
  CHECK(computed.samples(0) == 3);
  CHECK(computed.samples(1) == 1);
  CHECK(computed.samples(2) == 0);
}

TEST_CASE("Merged estimators are one estimator, in any grouping") {
  const auto all = random_samples(200, 1);
  random_numbers random(2);
  std::vector<phimis::estimator<double, M>> groups(7);
  for (const sample& s : all) groups[random.bits() % groups.size()].add(s.technique, s.y);
  groups[3].add(2, std::numeric_limits<double>::quiet_NaN());
  while (groups.size() > 1) {
    groups[random.bits() % (groups.size() - 1)].merge(groups.back());
    groups.pop_back();
  }
  auto with_zero = all;
  with_zero.push_back({2, 0});  // what is not finite enters as 0
  check(groups.front(), with_zero);
  CHECK(groups.front().nonfinite() == 1);
  static_assert(std::is_trivially_copyable<phimis::estimator<double, M>>::value, "");
}

TEMPLATE_TEST_CASE("Contributions that are not finite are counted and enter as zero", "", float, double) {
  using limits = std::numeric_limits<TestType>;
  phimis::estimator<TestType, 2> computed;
  computed.add(0, TestType(6));
  computed.add(0, limits::quiet_NaN());
  computed.add(1, limits::infinity());
  computed.add(1, -limits::infinity());
  CHECK(computed.samples() == 4);
  CHECK(computed.samples(1) == 2);
  CHECK(computed.nonfinite() == 3);
  CHECK(computed.zero() == 0);
  CHECK(computed.estimate() == TestType(1.5));
  CHECK(phimis::is_finite(computed.variance(sampling_model::multi_sample)));
  CHECK(computed.effective_sample_size() == Approx(1));
}

TEST_CASE("Without samples, or with zeros alone, nothing is NaN") {
  phimis::estimator<double, 2> computed;
  for (int i = 0; i < 3; ++i) {
    CHECK(computed.estimate() == 0);
    // One sample says nothing of a spread.
    const double unknown = i < 2 ? std::numeric_limits<double>::infinity() : 0;
    CHECK(computed.variance(sampling_model::multi_sample) == unknown);
    CHECK(computed.variance(sampling_model::one_sample) == unknown);
    CHECK(computed.effective_sample_size() == 0);
    computed.add(i % 2, 0);
  }
  CHECK(computed.zero() == 3);
}

TEMPLATE_TEST_CASE("The variance of a colour is unknown in every component with fewer than two samples", "", float, double) {
  phimis::estimator<colour<TestType>, 2> computed;
  for (int samples = 0; samples < 2; ++samples) {
    const auto error = computed.standard_error(sampling_model::multi_sample);
    for (int i = 0; i < 3; ++i) CHECK(error[i] == std::numeric_limits<TestType>::infinity());
    computed.add(0, colour<TestType>{{1, 2, 3}});
  }
}

TEMPLATE_TEST_CASE("Equal contributions have no variance and count in full", "", float, double) {
  phimis::estimator<TestType, 2> computed;
  for (int i = 0; i < 10; ++i) computed.add(i % 2, TestType(0.75));
  CHECK(computed.variance(sampling_model::multi_sample) == 0);
  CHECK(computed.variance(sampling_model::one_sample) == 0);
  CHECK(computed.effective_sample_size() == Approx(10));
}

TEST_CASE("The effective sample size does not depend on the unit of f, as far as its square is a number") {
  for (const double unit : {1e-150, 1.0, 1e150}) {
    INFO(unit);
    phimis::estimator<double, 1> computed;
    for (const double y : {1.0, 2.0, 0.0, 5.0}) computed.add(0, y * unit);
    CHECK(computed.effective_sample_size() == Approx(64.0 / 30));
  }
}

TEMPLATE_TEST_CASE("A colour is estimated by component and weighed by luminance", "", float, double) {
  phimis::estimator<colour<TestType>, M> computed;
  phimis::estimator<double, M> component[3], luminance;
  for (const sample& s : random_samples(50, 8)) {
    const colour<TestType> y{{static_cast<TestType>(s.y), static_cast<TestType>(2 * s.y + 1), static_cast<TestType>(-s.y)}};
    computed.add(s.technique, y);
    for (int i = 0; i < 3; ++i) component[i].add(s.technique, static_cast<double>(y[i]));
    luminance.add(s.technique, static_cast<double>(phimis::value_traits<colour<TestType>>::magnitude(y)));
  }
  // 50 samples, each with a few roundings.
  const double epsilon = 500 * static_cast<double>(std::numeric_limits<TestType>::epsilon());
  for (int i = 0; i < 3; ++i) {
    CHECK(static_cast<double>(computed.estimate()[i]) == Approx(component[i].estimate()).epsilon(epsilon));
    for (const auto model : {sampling_model::multi_sample, sampling_model::one_sample}) {
      CHECK(static_cast<double>(computed.standard_error(model)[i]) ==
            Approx(component[i].standard_error(model)).epsilon(epsilon));
    }
  }
  CHECK(static_cast<double>(computed.effective_sample_size()) ==
        Approx(luminance.effective_sample_size()).epsilon(epsilon));
  computed.add(0, {{1, std::numeric_limits<TestType>::infinity(), 1}});
  CHECK(computed.nonfinite() == 1);
}

namespace {

/// The balance heuristic by its weights, which `contribution` cannot recognise.
struct balance_by_weights {
  template <class Real, int N>
  Real operator()(int i, const phimis::fractions<Real, N>& alpha, const phimis::per_technique<Real, N>& pdfs) const {
    return phimis::balance{}(i, alpha, pdfs);
  }
};

}  // namespace

TEMPLATE_TEST_CASE("A contribution is w f / (alpha p), f / p(alpha) for the balance heuristic", "", float, double) {
  const phimis::fractions<TestType, 2> alpha{{TestType(0.25), TestType(0.75)}};
  const phimis::per_technique<TestType, 2> pdfs{{2, 6}};  // α p = .5, 4.5
  const TestType f = 10;
  const TestType epsilon = 8 * std::numeric_limits<TestType>::epsilon();
  for (int k = 0; k < 2; ++k) {
    CHECK(std::fabs(phimis::contribution(phimis::balance{}, k, f, alpha, pdfs) - 2) <= 2 * epsilon);
    CHECK(std::fabs(phimis::contribution(balance_by_weights{}, k, f, alpha, pdfs) - 2) <= 2 * epsilon);
  }
  // Power 2: w = .25/20.5 and 20.25/20.5.
  CHECK(std::fabs(phimis::contribution(phimis::power{}, 0, f, alpha, pdfs) - TestType(5 / 20.5)) <= epsilon);
  CHECK(std::fabs(phimis::contribution(phimis::power{}, 1, f, alpha, pdfs) - TestType(45 / 20.5)) <= 4 * epsilon);
  CHECK(phimis::contribution(phimis::maximum{}, 0, f, alpha, pdfs) == 0);
  const auto red = phimis::contribution(phimis::balance{}, 0, colour<TestType>{{10, 0, -10}}, alpha, pdfs);
  CHECK(std::fabs(red[0] - 2) <= 2 * epsilon);
  CHECK(std::fabs(red[2] + 2) <= 2 * epsilon);
}

TEMPLATE_TEST_CASE("A pdf of 0 at its own sample is counted, not summed", "", float, double) {
  const auto alpha = phimis::equal_fractions<TestType, 2>();
  const phimis::per_technique<TestType, 2> none{};
  phimis::estimator<TestType, 2> computed;
  computed.add(0, phimis::contribution(phimis::balance{}, 0, TestType(1), alpha, none));
  computed.add(0, phimis::contribution(phimis::power{}, 0, TestType(1), alpha, none));
  CHECK(computed.nonfinite() == 2);
  CHECK(computed.estimate() == 0);
}
