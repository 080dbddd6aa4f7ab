// SPDX-License-Identifier: MIT
// Sums over ten million observations against exact ones.
//
// Observations are made of integers, so that references are exact: sums of integers, or sums in long double (64 digits), of
// which 1e7 roundings are 1e7 · 2^-64 = 5e-13. -ffast-math, which may take compensated sums apart, leaves both as they are.
#include "any_rule.hpp"
#include "cases.hpp"
#include "catch.hpp"

#include <phimis/core/estimator.hpp>
#include <phimis/core/minimise_pair.hpp>
#include <phimis/solver/rules.hpp>

#include <cmath>
#include <cstdint>
#include <vector>

namespace {

using namespace hard;

constexpr std::int64_t many = 10000000;

/// Integers below 2^bits, the same everywhere: the top bits of a linear congruence (Knuth's MMIX).
class integers {
 public:
  explicit integers(int bits) : shift_(64 - bits) {}
  std::int64_t operator()() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<std::int64_t>(state_ >> shift_);
  }

 private:
  std::uint64_t state_ = 1;
  int shift_;
};

struct exact_sums {
  std::int64_t sum = 0;       // of integers below 2^19: at most 5e12
  std::uint64_t squares = 0;  // at most 2.8e18
  long double mean() const { return static_cast<long double>(sum) / many; }
  /// Of the mean of `many`, by one-sample sampling.
  long double standard_error() const {
    const long double n = many;
    return std::sqrt((static_cast<long double>(squares) / n - mean() * mean()) / (n - 1));
  }
};

/// An estimator of ten million contributions next(), all at once or merged from blocks.
template <class Real, class Next>
void check_estimator(Next next, std::int64_t block, double of_mean, double of_error) {
  phimis::estimator<Real, 2> all;
  exact_sums exact;
  for (std::int64_t done = 0; done < many; done += block) {
    phimis::estimator<Real, 2> part;
    for (std::int64_t j = 0; j < block; ++j) {
      const std::int64_t i = next();
      exact.sum += i;
      exact.squares += static_cast<std::uint64_t>(i * i);
      part.add(static_cast<int>(j % 2), static_cast<Real>(i));
    }
    all.merge(part);
  }
  const double mean = static_cast<double>(exact.mean());
  const double error = static_cast<double>(exact.standard_error());
  const double found = static_cast<double>(all.estimate());
  const double claimed = static_cast<double>(all.standard_error(phimis::sampling_model::one_sample));
  CAPTURE(block, found / mean - 1, claimed / error - 1);
  CHECK(all.samples() == many);
  CHECK(std::fabs(found - mean) <= of_mean * mean);
  CHECK(std::fabs(claimed - error) <= of_error * error);
}

}  // namespace

TEST_CASE("The estimate of ten million contributions is exact to rounding in double") {
  // A running mean is off by ε/2 times the root of n/3, a random walk that each step draws back: 2e-13. Its squares, a sum of
  // n positive terms, by ε √n: 7e-13.
  const auto uniform = [next = integers(19)]() mutable { return next(); };
  check_estimator<double>(uniform, many, 1e-12, 4e-12);
  check_estimator<double>(uniform, 1000, 1e-13, 1e-12);
  // One in 1024 is not 0: every other step draws the mean down by less than its last digits show in float.
  const auto rare = [next = integers(29)]() mutable {
    const std::int64_t i = next();
    return i >> 19 == 0 ? i & 0x7ffff : 0;
  };
  check_estimator<double>(rare, many, 1e-12, 4e-12);
}

TEST_CASE("The estimate of ten million contributions in float has the digits of a float") {
  // As above with the ε of float: 1e-4 at once, whose root of n steps are merged away in blocks.
  const auto uniform = [next = integers(19)]() mutable { return next(); };
  check_estimator<float>(uniform, many, 5e-4, 5e-3);
  check_estimator<float>(uniform, 1000, 1e-5, 1e-4);
  const auto rare = [next = integers(29)]() mutable {
    const std::int64_t i = next();
    return i >> 19 == 0 ? i & 0x7ffff : 0;
  };
  check_estimator<float>(rare, many, 5e-3, 5e-3);
  check_estimator<float>(rare, 1000, 1e-4, 1e-4);
}

namespace {

/// Ten million observations of f = p_1 + 3 p_2² and p_1 = 2x, p_2 = 2 − 2x, q = 1, x a multiple of 2^-19.
template <class Receiver>
void observe_many(std::int64_t n, const Receiver& receive) {
  integers next(19);
  for (std::int64_t j = 0; j < n; ++j) {
    const double x = (static_cast<double>(next()) + 0.5) / 524288;
    receive(0.25 + x * x, 2 * x, 2 - 2 * x);
  }
}

}  // namespace

TEST_CASE("Ten million observations move the rules that keep sums as exact sums would") {
  // Newton's step for chi squared from equal fractions, p = 1: ζ = Σ (p_1 − p_2) f², ζ' = −2 Σ (p_1 − p_2)² f².
  long double zeta = 0;
  long double slope = 0;
  auto newton =
      phimis::newton_rule(phimis::chi_squared{}, phimis::newton_form::paper, phimis::without_floors<double, 2>());
  auto streaming = phimis::streaming_rule<2>(phimis::chi_squared{}, phimis::without_floors<double, 2>());
  auto second = phimis::second_order_rule<2>(phimis::without_floors<double, 2>());
  observe_many(many, [&](double f, double p1, double p2) {
    const long double s = static_cast<long double>(f) * f;
    const long double d = static_cast<long double>(p1) - p2;
    zeta += d * s;
    slope += 2 * d * d * s;
    newton.observe({f, {{p1, p2}}, 1, 0});
    streaming.observe({f, {{p1, p2}}, 1, 0});
    second.observe({f, {{p1, p2}}, 1, 0});
  });
  const double wanted = static_cast<double>(0.5L + zeta / slope);
  // Sums of 1e7 terms in double: 1e7 roundings of ε/2, as a random walk 3e-13.
  newton.update();
  CHECK(newton.fractions()[0] == Approx(wanted).epsilon(2e-12));
  streaming.update();
  CHECK(streaming.fractions()[0] == Approx(wanted).epsilon(2e-12));
  // The rule of second order keeps the mean of cost times variance: the same step, for equal costs.
  second.update();
  CHECK(second.fractions()[0] == Approx(wanted).epsilon(2e-12));
}

TEMPLATE_TEST_CASE("The exact minimum of ten million observations satisfies its condition in long double", "", float,
                   double) {
  // In double a tenth of them: 320 MB of rows would prove no more.
  const std::int64_t n = is_float<TestType> ? many : many / 10;
  std::vector<TestType> u, w, y1, y2;
  for (auto* column : {&u, &w, &y1, &y2}) column->reserve(static_cast<std::size_t>(n));
  TestType largest = 0;
  observe_many(n, [&](double f, double p1, double p2) {
    const phimis::observation<TestType, 2> o{
        static_cast<TestType>(f), {{static_cast<TestType>(p1), static_cast<TestType>(p2)}}, 1, 0};
    phimis::row<TestType, 2> row;
    if (!phimis::to_row(o, row)) return;
    u.push_back(row.u);
    w.push_back(row.w);
    y1.push_back(row.y[0]);
    y2.push_back(row.y[1]);
    largest = std::max(largest, row.u);
  });
  REQUIRE(static_cast<std::int64_t>(u.size()) == n);
  const auto options = phimis::without_floors<TestType, 2>();
  phimis::minimisation<TestType> wanted{};
  wanted.start = wanted.from = options.start.value;
  wanted.floors = options.floors.value;
  wanted.costs = options.costs.value;
  wanted.frozen = options.frozen.value;
  wanted.variate = phimis::control_variate::off;
  const TestType* const y[] = {y1.data(), y2.data()};
  const phimis::column_pointers<TestType> rows{u.data(), w.data(), y, n, 2};
  const auto solve = [&](const auto& divergence, double beta) {
    auto alpha = options.start;
    const auto found =
        phimis::pair_minimisation<std::decay_t<decltype(divergence)>, TestType>(divergence, rows, largest, wanted)
            .minimise(alpha.value);
    CHECK(found.status == phimis::rule_status::updated);
    long double zeta = 0;
    long double lambda = 0;
    for (std::size_t j = 0; j < u.size(); ++j) {
      const long double x = static_cast<long double>(alpha[0]) * y1[j] + static_cast<long double>(alpha[1]) * y2[j];
      const long double t = u[j] / x;
      const long double s = w[j] * (beta == 2 ? t * t : t);
      zeta += (static_cast<long double>(y1[j]) - y2[j]) * s;
      lambda += x * s;
    }
    CAPTURE(beta, alpha[0]);
    CHECK(alpha[0] > TestType(0.1));
    CHECK(alpha[0] < TestType(0.9));
    // Terms are off by a few ε each at random, blocks are added in double; α is rounded to ε, which moves ζ by as much of λ.
    CHECK(std::fabs(zeta) <= 8 * static_cast<long double>(std::numeric_limits<TestType>::epsilon()) * lambda);
  };
  solve(phimis::kullback_leibler{}, 1);
  solve(phimis::chi_squared{}, 2);
}
