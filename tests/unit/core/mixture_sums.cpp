// SPDX-License-Identifier: MIT
#include "catch.hpp"
#include "divergences.hpp"
#include "random.hpp"

#include <phimis/core/divergence_at.hpp>
#include <phimis/core/mixture_sums.hpp>

#include <cmath>
#include <cstddef>
#include <vector>

namespace {

constexpr int M = 5;

template <class Real>
struct random_rows {
  std::vector<Real> u, w, y[M];
  const Real* columns[M];

  random_rows(int n, std::uint64_t seed) {
    random_numbers next(seed);
    for (int j = 0; j < n; ++j) {
      u.push_back(static_cast<Real>(next.between(0.1, 2)));
      w.push_back(static_cast<Real>(next.between(0.5, 3)));
      for (auto& column : y) column.push_back(static_cast<Real>(next()));
    }
    for (int k = 0; k < M; ++k) columns[k] = y[k].data();
  }
  phimis::column_pointers<Real> view() const {
    return {u.data(), w.data(), columns, static_cast<std::ptrdiff_t>(u.size()), M};
  }
};

constexpr double beta[M] = {0.3, 0, 0.2, 0.1, 0.4};
constexpr double unit = 0.7;

/// The sums by their definition.
struct definition {
  long double lambda = 0;
  long double g[M] = {};
  long double size[M] = {};
  long double h[M][M] = {};

  template <class Divergence, class Real>
  definition(const Divergence& divergence, const random_rows<Real>& rows, long double zero, std::size_t every) {
    for (std::size_t j = 0; j < rows.u.size(); ++j) {
      if ((j / 64) % every != 0) continue;
      long double x = 0;
      for (int k = 0; k < M; ++k) x += beta[k] * static_cast<long double>(rows.y[k][j]);
      const auto s = phimis::score_at(divergence, static_cast<long double>(unit) * rows.u[j] / x);
      const long double w = rows.w[j];
      const bool power = phimis::has_exponent<Divergence>::value;
      const long double term = std::fabs(s.value - zero) + (power ? 0 : s.slope + std::fabs(zero));
      lambda += w * x * term;
      for (int k = 0; k < M; ++k) {
        const long double yk = rows.y[k][j];
        g[k] += w * yk * (s.value - zero);
        size[k] += w * yk * term;
        for (int l = 0; l < M; ++l) h[k][l] += w * yk * static_cast<long double>(rows.y[l][j]) * s.slope / x;
      }
    }
  }
};

/// Powers other than 0 are without the constants of score_at; at 0 and elsewhere λ has the slope.
template <class Divergence>
bool has_scale_without_slope(const Divergence& divergence) {
  if constexpr (phimis::has_exponent<Divergence>::value) {
    return divergence.exponent() != 0;
  } else {
    return true;
  }
}

}  // namespace

TEMPLATE_TEST_CASE("Gradients and Hessians are their definitions for any number of rows", "", float, double) {
  const double tolerance = std::is_same<TestType, float>::value ? 3e-5 : 2e-14;  // a hundred roundings
  for (const int n : {1, 2, 3, 63, 64, 65, 130, 640}) {
    const random_rows<TestType> rows(n, static_cast<std::uint64_t>(n));
    const auto view = rows.view();
    for_each_divergence([&](const char* name, const auto& divergence) {
      if (!has_scale_without_slope(divergence)) return;
      for (const bool normalised : {true, false}) {
        for (const int every : {1, 3}) {
          if (every > 1 && n % 64 != 0) continue;  // which part of an odd block is left out is nobody's promise
          CAPTURE(name, n, normalised, every);
          const definition truth(divergence, rows, normalised ? 0 : phimis::score_at_zero(divergence),
                                 static_cast<std::size_t>(every));
          double gradient[2 * M + 1];
          const double& lambda = gradient[0];
          const double* const g = gradient + 1;
          const double* const sizes = gradient + 1 + M;
          double h[9];
          const int support[2] = {4, 1};
          const double fixed[M] = {0, 0.5, 0, 0.25, 0};
          phimis::with_mixture_sums(divergence, view, beta, unit, normalised, every, [&](const auto& sums) {
            sums.gradient(gradient);
            sums.hessian(support, 2, fixed, h);
          });
          const double scale = static_cast<double>(truth.lambda) * tolerance;
          CHECK(std::fabs(lambda - static_cast<double>(truth.lambda)) <= scale);
          for (int k = 0; k < M; ++k) {
            CHECK(std::fabs(g[k] - static_cast<double>(truth.g[k])) <= 10 * scale);
            CHECK(std::fabs(sizes[k] - static_cast<double>(truth.size[k])) <= 10 * scale);
          }
          const auto column = [&](int a, int k) { return a < 2 ? (support[a] == k ? 1.0 : 0.0) : fixed[k]; };
          for (int a = 0; a < 3; ++a) {
            for (int b = 0; b < 3; ++b) {
              long double expected = 0;
              long double size = 0;
              for (int k = 0; k < M; ++k) {
                for (int l = 0; l < M; ++l) expected += column(a, k) * column(b, l) * truth.h[k][l];
                size += std::fabs(truth.h[k][k]);
              }
              CHECK(std::fabs(h[a * 3 + b] - static_cast<double>(expected)) <= tolerance * static_cast<double>(size));
            }
          }
        }
      }
    });
  }
}

TEST_CASE("The reference is the ratio of the largest score") {
  random_rows<double> rows(100, 1);
  rows.u[7] = 0;
  rows.u[20] = 900;
  rows.u[30] = 1e-5;
  const auto view = rows.view();
  const auto ratio = [&](std::size_t j) {
    double x = 0;
    for (int k = 0; k < M; ++k) x += beta[k] * rows.y[k][j];
    return unit * rows.u[j] / x;
  };
  phimis::with_mixture_sums(phimis::chi_squared{}, view, beta, unit, true, 1, [&](const auto& sums) {
    CHECK(std::fabs(sums.reference(true) / ratio(20) - 1) <= 1e-14);
    CHECK(std::fabs(sums.reference(false) / ratio(30) - 1) <= 1e-14);
  });
}
