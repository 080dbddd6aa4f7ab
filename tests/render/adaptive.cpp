// SPDX-License-Identifier: MIT
// Images whose fractions are learnt: no bias, one image for every number of threads, nothing that is not finite.
#include "catch.hpp"

#include <direct_lighting/methods.hpp>
#include <render/study.hpp>

#include <phimis/core/rule.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

namespace {

using namespace direct_lighting;
using render::equal_counts, render::papers_plan, render::planned_batch, render::rendering, render::mean_ratio,
    render::measured_method;

const auto nothing = [] {};

/// Σ (R + G + B)/3 of the pixels that see each plate, and how runs of it scatter.
struct plate_sums {
  void add(const render::image<render::rgb>& picture, const render::image<shading_point>& points) {
    std::array<double, 4> sum{};
    for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
      const int plate = points.pixels[i].part;
      if (plate != shading_point::no_part) sum[static_cast<std::size_t>(plate)] += double{mean(picture.pixels[i])};
    }
    ++runs;
    for (std::size_t p = 0; p < 4; ++p) {
      const double off = sum[p] - average[p];
      average[p] += off / runs;
      squares[p] += off * (sum[p] - average[p]);
    }
  }
  double variance(std::size_t p) const { return squares[p] / (runs * (runs - 1.0)); }

  int runs = 0;
  std::array<double, 4> average{}, squares{};
};

std::int64_t total(const learning_plan& plan) {
  return std::accumulate(plan.batches.begin(), plan.batches.end(), std::int64_t{0},
                         [](std::int64_t sum, const planned_batch& b) { return sum + b.samples; });
}

double largest_difference(const render::image<render::rgb>& a, const render::image<render::rgb>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) {
    const render::rgb d = a.pixels[i] - b.pixels[i], of = b.pixels[i];
    for (const auto& [off, size] : {std::pair(d.r, of.r), std::pair(d.g, of.g), std::pair(d.b, of.b)}) {
      largest = std::max(largest, std::fabs(double{off}) / (1e-6 + std::fabs(double{size})));
    }
  }
  return largest;
}

}  // namespace

TEST_CASE("The mean of 1000 images of 20 samples is the reference, for each plate and each way to learn") {
  const scene of;
  const auto points = shading_points(of, 24, 24, 1);
  plate_sums truth;
  const techniques<5, cone_sampling> all(of);
  for (std::uint32_t run = 0; run < 40; ++run) {
    truth.add(render_image(points, all, equal_counts<5>(2500), render::random_stream(0, run, 1), 1, nothing), points);
  }
  for (const configuration& one : std::vector<configuration>{{"area", 2, "default", 20},
                                                             {"area", 5, "default", 20},
                                                             {"area", 2, "tsallis:1", 20},
                                                             {"cone", 2, "default", 20},
                                                             {"cone", 5, "default", 20},
                                                             {"cone", 2, "tsallis:1", 20}}) {
    const method draw = make_method({of, points}, one);
    plate_sums learnt;
    for (std::uint32_t run = 0; run < 1000; ++run)
      learnt.add(draw(render::random_stream(7, run), 1, nothing).picture, points);
    for (std::size_t p = 0; p < 4; ++p) {
      INFO(one.setting << ", " << one.techniques << " techniques, " << one.method << ", plate " << p);
      const double error = std::sqrt(learnt.variance(p) + truth.variance(p));
      CHECK(error < 0.02 * truth.average[p]);                              // or a bias would hide
      CHECK(std::fabs(learnt.average[p] - truth.average[p]) < 4 * error);  // 6e-5 each, with the fixed seed
    }
  }
}

TEST_CASE("Fractions that stay equal give the image of equal counts") {
  const scene of;
  const auto points = shading_points(of, 24, 24, 1);
  const techniques<5, cone_sampling> all(of);
  const render::random_stream random(1, 0);
  const auto equal = [](int) { return phimis::fixed_fractions<float, 5>(); };
  const auto by_plan = [&](const learning_plan& plan) {
    return render_adaptively(points, all, phimis::balance{}, equal, plan, random, 1, nothing).picture;
  };
  const auto expected = render_image(points, all, equal_counts<5>(20), random, 1, nothing);
  // Sums of 20 numbers in float, in two orders.
  CHECK(largest_difference(by_plan({.batches = {{20}}}), expected) < 1e-5);
  CHECK(largest_difference(by_plan({.cell = 1, .batches = {{20}}}), expected) < 1e-5);
  CHECK(largest_difference(by_plan({.batches = {{20}, {20, 0}}}), expected) < 1e-5);  // of weight 0
  // Those that do not draw the first batch draw its samples with the second.
  const auto half = by_plan({.batches = {{10, 1, 0.5}, {10}}});
  int same = 0, lit = 0;
  for (std::size_t i = 0; i < half.pixels.size(); ++i) {
    if (points.pixels[i].part == shading_point::no_part) continue;
    ++lit;
    const render::rgb d = half.pixels[i] - expected.pixels[i];
    if (std::fabs(mean(d)) <= 1e-5f * mean(expected.pixels[i])) ++same;
  }
  CHECK(std::abs(2 * same - lit) <= 12);  // each of some 12 cells rounds half of its pixels up
}

TEST_CASE("Every pixel draws all its samples, and none more") {
  struct counting_rule : phimis::fixed_fractions<float, 2> {
    explicit counting_rule(std::int64_t& all) : observed(&all) {}
    void observe(const phimis::observation<float, 2>&) { ++*observed; }
    std::int64_t* observed;
  };
  const scene of;
  const auto points = shading_points(of, 40, 36, 1);
  const auto lit = std::count_if(points.pixels.begin(), points.pixels.end(),
                                 [](const shading_point& p) { return p.part != shading_point::no_part; });
  for (learning_plan plan : {papers_plan(53, 2, 5), recommended_plan<2>(53, 200), recommended_plan<5>(53, 200)}) {
    for (planned_batch& batch : plan.batches) batch.observed = 1;
    std::int64_t observed = 0;
    render_adaptively(points, techniques<2, area_sampling>(of), phimis::balance{}, [&](int) { return counting_rule(observed); }, plan,
                      render::random_stream(1, 0), 1, nothing);
    CHECK(observed == 53 * lit);
  }
}

TEST_CASE("A learnt image is the same bit for bit for any number of threads") {
  const scene of;
  const auto points = shading_points(of, 40, 36, 1);
  for (const int m : {2, 5}) {
    const method draw = make_method({of, points}, {"area", m, "default", 30});
    const rendering one = draw(render::random_stream(1, 0), 1, nothing);
    for (const int threads : {2, 3}) {
      const rendering other = draw(render::random_stream(1, 0), threads, nothing);
      CHECK(one.picture.pixels == other.picture.pixels);
      REQUIRE(other.fractions.size() == static_cast<std::size_t>(m));
      for (std::size_t k = 0; k < other.fractions.size(); ++k) {
        CHECK(one.fractions[k].pixels == other.fractions[k].pixels);
      }
    }
    CHECK_FALSE(one.picture.pixels == draw(render::random_stream(2, 0), 1, nothing).picture.pixels);
  }
}

TEST_CASE("Pictures are finite and fractions lie on the simplex, with the fewest samples and in hard scenes") {
  for (const scene_options& options :
       std::vector<scene_options>{{.exponents = {5000, 5000, 5000, 5000}, .radius_scale = 0.1f},
                                  {.exponents = {5, 5, 5, 5}, .plates = 1, .radius_scale = 3},
                                  {.exponents = {0, 1e6f, 0, 1e6f}, .radius_scale = 1e-3f}}) {
    const scene of(options);
    const auto points = shading_points(of, 20, 20, 1);
    for (const std::string sampler : {"area", "cone"}) {
      for (const int m : {2, 5}) {
        std::vector<std::string> names = methods_of(m);
        if (m == 2) names.insert(names.end(), {"newton:0.1", "newton:2", "tsallis:8"});
        for (const std::string& name : names) {
          for (const std::int64_t samples : {m, 2 * m - 1, 2 * m, 20}) {
            INFO(sampler << ", " << m << " techniques, " << name << ", " << samples << " samples");
            const rendering drawn =
                make_method({of, points}, {sampler, m, name, samples})(render::random_stream(3, 0), 1, nothing);
            REQUIRE(std::all_of(drawn.picture.pixels.begin(), drawn.picture.pixels.end(), [](render::rgb c) {
              return phimis::value_traits<render::rgb>::finite(c) && std::min({c.r, c.g, c.b}) >= 0;
            }));
            if (drawn.fractions.empty()) continue;
            for (std::size_t i = 0; i < points.pixels.size(); ++i) {
              if (points.pixels[i].part == shading_point::no_part) continue;
              float sum = 0;
              for (const auto& alpha : drawn.fractions) {
                REQUIRE(alpha.pixels[i] > 0);  // a technique without a sample would leave out what it alone reaches
                sum += alpha.pixels[i];
              }
              REQUIRE(std::fabs(sum - 1) < 1e-6f);
            }
          }
        }
      }
    }
  }
}

TEST_CASE("Plans draw every sample, and leave one for each technique in each batch") {
  for (const std::int64_t samples : {2, 3, 4, 5, 9, 10, 11, 49, 50, 1000}) {
    const learning_plan papers = papers_plan(samples, 2, 5), recommended = recommended_plan<2>(samples, 200);
    for (const learning_plan& plan : {papers, recommended}) {
      CHECK(total(plan) == samples);
      for (const planned_batch& batch : plan.batches) CHECK(batch.samples >= 2);
    }
    CHECK(recommended.batches.size() == (samples < 4 ? 1 : 2));
    if (samples >= 10) CHECK(papers.batches.size() == 5);
    if (samples == 50) CHECK(papers.batches[0].samples == 10);
    if (samples < 5) continue;
    CHECK(total(recommended_plan<5>(samples, 200)) == samples);
    for (const planned_batch& batch : recommended_plan<5>(samples, 200).batches) CHECK(batch.samples >= 5);
  }
}

TEST_CASE("Methods have names, and others are refused in one line") {
  CHECK(parse_method("tsallis:0.1").gamma == 0.1);
  CHECK(parse_method("newton:2").family == "newton");
  CHECK(parse_method("default").family == "default");
  for (const std::string bad : {"", "best", "tsallis", "tsallis:", "tsallis:0", "tsallis:-1", "tsallis:x",
                                "tsallis:1x", "tsallis:inf", "newton:nan", "linear:1"}) {
    CHECK_THROWS_WITH(parse_method(bad), contains_text("--method"));
  }
  CHECK_THROWS_WITH(check({"area", 5, "tsallis:1", 50}), contains_text("two techniques"));
  CHECK_THROWS_WITH(check({"area", 2, "tsallis:1", 2049}), contains_text("2048"));
  CHECK_THROWS_WITH(check({"area", 5, "default", 4}), contains_text("--samples"));
  CHECK_NOTHROW(check({"area", 2, "tsallis:1", 2048}));
}

TEST_CASE("A ratio of means has the standard error of what is left of its line") {
  measured_method of{{"area", 2, "a", 1}}, to{{"area", 2, "b", 1}};
  for (const double e : {1.0, 2.0, 3.0}) {
    render::image_error error;
    error.rmse = e;
    to.errors.push_back(error);
    error.rmse = e == 2 ? 1.4 : e / 2 + 0.05;  // about one half; 0.55, 1.4, 1.55
    of.errors.push_back(error);
  }
  const mean_ratio ratio(of, to, &render::image_error::rmse);
  CHECK(ratio.ratio == Approx(3.5 / 6));
  const double off[] = {0.55 - 3.5 / 6, 1.4 - 7.0 / 6, 1.55 - 3.5 / 2};
  CHECK(ratio.standard_error == Approx(std::sqrt((off[0] * off[0] + off[1] * off[1] + off[2] * off[2]) / 6) / 2));
}
