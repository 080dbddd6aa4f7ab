// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_DIRECT_LIGHTING_NEVER_WORSE_HPP
#define PHIMIS_EXAMPLES_DIRECT_LIGHTING_NEVER_WORSE_HPP

#include <direct_lighting/arguments.hpp>
#include <direct_lighting/methods.hpp>
#include <direct_lighting/reference.hpp>
#include <direct_lighting/table.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

// The default method against equal counts of the same techniques, over a grid of scenes and sample counts.

namespace direct_lighting {

/// Which part of the grid is rendered, and how well. Small images, but not so small that a cell of 16 by 16 pixels is a
/// large part of a plate.
struct never_worse_effort {
  int every;  ///< 1, 8 or 56: of 768 rows, one in so many, which span the grid
  int runs;   ///< of 1000 samples
  std::int64_t reference_samples = 20000;
  int size = 64;

  /// More with fewer samples, whose errors scatter more: standard errors of ratios come out alike.
  int runs_of(std::int64_t samples) const {
    return static_cast<int>(std::lround(runs * std::pow(1000.0 / static_cast<double>(samples), 0.7)));
  }
};

/// One row: the default against equal counts, run by run with the same seeds. Runs share the threads: seconds are of one.
inline std::vector<measured_method> measure_row(const view& of, const render::image<render::rgb>& reference,
                                                const configuration& base, const never_worse_effort& effort,
                                                std::uint64_t seed, int threads) {
  std::vector<measured_method> pair;
  for (const char* const name : {"equal", "default"}) {
    configuration what = base;
    what.method = name;
    pair.push_back({what});
  }
  const int runs = effort.runs_of(base.samples_per_pixel);
  for (measured_method& m : pair) {
    const method draw = make_method(of, m.of);
    m.errors.resize(static_cast<std::size_t>(runs));
    std::vector<double> seconds(m.errors.size());
    render::for_each_index(runs, threads, [&](int run) {
      const render::random_stream random(seed, static_cast<std::uint32_t>(run));
      const auto [taken, drawn] = timed([&] { return draw(random, 1, [] {}); });
      seconds[static_cast<std::size_t>(run)] = taken;
      m.errors[static_cast<std::size_t>(run)] = render::compare(drawn.picture, reference);
    });
    for (const double s : seconds) m.seconds += s / runs;
  }
  return pair;
}

/// Measures the grid, prints it, and says whether no row is worse than 1.02 by more than its noise, three standard errors.
inline bool never_worse(const papers::output_folder& folder, const std::filesystem::path& references,
                        const arguments& given, const never_worse_effort& effort) {
  constexpr double most = 1.02;
  std::string csv = csv_header;
  std::string worse;
  int rows = 0;
  double worst[2] = {};
  std::puts(
      "\nThe default against equal counts of the same techniques\n\n"
      "| exponents | plates | radii | sampler | techniques | samples | runs | RMSE ratio | s.e. | relMSE ratio | "
      "s.e. |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|");
  render::progress bar("never worse", 768 / effort.every);
  const std::int64_t sample_counts[] = {20, 50, 200, 1000};
  const float exponents[] = {5, 50, 500, 5000};
  const float radius_scales[] = {0.1f, 1, 3};
  for (int scene_at = 0; scene_at < 48; ++scene_at) {
    const int e = scene_at % 4, p = scene_at / 4 % 4, r = scene_at / 16;
    const float n = exponents[e];
    const scene_options options{{n, n, n, n}, p + 1, radius_scales[r]};
    const scene plates(options);
    const auto points = shading_points(plates, effort.size, effort.size, given.threads);
    render::image<render::rgb> truth;
    for (int i = 0; i < 16; ++i) {
      const int s = i % 4, cone = i / 4 % 2, five = i / 8;
      // A Latin square, one number of plates for each choice of the others; then half of it, with all pairs of values.
      if (effort.every > 1 && (p + e + r + s + cone + 2 * five) % 4 != 0) continue;
      if (effort.every > 1 && (s / 2 + e / 2 + r + cone + five) % 2 != 0) continue;
      if (effort.every > 8 && scene_at % 7 != 0) continue;
      if (truth.pixels.empty()) {
        truth = reference(references, options, plates, points, effort.reference_samples, given.threads);
      }
      const configuration base{cone ? "cone" : "area", five ? 5 : 2, "", sample_counts[s]};
      auto pair = measure_row({plates, points}, truth, base, effort, given.seed, given.threads);
      const mean_ratio ratios[] = {{pair[1], pair[0], &render::image_error::rmse},
                                   {pair[1], pair[0], &render::image_error::relmse}};
      char text[200];
      std::snprintf(text, sizeof text, "default exponents=%g plates=%d radius=%g", double{n}, options.plates,
                    double{options.radius_scale});
      pair[1].of.method = text;
      csv += csv_row(pair[1], pair[0]);
      ++rows;
      std::printf("| %g | %d | %g | %s | %d | %lld | %zu | %.4f | %.4f | %.4f | %.4f |\n", double{n}, options.plates,
                  double{options.radius_scale}, base.setting.c_str(), base.techniques,
                  static_cast<long long>(base.samples_per_pixel), pair[1].errors.size(), ratios[0].ratio,
                  ratios[0].standard_error, ratios[1].ratio, ratios[1].standard_error);
      for (int w = 0; w < 2; ++w) {
        worst[w] = std::max(worst[w], ratios[w].ratio);
        if (!(ratios[w].ratio - 3 * ratios[w].standard_error > most)) continue;
        char line[300];
        std::snprintf(line, sizeof line, "%s, %s, %d techniques, %lld samples: %s ratio %.4f +- %.4f\n", text,
                      base.setting.c_str(), base.techniques, static_cast<long long>(base.samples_per_pixel),
                      w == 0 ? "RMSE" : "relMSE", ratios[w].ratio, ratios[w].standard_error);
        worse += line;
      }
      bar.advance();
    }
  }
  folder.write("never_worse.csv", csv);
  std::printf("\nnever_worse.csv: %d of 768 rows; the highest ratio is %.4f of RMSE, %.4f of relMSE\n", rows,
              worst[0], worst[1]);
  if (!worse.empty()) std::fprintf(stderr, "direct_lighting: worse than equal counts:\n%s", worse.c_str());
  return worse.empty();
}

}  // namespace direct_lighting

#endif  // PHIMIS_EXAMPLES_DIRECT_LIGHTING_NEVER_WORSE_HPP
