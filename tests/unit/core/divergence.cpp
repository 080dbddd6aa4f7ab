// SPDX-License-Identifier: MIT
#include "catch.hpp"
#include "divergences.hpp"

#include <phimis/core/divergence.hpp>
#include <phimis/core/divergence_at.hpp>
#include <phimis/core/kink.hpp>

#include <cmath>
#include <limits>

namespace {

constexpr long double infinity = std::numeric_limits<long double>::infinity();

// No point is 1, where some φ have kinks.
constexpr long double points[] = {0.05L, 0.3L, 0.8L, 0.97L, 1.02L, 1.3L, 2.5L, 7.0L, 40.0L};

bool near(long double a, long double b, long double tolerance) {
  return std::fabs(a - b) <= tolerance * (1 + std::fabs(a) + std::fabs(b));
}

}  // namespace

TEST_CASE("phi has the values of its formula") {
  for_each_divergence([](const char* name, const auto& d) {
    INFO(name);
    for (const long double t : points) {
      CHECK(near(phimis::phi_at(d, t), true_phi_at(d, t).value, 1e-15L));
      CHECK(near(phimis::phi_at(d, static_cast<double>(t)), true_phi_at(d, t).value, 1e-14L));
      CHECK(near(phimis::phi_at(d, static_cast<float>(t)), true_phi_at(d, t).value, 4e-6L));
    }
  });
}

TEST_CASE("The score is t phi' - phi up to a constant factor and term, and slope is t times its derivative") {
  for_each_divergence([](const char* name, const auto& d) {
    INFO(name);
    const auto by_differences = [&d](long double t) {
      // Central differences: h² φ''' + ε/h with h = 1e-6 and ε = 1e-19.
      const long double h = 1e-6L * t;
      const long double first = (phimis::phi_at(d, t + h) - phimis::phi_at(d, t - h)) / (2 * h);
      return t * first - phimis::phi_at(d, t);
    };
    const auto score = [&d](long double t) { return phimis::score_at(d, t); };
    // s = a + b (t φ' − φ), from the ends.
    const long double low = by_differences(points[0]);
    const long double high = by_differences(points[8]);
    const long double b = (score(points[8]).value - score(points[0]).value) / (high - low);
    const long double a = score(points[0]).value - b * low;
    CHECK(b > 0);
    for (const long double t : points) {
      INFO(static_cast<double>(t));
      CHECK(near(score(t).value, a + b * by_differences(t), 1e-8L));
      const long double h = 1e-6L * t;
      CHECK(near(score(t).slope, t * (score(t + h).value - score(t - h).value) / (2 * h), 1e-8L));
    }
  });
}

TEST_CASE("Where a kink is rounded off the score is that of the rounded phi") {
  const auto check = [](const auto& d, long double t, long double width) {
    const auto phi = [&](long double at) { return d.taylor(at, width).value; };
    const long double h = 1e-5L * width;
    const auto at = d.taylor(t, width);
    const auto score = d.score_of(t, width);
    CAPTURE(static_cast<double>(t), static_cast<double>(width));
    CHECK(near(at.first, (phi(t + h) - phi(t - h)) / (2 * h), 1e-8L));
    CHECK(near(at.second, (d.taylor(t + h, width).first - d.taylor(t - h, width).first) / (2 * h), 1e-7L));
    CHECK(near(score.value, t * at.first - at.value, 1e-15L));
    CHECK(near(score.slope, t * t * at.second, 1e-15L));
  };
  for (const long double width : {0.3L, 0.01L}) {
    for (const long double t : {0.2L, 0.9L, 0.999L, 1.0L, 1.02L, 4.0L}) {
      check(phimis::total_variation{}, t, width);
      for (const double k : {1.0, 1.5, 3.0}) check(phimis::pearson_vajda{k}, t, width);
    }
  }
}

TEMPLATE_TEST_CASE("The score in working precision is the score in long double", "", float, double) {
  const long double tolerance = 100 * static_cast<long double>(std::numeric_limits<TestType>::epsilon());
  for_each_divergence([tolerance](const char* name, const auto& d) {
    INFO(name);
    for (const long double point : points) {
      const TestType t = static_cast<TestType>(point);
      const auto computed = phimis::score_at(d, t);
      const auto wanted = phimis::score_at(d, static_cast<long double>(t));
      // s near a kink loses the digits of t − 1.
      const long double lost = 1 + 1 / std::fabs(static_cast<long double>(t) - 1);
      CHECK(near(computed.value, wanted.value, tolerance * lost));
      CHECK(near(computed.slope, wanted.slope, tolerance * lost));
    }
  });
}

TEST_CASE("The score never decreases") {
  for_each_divergence([](const char* name, const auto& d) {
    INFO(name);
    double before = phimis::score_at(d, 1e-6).value;
    for (double t = 1.1e-6; t < 1e6; t *= 1.1) {
      const auto s = phimis::score_at(d, t);
      REQUIRE(s.value >= before - 1e-12 * std::fabs(before));
      REQUIRE(s.slope >= 0);
      before = s.value;
    }
  });
}

TEST_CASE("phi is convex and 0 at one") {
  for_each_divergence([](const char* name, const auto& d) {
    INFO(name);
    CHECK(phimis::phi_at(d, 1.0) == 0);
    CHECK(phimis::phi_at(d, 1.0f) == 0);
    for (long double t = 1e-3L; t < 1e3L; t *= 1.05L) {
      const long double chord = (phimis::phi_at(d, t * 0.9L) + phimis::phi_at(d, t * 1.1L)) / 2;
      const long double size = std::fabs(chord) + t;
      REQUIRE(phimis::phi_at(d, t) <= chord + 1e-17L * size);
    }
  });
}

TEST_CASE("phi and the score at 0 are their limits") {
  for_each_divergence([](const char* name, const auto& d) {
    INFO(name);
    const long double at_zero = phimis::phi_at(d, 0.0L);
    const long double tiny = 1e-4000L;  // its powers of .1 are still 1e-400
    if (at_zero == infinity) {
      CHECK(phimis::phi_at(d, tiny) > 1e3L);
    } else {
      CHECK(near(at_zero, phimis::phi_at(d, tiny), 1e-15L));  // 1 − γ is a double
    }
    const auto score = phimis::score_at(d, 0.0L);
    if (score.value == -infinity) {
      CHECK(phimis::score_at(d, tiny).value < -1e3L);
    } else {
      CHECK(near(score.value, phimis::score_at(d, tiny).value, 1e-18L));
    }
    // Three types, one limit.
    CHECK(static_cast<long double>(phimis::phi_at(d, 0.0)) == Approx(static_cast<double>(at_zero)));
    CHECK(static_cast<long double>(phimis::phi_at(d, 0.0f)) == Approx(static_cast<double>(at_zero)));
  });
}

TEST_CASE("A divergence is infinite at f = 0 exactly where phi is infinite at 0") {
  for_each_divergence([](const char* name, const auto& d) {
    INFO(name);
    CHECK(phimis::infinite_at_zero(d) == (phimis::phi_at(d, 0.0L) == infinity));
  });
  using phimis::reversed;
  CHECK_FALSE(phimis::infinite_at_zero(phimis::kullback_leibler{}));
  CHECK_FALSE(phimis::infinite_at_zero(phimis::multi_sample_variance{}));
  CHECK_FALSE(phimis::infinite_at_zero(reversed{phimis::tsallis{0.99}}));
  CHECK_FALSE(phimis::infinite_at_zero(reversed{phimis::hellinger{}}));
  CHECK_FALSE(phimis::infinite_at_zero(reversed{phimis::total_variation{}}));
  CHECK_FALSE(phimis::infinite_at_zero(reversed{phimis::pearson_vajda{1}}));
  CHECK(phimis::infinite_at_zero(reversed{phimis::tsallis{1}}));
  CHECK(phimis::infinite_at_zero(reversed{phimis::kullback_leibler{}}));
  CHECK(phimis::infinite_at_zero(reversed{phimis::chi_squared{}}));
  CHECK(phimis::infinite_at_zero(reversed{phimis::pearson_vajda{1.5}}));
}

TEMPLATE_TEST_CASE("The power score is continuous in its exponent", "", float, double) {
  // |∂s/∂β| = t^β |log t| and |∂(ts')/∂β| <= t^β (1 + β |log t|).
  const TestType step = 16 * std::numeric_limits<TestType>::epsilon();
  for (const TestType beta : {TestType(0.5), TestType(1), TestType(2)}) {
    for (const TestType t : {TestType(0.01), TestType(0.5), TestType(3), TestType(90)}) {
      const auto at = phimis::power_score(t, beta);
      const TestType size = std::pow(t, beta) * (1 + 3 * std::fabs(std::log(t)));
      for (const TestType other : {beta - step, beta + step}) {
        const auto near_by = phimis::power_score(t, other);
        CHECK(std::fabs(near_by.value - at.value) <= 2 * step * size);
        CHECK(std::fabs(near_by.slope - at.slope) <= 2 * step * size);
      }
    }
  }
}

TEST_CASE("The power score of exponent 0 is the limit (t^beta - 1)/beta") {
  for (const long double beta : {1e-8L, -1e-8L}) {
    for (const long double t : {0.01L, 0.5L, 3.0L, 90.0L}) {
      const auto limit = phimis::power_score(t, 0.0L);
      const auto close = phimis::power_score(t, beta);
      const long double sign = beta > 0 ? 1 : -1;
      CHECK(near((close.value - sign) / std::fabs(beta), limit.value, 1e-6L));
      CHECK(near(close.slope / std::fabs(beta), limit.slope, 1e-6L));
    }
  }
}

TEST_CASE("Reversing a Tsallis divergence turns gamma into 1 - gamma") {
  for (const double gamma : {0.1, 0.5, 1.0, 2.0, 3.5}) {
    CHECK(phimis::reversed{phimis::tsallis{gamma}}.exponent() == 1 - gamma);
  }
  // (1 − γ) D_γ(p, g) = γ D_{1−γ}(g, p): (1 − γ) φ*_γ = 1 − t^{1−γ} and γ φ_{1−γ} = t − t^{1−γ} differ by 1 − t.
  for (const double gamma : {0.1, 0.3, 0.9}) {
    const long double g = gamma;
    for (const long double t : points) {
      const long double back = (1 - g) * phimis::phi_at(phimis::reversed{phimis::tsallis{gamma}}, t);
      const long double forward = g * phimis::phi_at(phimis::tsallis{1 - gamma}, t);
      CHECK(near(back - forward, 1 - t, 1e-15L));
    }
  }
}

TEST_CASE("Pearson-Vajda of orders one and two are twice total variation and chi squared") {
  for (const long double t : points) {
    CHECK(near(phimis::phi_at(phimis::pearson_vajda{1}, t), 2 * phimis::phi_at(phimis::total_variation{}, t), 1e-18L));
    // (t − 1)² and t² − t differ by a multiple of t − 1.
    const long double difference =
        phimis::phi_at(phimis::pearson_vajda{2}, t) - phimis::phi_at(phimis::chi_squared{}, t);
    CHECK(near(difference, 1 - t, 1e-17L));
  }
}

TEST_CASE("Which divergences are powers and which have kinks is known at compile time") {
  using namespace phimis;
  static_assert(has_exponent<tsallis>::value && has_exponent<reversed<hellinger>>::value, "");
  static_assert(has_exponent<one_sample_variance>::value, "");
  static_assert(!has_exponent<total_variation>::value && !has_exponent<reversed<pearson_vajda>>::value, "");
  static_assert(!has_exponent<multi_sample_variance>::value, "");
  static_assert(detail::is_kinked<reversed<total_variation>>::value, "");
  static_assert(!detail::is_kinked<reversed<tsallis>>::value, "");
  CHECK(one_sample_variance{}.exponent() == 2);
}
