// SPDX-License-Identifier: MIT
// max-Phong: what is sampled is what the pdf says, and the pdf is above the BRDF.
#include "catch.hpp"
#include "random.hpp"

#include <render/max_phong.hpp>

#include <array>
#include <cmath>
#include <numbers>

namespace {

using namespace render;

/// Seen at `degrees` from the normal, which is no axis.
max_phong surface(float degrees, float exponent, float diffuse = 0.5f, float specular = 0.5f) {
  const vector normal = vector(0.2f, 0.9f, 0.4f).normalized();
  return {normal, around(normal, std::cos(degrees * pi / 180), std::sin(degrees * pi / 180), 0.3f), exponent, diffuse,
          specular};
}

constexpr int rings = 12, sectors = 12;

/// Equal steps of the turn around an axis, and of v in sin(angle/2) = v²: fine near the axis, where the lobe is.
int bin_of(const vector& axis, const vector& direction) {
  const float v = std::sqrt((direction - axis).norm() / 2);
  const int ring = std::min(rings - 1, static_cast<int>(v * rings));
  return ring * sectors + std::min(sectors - 1, static_cast<int>(turn(axis, direction) * sectors));
}

/// ∫ p over each bin by the midpoint rule, dω = 8 v³ dv dφ.
std::array<double, rings * sectors> integral_of_pdf(const max_phong& of, const vector& axis) {
  std::array<double, rings * sectors> sums{};
  constexpr int fine = 64;
  for (int i = 0; i < rings * fine; ++i) {
    for (int j = 0; j < sectors * fine; ++j) {
      const float v = (static_cast<float>(i) + 0.5f) / (rings * fine);
      const float u = (static_cast<float>(j) + 0.5f) / (sectors * fine);
      const float t = v * v;  // sin(angle/2)
      const vector direction = around(axis, 1 - 2 * t * t, 2 * t * std::sqrt(1 - t * t), u);
      sums[static_cast<std::size_t>(i / fine * sectors + j / fine)] +=
          double{of(direction).pdf} * 8 * double{v * t} / (rings * fine) * 2 * double{pi} / (sectors * fine);
    }
  }
  return sums;
}

}  // namespace

TEST_CASE("max-Phong directions and absorbed samples are as many as the pdf says") {
  const float degrees = GENERATE(0.0f, 40.0f, 80.0f);
  const float exponent = GENERATE(1.0f, 50.0f, 5000.0f);
  const max_phong of = surface(degrees, exponent, 0.3f, 0.5f);  // a fifth is absorbed
  const vector axis = of.mirrored_view();
  const auto share = integral_of_pdf(of, axis);

  constexpr int n = 400000;
  std::array<int, rings * sectors> found{};
  random_numbers random(static_cast<std::uint64_t>(degrees + exponent));
  int lost = 0;
  for (int i = 0; i < n; ++i) {
    vector direction;
    const auto u = [&] { return static_cast<float>(phimis::uniform<float>(random.bits())); };
    const float u0 = u(), u1 = u(), u2 = u();
    if (of.sample(u0, u1, u2, direction)) {
      ++found[static_cast<std::size_t>(bin_of(axis, direction))];
    } else {
      ++lost;
    }
  }
  // χ² of the bins that expect 20 or more, the rest together. Its z is below 4.5 but for one in 1e5 (the tail of χ² is
  // longer than the normal one), and 9 are tried; the midpoint rule is exact to 1e-4 of a bin, 0.1 of its σ.
  double chi = 0, expected_rest = n, found_rest = n;
  int freedom = 0;
  for (std::size_t b = 0; b < share.size(); ++b) {
    const double expected = n * share[b];
    if (expected < 20) continue;
    chi += (found[b] - expected) * (found[b] - expected) / expected;
    expected_rest -= expected;
    found_rest -= found[b];
    ++freedom;
  }
  chi += (found_rest - expected_rest) * (found_rest - expected_rest) / expected_rest;
  INFO("degrees " << degrees << " exponent " << exponent << " chi " << chi << " of " << freedom << " lost " << lost);
  REQUIRE(freedom > 10);
  REQUIRE(expected_rest > 20);
  CHECK((chi - freedom) / std::sqrt(2.0 * freedom) < 4.5);
}

TEST_CASE("The pdf of max-Phong integrates to one at right angles, and to less where the lobe meets the horizon") {
  const auto total = [](const max_phong& of) {
    double sum = 0;
    for (const double s : integral_of_pdf(of, of.mirrored_view())) sum += s;
    return sum;
  };
  CHECK(total(surface(0, 20)) == Approx(1).epsilon(1e-3));
  // Half of a sharp lobe along the horizon is above it; the cosine lobe is whole.
  CHECK(total(surface(89.99f, 500)) == Approx(0.75).epsilon(2e-3));
}

TEST_CASE("max-Phong has the value of its formula") {
  const vector normal(0, 0, 1), view = vector(0.6f, 0, 0.8f), light = vector(-0.48f, 0.36f, 0.8f);
  // R·V = 0.8² + 0.6·0.48 = 0.928; max(N·L, N·V) = 0.8.
  const auto at = max_phong(normal, view, 3, 0.25f, 0.5f)(light);
  const double lobe = 0.5 * 4 / (2 * std::numbers::pi) * 0.928 * 0.928 * 0.928;
  CHECK(at.brdf_cosine == Approx((0.25 / std::numbers::pi + lobe / 0.8) * 0.8).epsilon(1e-5));
  CHECK(at.pdf == Approx(0.25 / std::numbers::pi * 0.8 + lobe).epsilon(1e-5));
  const vector low = vector(-0.8f, 0, 0.6f);  // N·L < N·V
  const auto there = max_phong(normal, view, 3, 0.25f, 0.5f)(low);
  CHECK(there.brdf_cosine ==
        Approx((0.25 / std::numbers::pi + 0.5 * 4 / (2 * std::numbers::pi) * std::pow(0.96, 3) / 0.8) * 0.6)
            .epsilon(1e-5));
}

TEST_CASE("The max-Phong BRDF is reciprocal, and times the cosine at most the pdf") {
  random_numbers random(7);
  const vector normal = vector(-0.3f, 0.8f, 0.1f).normalized();
  const auto direction = [&] {
    const auto c = static_cast<float>(random.between(0.01, 1));
    return around(normal, c, std::sqrt(1 - c * c), static_cast<float>(random()));
  };
  for (int i = 0; i < 1000; ++i) {
    const vector view = direction(), light = direction();
    const auto forth = max_phong(normal, view, 30)(light);
    const auto back = max_phong(normal, light, 30)(view);
    REQUIRE(forth.brdf_cosine <= forth.pdf);
    REQUIRE(forth.pdf > 0);
    // The 30th power of a cosine that is exact to 1e-7.
    REQUIRE(forth.brdf_cosine / normal.dot(light) == Approx(back.brdf_cosine / normal.dot(view)).epsilon(1e-4));
  }
  CHECK(max_phong(normal, direction(), 30)(-normal).pdf == 0);
  CHECK(max_phong(normal, direction(), 30)(-normal).brdf_cosine == 0);
}
