// SPDX-License-Identifier: MIT
// Sums over ten million observations against exact ones.
//
// Observations are made of integers, so that references are exact: sums of integers, of 128 bits where 64 are too few. The
// condition of a minimum is summed in long double (64 bits), of which 1e7 roundings are 1e7 · 2^-64 = 5e-13. -ffast-math, which
// may take compensated sums apart, leaves both as they are.
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

/// Observations of f = ¼ + x² and p_1 = 2x, p_2 = 2 − 2x, q = 1, x an odd multiple of 2^-20.
template <class Receiver>
void observe_many(std::int64_t n, const Receiver& receive) {
  integers next(19);
  for (std::int64_t j = 0; j < n; ++j) {
    const double x = (static_cast<double>(next()) + 0.5) / 524288;
    receive(0.25 + x * x, 2 * x, 2 - 2 * x);
  }
}

}  // namespace

namespace {

__extension__ using int128 = __int128;

/// α_1 after Newton's step for chi squared from equal fractions, p = 1: ζ = Σ (p_1 − p_2) f², −ζ' = 2 Σ (p_1 − p_2)² f².
/// Exact: f is a multiple of 2^-34 and p_1 − p_2 one of 2^-15.
struct exact_step {
  int128 zeta = 0;
  int128 slope = 0;  // (1.25 · 2^34)² · (2^16)² · 1e7 < 2^125

  void add(double f, double p1, double p2) {
    const auto size = static_cast<std::int64_t>(f * 17179869184);
    const auto d = static_cast<std::int64_t>((p1 - p2) * 32768);
    zeta += int128(size) * size * d;
    slope += int128(size) * size * d * d;
  }
  double fraction() const {
    return static_cast<double>(0.5L + static_cast<long double>(zeta) * 32768 / (2 * static_cast<long double>(slope)));
  }
};

/// Ten million observations, merged from blocks; x an odd multiple of 2^-17.
template <class Rule>
void check_step(const Rule& fresh, std::int64_t block, double tolerance) {
  using Real = typename Rule::real;
  integers next(16);
  exact_step exact;
  Rule rule = fresh;
  for (std::int64_t done = 0; done < many; done += block) {
    Rule part = fresh;
    for (std::int64_t j = 0; j < block; ++j) {
      const double x = (static_cast<double>(next()) + 0.5) / 65536;
      const auto f = static_cast<Real>(0.25 + x * x);
      exact.add(static_cast<double>(f), 2 * x, 2 - 2 * x);
      (block == many ? rule : part).observe({f, {{static_cast<Real>(2 * x), static_cast<Real>(2 - 2 * x)}}, 1, 0});
    }
    if (block < many) rule.merge(part);
  }
  rule.update();
  const double off = static_cast<double>(rule.fractions()[0]) - exact.fraction();
  INFO("off by " << off << ", at most " << tolerance);
  CHECK(std::fabs(off) <= tolerance);
}

}  // namespace

TEMPLATE_TEST_CASE("Ten million observations move the rules that keep sums as exact sums would", "", float, double) {
  // In double 1e7 roundings of ε/2 are a random walk to 4e-13 of a sum. Of a float too little would be left: one by one, n
  // observations are off by n ε/2 at worst. In blocks of 1e4 that is 6e-4 of either sum, and 6e-5 of 1e3 blocks; the step
  // is .28, whose terms of either sign sum to three times as much.
  constexpr bool single = is_float<TestType>;
  constexpr std::int64_t block = single ? 10000 : many;
  constexpr double tolerance = single ? 0.28 * (3 + 1) * 6.6e-4 : 2e-12;
  const auto options = phimis::without_floors<TestType, 2>();
  check_step(phimis::newton_rule(phimis::chi_squared{}, phimis::newton_form::paper, options), block, tolerance);
  check_step(phimis::streaming_rule<2>(phimis::chi_squared{}, options), block, tolerance);
  // The rule of second order keeps the mean of cost times variance: the same step, for equal costs.
  check_step(phimis::second_order_rule<2>(options), block, tolerance);
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
