// SPDX-License-Identifier: MIT
// An object in a cage: what hides the map, one value by every set of techniques, no bias, one image for any number of threads.
#include "catch.hpp"

#include <environment_lighting/cases.hpp>
#include <environment_lighting/methods.hpp>
#include <environment_lighting/techniques.hpp>
#include <render/fixed_counts.hpp>
#include <render/reference.hpp>

#include <phimis/core/estimator.hpp>
#include <phimis/core/moments.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace {

using namespace environment_lighting;

const auto nothing = [] {};

const lit_scene& ball() {
  static const lit_scene scene({"ball", analytic_sky_name, "sphere", "varying"}, 12, 12, 1);
  return scene;
}
const lit_scene& tangle() {
  static const lit_scene scene({"tangle", analytic_sky_name, "knot", "glossy:20"}, 14, 14, 1);
  return scene;
}

std::vector<shading_point> lit(const lit_scene& of) {
  std::vector<shading_point> points;
  for (const shading_point& p : of.points().pixels) {
    if (p.part != shading_point::no_part) points.push_back(p);
  }
  return points;
}

/// The luminance of a point by techniques of which sample k is used n[k] times.
template <int M>
phimis::estimator<float, M> estimate(const scene& of, const shading_point& at, const phimis::counts<M>& n,
                                     std::uint32_t pixel) {
  const techniques<M> all(of);
  const render::random_stream random(4, static_cast<std::uint32_t>(n[0]));
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

}  // namespace

TEST_CASE("Pixels see the object or the map, points of a sphere lie on it, and none sees through itself") {
  const auto& points = ball().points();
  CHECK(points(0, 0).part == shading_point::no_part);
  CHECK(luminance(points(0, 0).emitted) > 0);
  const auto on_ball = lit(ball());
  REQUIRE(on_ball.size() > 40);
  for (const shading_point& p : on_ball) {
    REQUIRE(p.position.norm() == Approx(1).epsilon(1e-3));
    REQUIRE(p.surface.normal().dot(p.position) > 0.999f);
    REQUIRE_FALSE(ball().world().sees_light(p, -p.position.normalized()));
  }
  // The cage hides some directions above each point, and leaves others.
  const shading_point& top = points(6, 3);
  REQUIRE(top.part != shading_point::no_part);
  int seen = 0, all = 0;
  for (int i = 0; i < 400; ++i) {
    const lat_long on(20, 20);
    const vector d = on.direction({i % 20, i / 20, 0.5f, 0.5f});
    if (d.dot(top.surface.normal()) < 0.05f) continue;
    ++all;
    seen += ball().world().sees_light(top, d) ? 1 : 0;
  }
  CHECK(seen > all / 2);
  CHECK(seen < all);
}

TEST_CASE("Map, BRDF and three techniques tell the same of a point") {
  std::uint32_t pixel = 0;
  for (const lit_scene* scene : {&ball(), &tangle()}) {
    const auto points = lit(*scene);
    for (std::size_t i = 0; i < points.size(); i += 9, ++pixel) {
      const auto both = estimate<2>(scene->world(), points[i], {20000, 20000}, pixel);
      const auto map = estimate<2>(scene->world(), points[i], {40000, 0}, pixel);
      const auto three = estimate<3>(scene->world(), points[i], {14000, 13000, 13000}, pixel);
      constexpr auto model = phimis::sampling_model::multi_sample;
      const auto z = [&](const auto& a, const auto& b) {
        return static_cast<double>(a.estimate() - b.estimate()) /
               std::sqrt(static_cast<double>(a.variance(model) + b.variance(model)) + 1e-12);
      };
      INFO("point " << i << ": " << both.estimate() << ", " << map.estimate() << ", " << three.estimate());
      CHECK(std::fabs(z(map, both)) < 4.5);  // 7e-6 each, with the fixed seed
      CHECK(std::fabs(z(three, both)) < 4.5);
    }
  }
}

TEST_CASE("The mean of 300 images is a reference of 120 000 samples, for each way to render") {
  for (const lit_scene* scene : {&ball(), &tangle()}) {
    const view seen{scene->world(), scene->points()};
    // Sums of the object's pixels: of runs, and of parts of the reference, which tell its own error.
    const auto sum_of = [&](const render::image<render::rgb>& picture) {
      double sum = 0;
      for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
        if (seen.points.pixels[i].part != shading_point::no_part) sum += static_cast<double>(mean(picture.pixels[i]));
      }
      return sum;
    };
    phimis::moments<double> truth;
    for (std::uint32_t part = 0; part < 24; ++part) {
      truth.add(sum_of(render::render_image(seen.points, techniques<3>(seen.world), render::equal_counts<3>(5000),
                                            render::random_stream(0, part, render::of_reference), 1, nothing)));
    }
    for (const std::string name : {"map", "equal", "lu", "eq31", "tsallis:1", "linear", "equal3", "default"}) {
      for (const std::int64_t samples : {30, 100}) {
        if (samples > 30 && name != "default") continue;  // whose plan is another from 100 on
        const render::method draw = make_method(seen, name, samples);
        phimis::moments<double> runs;
        for (std::uint32_t run = 0; run < 300; ++run) {
          runs.add(sum_of(draw(render::random_stream(9, run), 1, nothing).picture));
        }
        const double error = std::sqrt(runs.variance() / 300 + truth.variance() / 24);
        INFO(name << ", " << samples << " samples: " << runs.mean << " against " << truth.mean << " +- " << error);
        CHECK(error < 0.01 * truth.mean);                     // or a bias would hide
        CHECK(std::fabs(runs.mean - truth.mean) < 4 * error);  // 6e-5 each, with the fixed seed
      }
    }
  }
}

TEST_CASE("An image of an object is the same bit for bit for any number of threads") {
  const lit_scene scene({"tangle", analytic_sky_name, "knot", "glossy:20"}, 40, 36, 2);
  const view seen{scene.world(), scene.points()};
  for (const std::string& name : all_methods()) {
    const render::method draw = make_method(seen, name, 100);
    const render::rendering one = draw(render::random_stream(1, 0), 1, nothing);
    const render::rendering other = draw(render::random_stream(1, 0), 3, nothing);
    CHECK(one.picture.pixels == other.picture.pixels);
    REQUIRE(one.fractions.size() == other.fractions.size());
    for (std::size_t k = 0; k < one.fractions.size(); ++k) CHECK(one.fractions[k].pixels == other.fractions[k].pixels);
    CHECK(one.fractions.empty() != learns(name));
  }
}

TEST_CASE("Every stage has a sample for each technique, and all stages together those of the pixel") {
  for (const std::int64_t samples : {30, 31, 59, 99, 100, 101, 200, 555, 1500}) {
    for (const learning_plan& plan : {plan_of_v(samples), recommended_plan(samples)}) {
      std::int64_t sum = 0;
      for (const auto& batches : {plan.batches, plan.own}) {
        for (const render::planned_batch& batch : batches) sum += batch.samples;
      }
      CHECK(sum == samples);
    }
    CHECK(plan_of_v(samples).batches.size() == 9);
    const view seen{tangle().world(), tangle().points()};
    for (const std::string name : {"lu", "eq31", "linear", "default"}) {
      const render::rendering drawn = make_method(seen, name, samples)(render::random_stream(2, 0), 1, nothing);
      for (std::size_t i = 0; i < seen.points.pixels.size(); ++i) {
        if (seen.points.pixels[i].part == shading_point::no_part) continue;
        float sum = 0;
        for (const auto& alpha : drawn.fractions) {
          if (name != "linear") REQUIRE(alpha.pixels[i] > 0);
          sum += alpha.pixels[i];
        }
        REQUIRE(std::fabs(sum - 1) < 1e-6f);
        REQUIRE(phimis::value_traits<render::rgb>::finite(drawn.picture.pixels[i]));
      }
    }
  }
}

TEST_CASE("A black map gives a black object") {
  const environment_map black(render::image<render::rgb>(16, 8));
  const scene dark(sphere(), cage(1.3f, 6, 0.1f), black, make_material("lambert"));
  const auto points = shading_points(dark, 6, 6, 1);
  for (const std::string& name : all_methods()) {
    const auto drawn = make_method({dark, points}, name, 100)(render::random_stream(1, 0), 1, nothing);
    CHECK(std::all_of(drawn.picture.pixels.begin(), drawn.picture.pixels.end(),
                      [](render::rgb c) { return c == render::rgb{}; }));
  }
}

TEST_CASE("Methods and materials have names, and others are refused in one line") {
  CHECK_NOTHROW(check("tsallis:0.5", 2048));
  CHECK_THROWS_WITH(check("tsallis:1", 2049), contains_text("2048"));
  CHECK_THROWS_WITH(check("best", 100), contains_text("not one of map, brdf, equal, lu, eq31"));
  CHECK_THROWS_WITH(check("equal", 29), contains_text("at least 30"));
  CHECK(make_material("glossy:7.5")(vector(1, 0, 0)).exponent == 7.5f);
  CHECK(make_material("lambert")(vector(1, 0, 0)).diffuse == 1);
  for (const std::string bad : {"", "glossy", "glossy:", "glossy:-1", "glossy:1e9", "glossy:3x", "glossy:nan"}) {
    CHECK_THROWS_WITH(make_material(bad), contains_text("--material"));
  }
}
