// SPDX-License-Identifier: MIT
// Points of a light sphere: sample, pdf and inverse agree, from lights that fill the view down to one of 1e-4 radians.
#include "catch.hpp"
#include "random.hpp"

#include <direct_lighting/light_sampling.hpp>

#include <phimis/core/moments.hpp>

#include <cmath>
#include <limits>

namespace {

using namespace direct_lighting;

/// A sphere of sine s, seen from somewhere.
seen_light light_of(float s) { return {vector(1, 2, -3), vector(4, -2, 9), s * vector(3, -4, 12).norm()}; }

float number(random_numbers& random) { return phimis::uniform<float>(random.bits()); }

constexpr float epsilon = std::numeric_limits<float>::epsilon();

}  // namespace

TEST_CASE("The cap of a light is exact for every size") {
  for (const double s : {1e-7, 1e-4, 7e-3, 0.1, 0.5, 0.9, 0.99}) {
    const seen_light light(vector(0, 0, 0), vector(0, 0, 1), static_cast<float>(s));
    const double s_in_float = static_cast<float>(s);
    const double cap = s_in_float * s_in_float / (1 + std::sqrt(1 - s_in_float * s_in_float));
    CHECK(light.cap == Approx(cap).epsilon(4 * epsilon).margin(0));
  }
}

TEST_CASE("Cone sampling gives back its numbers, and hits the light") {
  const float s = GENERATE(1e-4f, 7e-3f, 0.2f, 0.9f);
  const seen_light light = light_of(s);
  random_numbers random(1);
  for (int i = 0; i < 2000; ++i) {
    const float u1 = number(random), u2 = number(random);
    const light_point x = cone_sampling::sample(light, u1, u2);
    const auto u = cone_sampling::invert(light, x.direction);
    // A direction is known to a few epsilon; of a small cone that is the part epsilon/s.
    const float known = 8 * epsilon / s + 8 * epsilon;
    REQUIRE(u[0] == Approx(u1).epsilon(0).margin(2 * known));
    const float around_axis = std::fabs(u[1] - u2);
    REQUIRE(std::min(around_axis, 1 - around_axis) <= known / std::sqrt(std::max(u1, 1e-12f)));
    if (u1 < 1 - 2 * known) REQUIRE(hits(light, x.direction));
    REQUIRE(x.solid_angle == 1);
  }
  CHECK(cone_sampling::pdf(light) * 2 * pi * light.cap == Approx(1).epsilon(4 * epsilon));
}

TEST_CASE("Area sampling gives back its numbers, and a ray finds the point again") {
  const float s = GENERATE(1e-4f, 7e-3f, 0.2f, 0.9f);
  const seen_light light = light_of(s);
  random_numbers random(2);
  int facing = 0;
  for (int i = 0; i < 2000; ++i) {
    const float u1 = number(random), u2 = number(random);
    const vector normal = area_sampling::normal(u1, u2);
    const auto u = area_sampling::invert(normal);
    REQUIRE(u[0] == Approx(u1).epsilon(0).margin(2 * epsilon));
    if (u1 > 1e-3f && u1 < 1 - 1e-3f)
      REQUIRE(std::fabs(u[1] - u2) < 100 * epsilon);  // ε over the ring's radius, 0.06
    const light_point x = area_sampling::at(light, normal);
    // cos θ_l to a tenth: nearer to the edge of a small light no ray in float finds a point again.
    const float cosine = -normal.dot(x.direction);
    if (cosine < 0.1f) continue;
    ++facing;
    REQUIRE(hits(light, x.direction));
    const light_point again = area_sampling::hit(light, x.direction);
    REQUIRE(again.solid_angle == Approx(x.solid_angle).epsilon(200 * epsilon / s + 200 * epsilon));
  }
  CHECK(facing > 50);
}

TEST_CASE("The solid angle of all points of a sphere is that of its cone") {
  const float s = GENERATE(1e-4f, 7e-3f, 0.2f, 0.9f);
  const seen_light light = light_of(s);
  random_numbers random(3);
  phimis::moments<double> solid_angle, of_cone;
  for (int i = 0; i < 200000; ++i) {
    const float u1 = number(random), u2 = number(random);
    solid_angle.add(area_sampling::sample(light, u1, u2).solid_angle / area_sampling::pdf(light));
    // Uniform in the cone is uniform in cos θ: its mean is that of the cap.
    of_cone.add(from_axis(light, cone_sampling::sample(light, u1, u2).direction));
  }
  // Two z, false alarms 6e-5 each; the seed is fixed.
  CHECK(std::fabs(solid_angle.mean - 2 * pi * light.cap) < 4 * std::sqrt(solid_angle.variance() / 200000));
  CHECK(std::fabs(of_cone.mean - light.cap / 2) < 4 * std::sqrt(of_cone.variance() / 200000));
}
