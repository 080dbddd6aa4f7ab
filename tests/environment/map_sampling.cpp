// SPDX-License-Identifier: MIT
// Directions of a map: what is sampled is what the density says, and numbers can be found back.
#include "catch.hpp"
#include "random.hpp"

#include <environment_lighting/environment_map.hpp>
#include <environment_lighting/lat_long.hpp>
#include <environment_lighting/map_distribution.hpp>
#include <environment_lighting/map_file.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace {

using namespace environment_lighting;

/// Values over six decades, a row and a few texels of them black.
render::image<float> values(int width, int height) {
  render::image<float> v(width, height);
  random_numbers next(11);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      v(x, y) = y == 2 || (x + y) % 5 == 0 ? 0.0f : static_cast<float>(std::pow(10.0, 6 * next() - 3));
    }
  }
  return v;
}

/// Σ p Ω over the sphere, p as a function of radiance.
template <class Pdf>
double integral(const environment_map& of, const Pdf& pdf) {
  double sum = 0;
  for (int y = 0; y < of.directions().height(); ++y) {
    for (int x = 0; x < of.directions().width(); ++x) {
      sum += static_cast<double>(pdf(of.radiance({x, y, 0.5f, 0.5f}))) *
             static_cast<double>(of.directions().solid_angle(y));
    }
  }
  return sum;
}

}  // namespace

TEST_CASE("A lat-long map covers the sphere once, and finds the place of its own directions") {
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(2, 1), std::pair(7, 5), std::pair(1024, 512)}) {
    const lat_long on(width, height);
    double total = 0;
    for (int y = 0; y < height; ++y) total += static_cast<double>(on.solid_angle(y)) * width;
    CHECK(total == Approx(4 * std::numbers::pi).epsilon(1e-5));
    random_numbers next(3);
    for (int i = 0; i < 2000; ++i) {
      const lat_long::place at{static_cast<int>(next() * width), static_cast<int>(next() * height),
                               static_cast<float>(0.05 + 0.9 * next()), static_cast<float>(0.05 + 0.9 * next())};
      const vector d = on.direction(at);
      REQUIRE(std::fabs(d.norm() - 1) < 1e-6f);
      const lat_long::place found = on.find(d);
      REQUIRE(found.column == at.column);
      REQUIRE(found.row == at.row);
      // cos θ of 24 bits leaves this of a texel: near the poles of 512 rows it is 2e-5 high.
      REQUIRE(std::fabs(found.across - at.across) < 0.02f);
      REQUIRE(std::fabs(found.down - at.down) < 0.02f);
    }
  }
  const lat_long on(8, 4);
  CHECK(on.find(vector(0, 1, 0)).row == 0);
  CHECK(on.find(vector(0, -1, 0)).row == 3);
  for (const vector& d : {vector(1, 0, 0), vector(-1, 0, 0), vector(1, 0, -1e-9f), vector(0, 0, -1)}) {
    const lat_long::place at = on.find(d);
    CHECK((at.column >= 0 && at.column < 8 && at.across < 1 && at.down < 1));
  }
}

TEST_CASE("Texels are drawn as often as the density says, and never where it is 0") {
  const render::image<float> v = values(13, 7);
  const map_distribution of(v);
  const lat_long on(13, 7);
  render::image<int> hits(13, 7);
  constexpr int n = 2000000;
  random_numbers next(5);
  for (int i = 0; i < n; ++i) {
    const lat_long::place at = of.sample(static_cast<float>(next()), static_cast<float>(next()));
    REQUIRE((at.across >= 0 && at.across < 1 && at.down >= 0 && at.down < 1));
    ++hits(at.column, at.row);
  }
  double total = 0, chi_squared = 0;
  for (int y = 0; y < 7; ++y) {
    for (int x = 0; x < 13; ++x) total += static_cast<double>(v(x, y)) * static_cast<double>(on.solid_angle(y));
  }
  CHECK(of.total() == Approx(total));
  int freedom = -1;
  for (int y = 0; y < 7; ++y) {
    for (int x = 0; x < 13; ++x) {
      const double expected = n * static_cast<double>(v(x, y)) * static_cast<double>(on.solid_angle(y)) / total;
      if (v(x, y) == 0) CHECK(hits(x, y) == 0);
      if (expected < 10) continue;
      chi_squared += (hits(x, y) - expected) * (hits(x, y) - expected) / expected;
      ++freedom;
    }
  }
  REQUIRE(freedom > 30);
  // Wilson & Hilferty: a normal number, beyond 4 once in 30 000 seeds.
  const double cube = std::cbrt(chi_squared / freedom), spread = 2.0 / (9 * freedom);
  CHECK((cube - (1 - spread)) / std::sqrt(spread) < 4);
}

TEST_CASE("Places in a texel are uniform in solid angle, and the numbers they are made of are found back") {
  const map_distribution of(values(13, 7));
  random_numbers next(6);
  for (int i = 0; i < 20000; ++i) {
    const auto u1 = static_cast<float>(next()), u2 = static_cast<float>(next());
    const std::array<float, 2> found = of.invert(of.sample(u1, u2));
    REQUIRE(std::fabs(found[0] - u1) < 2e-7f);
    REQUIRE(std::fabs(found[1] - u2) < 2e-7f);
  }
  // One texel is the whole sphere: cos θ and φ of what is drawn are uniform.
  const map_distribution one(render::image<float>(1, 1, 3));
  const lat_long on(1, 1);
  double mean = 0, square = 0;
  for (int i = 0; i < 40000; ++i) {
    const double y = static_cast<double>(
        on.direction(one.sample(static_cast<float>(next()), static_cast<float>(next()))).y());
    mean += y / 40000, square += y * y / 40000;
  }
  CHECK(std::fabs(mean) < 4 / std::sqrt(3 * 40000.0));
  CHECK(std::fabs(square - 1.0 / 3) < 4 * std::sqrt(4.0 / 45 / 40000));
}

TEST_CASE("A map without light is sampled uniformly") {
  const map_distribution of(render::image<float>(8, 4, 0));
  CHECK(of.total() == Approx(4 * std::numbers::pi).epsilon(1e-6));
  const lat_long::place at = of.sample(0.9999999f, 0.9999999f);
  CHECK(at.row == 3);
  CHECK(at.column == 7);
  const environment_map black(render::image<render::rgb>(8, 4));
  CHECK(black.black());
  CHECK(integral(black, [&](render::rgb c) { return black.whole_pdf(c); }) == Approx(1).epsilon(1e-6));
  CHECK(integral(black, [&](render::rgb c) { return black.bright_pdf(c); }) == Approx(1).epsilon(1e-6));
  CHECK(integral(black, [&](render::rgb c) { return black.rest_pdf(c); }) == Approx(1).epsilon(1e-6));
}

TEST_CASE("The brightest region emits half of the power, and with the rest it is the whole") {
  const environment_map sky(analytic_sky(64, 32));
  const lat_long& on = sky.directions();
  double bright_power = 0, bright_angle = 0;
  float least_bright = 1e30f, most_rest = 0;
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 64; ++x) {
      const render::rgb c = sky.radiance({x, y, 0.5f, 0.5f});
      const float bright = sky.bright_pdf(c), rest = sky.rest_pdf(c);
      REQUIRE((bright > 0) != (rest > 0));
      // p = (P_b p_b + P_r p_r)/P
      const double mixed = (sky.bright().total() * static_cast<double>(bright) +
                            sky.rest().total() * static_cast<double>(rest)) /
                           sky.whole().total();
      REQUIRE(mixed == Approx(sky.whole_pdf(c)).epsilon(1e-5));
      if (bright > 0) {
        bright_power += static_cast<double>(luminance(c) * on.solid_angle(y));
        bright_angle += static_cast<double>(on.solid_angle(y));
        least_bright = std::min(least_bright, luminance(c));
      } else {
        most_rest = std::max(most_rest, luminance(c));
      }
    }
  }
  CHECK(bright_power >= 0.4999 * sky.whole().total());
  CHECK(least_bright > most_rest);  // so no smaller region has as much
  CHECK(bright_angle < 2 * std::numbers::pi);
  CHECK(integral(sky, [&](render::rgb c) { return sky.whole_pdf(c); }) == Approx(1).epsilon(1e-5));
  CHECK(integral(sky, [&](render::rgb c) { return sky.bright_pdf(c); }) == Approx(1).epsilon(1e-5));
  CHECK(integral(sky, [&](render::rgb c) { return sky.rest_pdf(c); }) == Approx(1).epsilon(1e-5));

  const environment_map even(render::image<render::rgb>(8, 4, {2, 2, 2}));
  CHECK(even.bright_pdf({2, 2, 2}) == even.whole_pdf({2, 2, 2}));
  CHECK(even.rest_pdf({2, 2, 2}) == even.whole_pdf({2, 2, 2}));

  // One lamp in the dark: what is off it has nothing to sample.
  render::image<render::rgb> lamp(8, 4);
  lamp(3, 1) = {5, 5, 5};
  const environment_map alone(lamp);
  CHECK(alone.rest_pdf({5, 5, 5}) == alone.whole_pdf({5, 5, 5}));
  CHECK(alone.bright_pdf({5, 5, 5}) == alone.whole_pdf({5, 5, 5}));
}
