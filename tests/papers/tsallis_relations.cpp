// SPDX-License-Identifier: MIT
// What must hold between the two variances on the examples of Sbert & Szirmay-Kalos 2022, whatever the numbers are.
#include "catch.hpp"
#include "tsallis_data.hpp"

namespace {

using namespace papers_test;
using phimis::analysis::divergence_at;
using phimis::analysis::gamma_moments;
using phimis::analysis::optimum;
using phimis::analysis::variance;

}  // namespace

TEST_CASE("The variances of both sampling models are equal at the Kullback-Leibler optimum") {
  for (int n = 1; n <= 3; ++n) {
    CAPTURE(n);
    const auto at = variance(example(n), optimum(phimis::kullback_leibler{}, example(n)).alpha);
    CHECK(at.difference.value <= 1e-10 * at.one_sample.value + 1e-20);
    CHECK(std::fabs(at.one_sample.value - at.multi_sample.value) <= 1e-10 * at.one_sample.value + 1e-20);
  }
}

TEST_CASE("The multi-sample variance is never above the one-sample variance") {
  for (int n = 1; n <= 3; ++n) {
    for (int i = 1; i < 1000; ++i) {
      const double alpha = i / 1000.0;
      CAPTURE(n, alpha);
      const auto at = variance(example(n), fractions{{alpha, 1 - alpha}});
      REQUIRE(at.multi_sample.value <= at.one_sample.value);
      REQUIRE(at.difference.value >= 0);
    }
  }
}

TEST_CASE("Away from order one the optima have a smaller multi-sample variance, contrary to the caption of Fig. 3") {
  for (const int n : {1, 3}) {
    for (int i = 1; i <= 80; ++i) {
      if (i == 10) continue;
      CAPTURE(n, i);
      const auto at = variance(example(n), optimum(phimis::tsallis{i / 10.0}, example(n)).alpha);
      CHECK(at.multi_sample.value < at.one_sample.value);
      CHECK(at.difference.value > 1e-7 * at.one_sample.value);
    }
  }
}

TEST_CASE("The optimum of a variance is the least of its values on a dense grid of fractions") {
  for (int n = 1; n <= 3; ++n) {
    const double multi =
        variance(example(n), optimum(phimis::multi_sample_variance{}, example(n)).alpha).multi_sample.value;
    const double one =
        variance(example(n), optimum(phimis::one_sample_variance{}, example(n)).alpha).one_sample.value;
    for (int i = 1; i < 1000; ++i) {
      const double alpha = i / 1000.0;
      CAPTURE(n, alpha);
      const auto at = variance(example(n), fractions{{alpha, 1 - alpha}});
      REQUIRE(multi <= at.multi_sample.value);
      REQUIRE(one <= at.one_sample.value);
    }
  }
}

TEST_CASE("The one-sample variance is the squared mean times the chi-squared divergence") {
  for (int n = 1; n <= 3; ++n) {
    for (const double alpha : {0.1, 0.3, 0.5, 0.9}) {
      CAPTURE(n, alpha);
      const fractions at{{alpha, 1 - alpha}};
      const double mu = example(n).mean().value;
      const double chi = divergence_at(phimis::chi_squared{}, example(n), at).value;
      CHECK(mu * mu * chi == Approx(variance(example(n), at).one_sample.value).epsilon(1e-11));
    }
  }
}

TEST_CASE("The gamma-moments of both techniques are equal at the optimum of their order") {
  for (int n = 1; n <= 3; ++n) {
    for (const double gamma : {0.1, 0.5, 1.0, 2.0, 8.0}) {
      CAPTURE(n, gamma);
      const auto found = optimum(phimis::tsallis{gamma}, example(n));
      const auto moments = gamma_moments(example(n), gamma, found.alpha);
      CHECK(moments[0].value == Approx(moments[1].value).epsilon(1e-10));
    }
  }
}

TEST_CASE("The zeroth moments are one at all fractions and cannot give the reversed Kullback-Leibler optimum") {
  for (int n = 1; n <= 3; ++n) {
    for (const double alpha : {0.1, 0.5, 0.9}) {
      const auto moments = gamma_moments(example(n), 0, fractions{{alpha, 1 - alpha}});
      CHECK(moments[0].value == Approx(1).epsilon(1e-12));
      CHECK(moments[1].value == Approx(1).epsilon(1e-12));
    }
  }
  // The condition is that of E_{p_k}[log(p/f)].
  const auto reversed = phimis::reversed<phimis::kullback_leibler>{};
  for (int n = 1; n <= 3; ++n) {
    const fractions alpha = optimum(reversed, example(n)).alpha;
    double expected[2];
    for (int k = 0; k < 2; ++k) {
      expected[k] = example(n)
                        .integral([&](double f, const phimis::per_technique<double, 2>& p, double) {
                          return p[k] * std::log(phimis::mixture(alpha, p) / f);
                        })
                        .value;
    }
    CHECK(expected[0] == Approx(expected[1]).epsilon(1e-11));
  }
}
