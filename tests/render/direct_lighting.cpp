// SPDX-License-Identifier: MIT
// The plates: geometry as given, one pixel value by every set of techniques, one image for every number of threads.
#include "catch.hpp"

#include <direct_lighting/techniques.hpp>
#include <render/fixed_counts.hpp>

#include <phimis/core/estimator.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

namespace {

using namespace direct_lighting;
using render::equal_counts;

/// The luminance of a pixel by n_k samples of technique k, with its variance.
template <int M, class LightSampling>
phimis::estimator<float, M> estimate(const scene& of, const shading_point& at, const phimis::counts<M>& n,
                                     std::uint32_t pixel, std::uint32_t run) {
  const techniques<M, LightSampling> all(of);
  const render::random_stream random(1, run);
  float total = 0;
  for (const auto count : n) total += static_cast<float>(count);
  phimis::fractions<float, M> alpha{};
  for (int k = 0; k < M; ++k) alpha[k] = static_cast<float>(n[k]) / total;
  phimis::estimator<float, M> sum;
  std::uint32_t index = 0;
  for (int k = 0; k < M; ++k) {
    for (std::int64_t j = 0; j < n[k]; ++j) {
      const auto u = random(pixel, index++);
      const auto sample = all.draw(at, k, u[0], u[1], u[2]);
      sum.add(k, phimis::contribution(phimis::balance{}, k, luminance(sample.f), alpha, sample.pdfs));
    }
  }
  return sum;
}

/// Every step-th pixel on a plate.
std::vector<shading_point> some_points(const scene& of, int size, std::size_t step) {
  const auto points = shading_points(of, size, size, 1);
  std::vector<shading_point> some;
  std::size_t lit = 0;
  for (const shading_point& p : points.pixels) {
    if (p.part != shading_point::no_part && lit++ % step == 0) some.push_back(p);
  }
  return some;
}

constexpr auto model = phimis::sampling_model::multi_sample;

template <class A, class B>
double z(const A& a, const B& b) {
  return (double{a.estimate()} - double{b.estimate()}) /
         std::sqrt(double{a.variance(model)} + double{b.variance(model)});
}

}  // namespace

TEST_CASE("Plates and lights are where the scene's numbers say") {
  const scene of;
  const float normals[][2] = {
      {0.993577f, 0.113157f}, {0.949645f, 0.313328f}, {0.816654f, 0.577128f}, {0.540067f, 0.841622f}};
  const render::rgb radiances[] = {{531.715f, 265.857f, 132.929f},
                                   {50.887f, 101.774f, 25.443f},
                                   {8.1419f, 4.0709f, 16.2838f},
                                   {2.6054f, 0.65135f, 1.3027f}};
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(of.plates[i].normal.x() == 0);
    CHECK(of.plates[i].normal.y() == Approx(normals[i][0]).epsilon(1e-6));
    CHECK(of.plates[i].normal.z() == Approx(normals[i][1]).epsilon(1e-5));
    CHECK(of.lights[i].radiance.r == Approx(radiances[i].r).epsilon(1e-5));
    CHECK(of.lights[i].radiance.g == Approx(radiances[i].g).epsilon(2e-5));
    CHECK(of.lights[i].radiance.b == Approx(radiances[i].b).epsilon(2e-5));
  }
}

TEST_CASE("A pixel sees what lies behind its centre") {
  const scene of;
  const int size = 601;
  const auto points = shading_points(of, size, size, 2);
  // The pixel of a point, by angles: of the eye's direction and of the point's, around the horizontal axis.
  const double half = std::tan(35 * std::numbers::pi / 360);
  const auto pixel_of = [&](const vector& p) {
    const double y = p.y() - 6, depth = 18 - p.z(), tilt = std::atan2(6, 18);
    const double forward = depth * std::cos(tilt) - y * std::sin(tilt);
    const double above = depth * std::sin(tilt) + y * std::cos(tilt);
    const auto index = [&](double t) { return static_cast<int>(std::floor((1 + t / half) / 2 * size)); };
    return &points(index(p.x() / forward), index(-above / forward));
  };
  const double pixel = 2 * half * 30 / size;  // at the farthest plate, 30 away
  for (int i = 0; i < 4; ++i) {
    const vector centre = of.plates[static_cast<std::size_t>(i)].centre;
    const shading_point* const seen = pixel_of(centre);
    REQUIRE(seen->part == i);
    CHECK((seen->position - centre).norm() < 4 * pixel);  // plates are seen at a slant of up to a quarter
    const light& l = of.lights[static_cast<std::size_t>(i)];
    CHECK(pixel_of(l.centre)->part == shading_point::no_part);
    CHECK(pixel_of(l.centre)->emitted == l.radiance);
    CHECK(pixel_of(l.centre + vector(0, 1.2f * l.radius, 0))->emitted == render::rgb{});
  }
  const scene front({.plates = 1});
  CHECK(std::all_of(points.pixels.begin(), points.pixels.end(),
                    [](const shading_point& p) { return p.part < 4 && p.part >= shading_point::no_part; }));
  const auto fewer = shading_points(front, 64, 64, 1);
  CHECK(std::all_of(fewer.pixels.begin(), fewer.pixels.end(), [](const shading_point& p) { return p.part <= 0; }));
}

TEST_CASE("Options that make no scene are refused by name") {
  CHECK_THROWS_WITH(scene({.plates = 0}), contains_text("plates"));
  CHECK_THROWS_WITH(scene({.plates = 5}), contains_text("plates"));
  CHECK_THROWS_WITH(scene({.radius_scale = -1}), contains_text("radius scale"));
  CHECK_THROWS_WITH(scene({.radius_scale = NAN}), contains_text("radius scale"));
  CHECK_THROWS_WITH(scene({.radius_scale = 7}), contains_text("reach the plates"));
  CHECK_THROWS_WITH(scene({.exponents = {1, 2, 3, -1}}), contains_text("exponents"));
  CHECK_NOTHROW(scene({.exponents = {5, 5, 5, 5}, .plates = 1, .radius_scale = 3}));
}

TEST_CASE("A pixel has one value, by area and cone sampling, by two and five techniques") {
  const float scale = GENERATE(0.1f, 1.0f, 3.0f);  // at 3 lights hide each other
  const scene of({.radius_scale = scale});
  std::uint32_t pixel = 0;
  double squares = 0;
  int n = 0;
  for (const shading_point& p : some_points(of, 24, 7)) {
    ++pixel;
    const auto base = estimate<5, cone_sampling>(of, p, equal_counts<5>(5000), pixel, 0);
    for (const double value : {z(base, estimate<2, cone_sampling>(of, p, equal_counts<2>(5000), pixel, 1)),
                               z(base, estimate<2, area_sampling>(of, p, equal_counts<2>(5000), pixel, 2)),
                               z(base, estimate<5, area_sampling>(of, p, equal_counts<5>(5000), pixel, 3))}) {
      // 6e-5 each; with the fixed seed, about 100 of them.
      INFO("pixel " << pixel << " of scale " << scale);
      REQUIRE(std::fabs(value) < 4);
      squares += value * value;
      ++n;
    }
  }
  REQUIRE(n >= 90);
  // Were all of them off by one standard error, this would be 2. Pixels share their first estimate: a third of the n are
  // independent at worst.
  CHECK(squares / n < 1 + 4 * std::sqrt(2.0 / (n / 3.0)));
}

TEST_CASE("A light is visible where no other is hit before it") {
  const scene of({.radius_scale = 3});  // two lights reach into each other
  // The distance to the first hit in double, by the quadratic formula; infinite for a miss.
  const auto hit = [&](const vector& from, const vector& direction, int k) {
    const light& l = of.lights[static_cast<std::size_t>(k)];
    const Eigen::Vector3d to = (l.centre.cast<double>() - from.cast<double>()),
                          d = direction.cast<double>().normalized();
    const double along = to.dot(d), under = along * along - to.squaredNorm() + double{l.radius} * double{l.radius};
    return under > 0 ? along - std::sqrt(under) : std::numeric_limits<double>::infinity();
  };
  const render::random_stream random(6, 0);
  int hidden = 0, tried = 0;
  for (const shading_point& p : some_points(of, 24, 7)) {
    for (int k = 0; k < light_count; ++k) {
      for (std::uint32_t i = 0; i < 100; ++i) {
        const auto u = random(static_cast<std::uint32_t>(k), static_cast<std::uint32_t>(tried++));
        const vector direction = cone_sampling::sample(p.lights[static_cast<std::size_t>(k)], u[1], u[2]).direction;
        const double own = hit(p.position, direction, k);
        double other = std::numeric_limits<double>::infinity();
        for (int j = 0; j < light_count; ++j) {
          if (j != k) other = std::min(other, hit(p.position, direction, j));
        }
        // Where the surfaces meet to 1e-3, and on a light's edge, float may decide either way.
        if (std::isinf(own) || std::fabs(own - other) < 1e-3) continue;
        REQUIRE(scene::visible(p, k, direction) == (own < other));
        if (other < own) ++hidden;
      }
    }
  }
  CHECK(hidden > tried / 20);
  CHECK(hidden < tried / 2);
}

TEST_CASE("Each technique alone finds the same value of large lights") {
  const scene of({.exponents = {5, 5, 5, 5}, .radius_scale = 3});
  std::uint32_t pixel = 0;
  for (const shading_point& p : some_points(of, 24, 20)) {
    ++pixel;
    // The smallest light is hit once in 1e4, by some 40 samples: fewer are too skewed for a z.
    const auto brdf = estimate<2, cone_sampling>(of, p, {{0, 400000}}, pixel, 0);
    REQUIRE(std::fabs(z(brdf, estimate<2, cone_sampling>(of, p, {{20000, 0}}, pixel, 1))) < 4);
    REQUIRE(std::fabs(z(brdf, estimate<2, area_sampling>(of, p, {{20000, 0}}, pixel, 2))) < 4);
  }
  CHECK(pixel >= 10);
}

TEST_CASE("Two techniques are the five with the light chosen by chance") {
  const scene of;
  const techniques<2, cone_sampling> two(of);
  const techniques<5, cone_sampling> five(of);
  const render::random_stream random(3, 0);
  std::uint32_t index = 0;
  int lit = 0;
  for (const shading_point& p : some_points(of, 24, 7)) {
    for (int i = 0; i < 50; ++i) {
      const auto u = random(0, index++);
      const int k = static_cast<int>(4 * u[0]);
      const auto a = two.draw(p, 0, u[0], u[1], u[2]);
      const auto b = five.draw(p, k, u[0], u[1], u[2]);
      REQUIRE(a.f == b.f);
      REQUIRE(4 * a.pdfs[0] == b.pdfs[k]);  // a quarter is exact
      REQUIRE(a.pdfs[1] == b.pdfs[4]);
      for (int j = 0; j < 4; ++j) REQUIRE((j == k || b.pdfs[j] == 0));
      REQUIRE((luminance(a.f) > 0) == (a.pdfs[1] > 0));
      if (a.pdfs[1] > 0) ++lit;
      const auto c = two.draw(p, 1, u[0], u[1], u[2]);
      REQUIRE((luminance(c.f) > 0 && c.pdfs[0] > 0 && c.pdfs[1] > 0) == (c.pdfs[0] > 0));
    }
  }
  CHECK(lit > 500);
}

TEST_CASE("Of area samples, those that face away are lost to the BRDF and to f") {
  const scene of;
  const techniques<5, area_sampling> all(of);
  const shading_point p = of.on_plate(0, of.plates[0].centre, (scene::eye() - of.plates[0].centre).normalized());
  const render::random_stream random(4, 0);
  const int n = 20000;
  for (int k = 0; k < light_count; ++k) {
    int facing = 0;
    for (int i = 0; i < n; ++i) {
      const auto u = random(static_cast<std::uint32_t>(k), static_cast<std::uint32_t>(i));
      const auto sample = all.draw(p, k, u[0], u[1], u[2]);
      REQUIRE(sample.pdfs[k] > 0);
      REQUIRE((luminance(sample.f) > 0) == (sample.pdfs[4] > 0));
      if (luminance(sample.f) > 0) ++facing;
    }
    // The part of the sphere that is seen is (1 − r/d)/2.
    const seen_light& l = p.lights[static_cast<std::size_t>(k)];
    const double share = (1 - double{l.radius} / double{l.distance}) / 2;
    CHECK(std::fabs(facing - n * share) < 4 * std::sqrt(n * share * (1 - share)));
  }
}

TEST_CASE("An image is the same bit for bit for any number of threads") {
  const scene of;
  const techniques<5, cone_sampling> all(of);
  const auto draw = [&](int threads, std::uint64_t seed) {
    const auto points = shading_points(of, 40, 24, threads);
    return render_image(points, all, equal_counts<5>(20), render::random_stream(seed, 0), threads, [] {}).pixels;
  };
  const auto one = draw(1, 1);
  CHECK(one == draw(2, 1));
  CHECK(one == draw(3, 1));
  CHECK_FALSE(one == draw(1, 2));
}
