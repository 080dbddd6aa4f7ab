// SPDX-License-Identifier: MIT
// Images: files give back what was written and appear whole or not at all; errors and colours of hand-made images.
#include "catch.hpp"

#include <render/colour_map.hpp>
#include <render/exr.hpp>
#include <render/metrics.hpp>
#include <render/parallel.hpp>
#include <render/png.hpp>
#include <render/random_stream.hpp>
#include <render/tone_map.hpp>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numeric>
#include <set>
#include <stdexcept>
#include <vector>

namespace {

using render::rgb;

/// An empty folder, gone at the end.
struct temporary_folder {
  temporary_folder() {
    std::filesystem::remove_all(path);
    std::filesystem::create_directories(path);
  }
  ~temporary_folder() { std::filesystem::remove_all(path); }
  bool empty() const { return std::filesystem::is_empty(path); }
  std::filesystem::path path = std::filesystem::current_path() / "images_test.tmp";
};

render::image<rgb> ramp(int width, int height) {
  render::image<rgb> picture(width, height);
  float v = 0;
  for (rgb& c : picture.pixels) c = {v, 1000 - v, 1e-6f * v}, v += 0.7f;
  return picture;
}

}  // namespace

TEST_CASE("An EXR file gives back every bit of its picture") {
  const temporary_folder folder;
  auto picture = ramp(7, 5);
  picture(3, 2) = {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::denorm_min(), -1};
  const render::image<float> fraction(7, 5, 0.25f);
  render::write_exr(folder.path / "a.exr", picture, {{"fraction", fraction}});
  const auto back = render::read_exr(folder.path / "a.exr");
  CHECK(back.width == 7);
  CHECK(back.height == 5);
  CHECK(back.pixels == picture.pixels);
  const Imf::InputFile file((folder.path / "a.exr").c_str());
  REQUIRE(file.header().channels().findChannel("fraction"));
  CHECK(file.header().channels().findChannel("fraction")->type == Imf::FLOAT);
}

TEST_CASE("A file that cannot be written or read is named, and nothing is left of it") {
  const temporary_folder folder;
  CHECK_THROWS_WITH(render::write_exr(folder.path / "no" / "a.exr", ramp(4, 4)), contains_text("a.exr"));
  CHECK_THROWS_WITH(render::write_png(folder.path / "no" / "a.png", ramp(4, 4)), contains_text("a.png"));
  CHECK_THROWS_WITH(render::write_exr(folder.path / "a.exr", ramp(4, 4), {{"x", render::image<float>(3, 4)}}),
                    contains_text("another size"));
  CHECK_THROWS_WITH(render::read_exr(folder.path / "a.exr"), contains_text("a.exr"));
  CHECK(folder.empty());
  // A folder of that name cannot be replaced; what was written under the other name goes.
  std::filesystem::create_directories(folder.path / "b.png" / "c");
  CHECK_THROWS_AS(render::write_png(folder.path / "b.png", ramp(4, 4)), papers::cannot_run);
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path), {}) == 1);
}

TEST_CASE("Half of an EXR file, and no EXR file, are refused") {
  const temporary_folder folder;
  const auto file = folder.path / "a.exr";
  render::write_exr(file, ramp(64, 64));
  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
  CHECK_THROWS_AS(render::read_exr(file), papers::cannot_run);
  std::ofstream(file) << "no picture";
  CHECK_THROWS_AS(render::read_exr(file), papers::cannot_run);
}

TEST_CASE("A PNG file gives back display values to a byte") {
  const temporary_folder folder;
  render::image<rgb> picture(3, 2, {0, 0.5f, 1});
  picture(2, 1) = {-1, 2, std::numeric_limits<float>::quiet_NaN()};
  render::write_png(folder.path / "a.png", picture);
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  REQUIRE(png_image_begin_read_from_file(&header, (folder.path / "a.png").c_str()));
  REQUIRE(header.width == 3);
  REQUIRE(header.height == 2);
  header.format = PNG_FORMAT_RGB;
  std::vector<int> expected;
  for (int i = 0; i < 5; ++i) expected.insert(expected.end(), {0, 128, 255});
  expected.insert(expected.end(), {0, 255, 0});
  std::vector<std::uint8_t> bytes(PNG_IMAGE_SIZE(header));
  REQUIRE(png_image_finish_read(&header, nullptr, bytes.data(), 0, nullptr));
  CHECK(std::vector<int>(bytes.begin(), bytes.end()) == expected);
}

TEST_CASE("Errors of an image of two pixels") {
  render::image<rgb> reference(2, 1), picture(2, 1);
  reference(0, 0) = {1, 0, 2};
  picture(0, 0) = {1.5f, 0.1f, 2};
  picture(1, 0) = {0, 0, 0.3f};
  const render::image_error error = render::compare(picture, reference);
  CHECK(error.rmse == Approx(std::sqrt(0.25 + 0.01 + 0.09)));
  CHECK(error.rmse_per_channel == Approx(std::sqrt((0.25 + 0.01 + 0.09) / 6)));
  CHECK(error.relmse == Approx((0.25 / 1.01 + 0.01 / 0.01 + 0.09 / 0.01) / 6));
  CHECK(error.relmse_trimmed == Approx(error.relmse));
  // 2.35 in units of 600² pixels: T's RMSE of 244.
  CHECK(render::compare(render::image<rgb>(60, 60, {0.235f, 0.235f, 0.235f}), render::image<rgb>(60, 60)).rmse ==
        Approx(24.4).epsilon(2e-3));
}

TEST_CASE("The trimmed error leaves out one pixel of a thousand, the worst") {
  render::image<rgb> picture(50, 40, {0.1f, 0.1f, 0.1f});
  picture(7, 3) = picture(20, 30) = {100, 100, 100};
  const auto two_bad = render::compare(picture, render::image<rgb>(50, 40));
  CHECK(two_bad.relmse == Approx((1998 * 1.0 + 2 * 1e6) / 2000));
  CHECK(two_bad.relmse_trimmed == Approx(1.0));
  render::image<rgb> not_quite(1999, 1, {0.1f, 0.1f, 0.1f});  // of which one pixel goes
  not_quite(3, 0) = not_quite(5, 0) = {100, 100, 100};
  CHECK(render::compare(not_quite, render::image<rgb>(1999, 1)).relmse_trimmed == Approx((1997 + 1e6) / 1998));
  picture(0, 0) = {10, 10, 10};
  CHECK(render::compare(picture, render::image<rgb>(50, 40)).relmse_trimmed == Approx((1997 + 1e4) / 1998));
}

TEST_CASE("A bias is the root of the pixels in standard errors where all are off by the same, 0 where they cancel") {
  const render::image<rgb> reference = ramp(10, 10);
  render::image<rgb> picture = render::map(reference, [](rgb c) { return c + rgb{0.5f, 0.25f, 1}; });
  CHECK(render::bias_in_standard_errors(picture, reference) == Approx(10).epsilon(1e-4));
  for (std::size_t i = 0; i < 100; i += 2) picture.pixels[i] = reference.pixels[i] - rgb{0.5f, 0.25f, 1};
  CHECK(render::bias_in_standard_errors(picture, reference) == Approx(0).margin(1e-3));
  CHECK(render::bias_in_standard_errors(reference, reference) == 0);
}

TEST_CASE("Tones and colours") {
  CHECK(render::srgb(0.5f) == Approx(0.735357f).epsilon(1e-5));
  CHECK(render::srgb(0.001f) == Approx(0.01292f));
  CHECK(render::srgb(7) == Approx(1));
  CHECK(render::srgb(-1) == 0);
  // A compiler's own power of a constant may differ from the library's in the last bit.
  CHECK(render::tone_map(render::image<rgb>(1, 1, {0.25f, 0, 0}), 2)(0, 0).r ==
        Approx(render::srgb(0.5f)).epsilon(1e-6));
  CHECK(render::colour_of(0) == rgb{0, 0, 1});
  CHECK(render::colour_of(0.25f) == rgb{0, 1, 1});
  CHECK(render::colour_of(0.5f) == rgb{0, 1, 0});
  CHECK(render::colour_of(0.75f) == rgb{1, 1, 0});
  CHECK(render::colour_of(2) == rgb{1, 0, 0});
  CHECK(render::colour_of(NAN) == rgb{});
  const auto with_bar = render::with_colour_bar(render::image<float>(40, 11, 0.5f));
  CHECK(with_bar(39, 5) == rgb{0, 1, 0});
  CHECK(with_bar(with_bar.width - 1, 0) == rgb{1, 0, 0});
  CHECK(with_bar(with_bar.width - 1, 5) == rgb{0, 1, 0});
  CHECK(with_bar(with_bar.width - 1, 10) == rgb{0, 0, 1});
}

TEST_CASE("Tiles cover an image once, whatever the threads, and an exception of one reaches the caller") {
  for (const int threads : {1, 2, 5}) {
    render::image<int> seen(37, 18);
    render::for_each_tile(37, 18, threads, [&](const render::tile& t) {
      for (int y = t.y0; y < t.y1; ++y) {
        for (int x = t.x0; x < t.x1; ++x) ++seen(x, y);
      }
    });
    CHECK(seen.pixels == std::vector<int>(37 * 18, 1));
    CHECK_THROWS_WITH(render::for_each_index(100, threads,
                                             [](int i) {
                                               if (i == 40) throw std::runtime_error("forty");
                                             }),
                      contains_text("forty"));
  }
}

TEST_CASE("Random numbers differ with seed, run, purpose, pixel and sample, and are uniform") {
  std::set<float> first;
  for (const std::uint64_t seed : {std::uint64_t{1}, std::uint64_t{1} << 32}) {
    for (const std::uint32_t run : {0u, 1u}) {
      for (const std::uint32_t purpose : {0u, 1u}) {
        for (const std::uint32_t pixel : {0u, 1u}) {
          for (const std::uint32_t sample : {0u, 1u}) {
            for (const float u : render::random_stream(seed, run, purpose)(pixel, sample)) first.insert(u);
          }
        }
      }
    }
  }
  // 128 of 2^24 values: two are the same with probability 5e-4.
  CHECK(first.size() == 128);
  double sum = 0;
  for (std::uint32_t i = 0; i < 25000; ++i) {
    for (const float u : render::random_stream(5, 0)(0, i)) {
      REQUIRE((u >= 0 && u < 1));
      sum += u;
    }
  }
  CHECK(std::fabs(sum - 50000) < 4 * std::sqrt(1e5 / 12));  // |z| < 4
}
