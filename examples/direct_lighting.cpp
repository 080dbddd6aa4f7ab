// SPDX-License-Identifier: MIT
// Direct lighting of Veach's plates, T Sec. 8: the images, errors and times of sampling methods, each with the same number
// of samples per pixel. Ratios are to equal counts of two techniques with the same light sampler.
//
// test: --width 32 --height 32 --samples 20 --runs 2 --reference-samples 500
#include <direct_lighting/arguments.hpp>
#include <direct_lighting/reference.hpp>
#include <direct_lighting/render.hpp>
#include <direct_lighting/study.hpp>
#include <papers/output_folder.hpp>
#include <render/colour_map.hpp>
#include <render/exr.hpp>
#include <render/png.hpp>
#include <render/progress.hpp>
#include <render/tone_map.hpp>

#include <CLI/CLI.hpp>

#include <cmath>
#include <cstdio>
#include <exception>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using namespace direct_lighting;

/// What every method shares.
struct workplace {
  const arguments& given;
  const scene& plates;
  const render::image<shading_point>& points;
  const render::image<render::rgb>& reference;
};

template <int M>
phimis::counts<M> counts_of(const std::string& method, std::int64_t samples) {
  phimis::fractions<double, M> alpha = phimis::equal_fractions<double, M>();
  if (method == "brdf") alpha = {}, alpha[M - 1] = 1;
  if (method == "light") {
    for (int k = 0; k < M; ++k) alpha[k] = k < M - 1 ? 1.0 / (M - 1) : 0;
  }
  return phimis::split_largest_remainder(alpha, samples);
}

template <int M, class LightSampling>
measured_method measure_method(const workplace& at, const std::string& method) {
  const arguments& given = at.given;
  measured_method result{given.sampler, M, method, given.samples, given.runs, {}, 0, {}, {}};
  const techniques<M, LightSampling> all(at.plates);
  const phimis::counts<M> n = counts_of<M>(method, given.samples);
  render::progress bar(method, std::int64_t{given.runs} * render::tile_count(given.width, given.height));
  measure(result, at.reference, [&](std::uint32_t run) {
    return render_image(at.points, all, n, render::random_stream(given.seed, run), given.threads,
                        [&] { bar.advance(); });
  });
  return result;
}

measured_method measure_method(const workplace& at, int techniques, const std::string& method) {
  if (at.given.sampler == "area") {
    return techniques == 2 ? measure_method<2, area_sampling>(at, method)
                           : measure_method<5, area_sampling>(at, method);
  }
  return techniques == 2 ? measure_method<2, cone_sampling>(at, method)
                         : measure_method<5, cone_sampling>(at, method);
}

void write_images(const papers::output_folder& folder, const measured_method& m) {
  const auto file = [&](const char* ending) {
    return folder.path() / (m.sampler + '_' + std::to_string(m.techniques) + '_' + m.method + ending);
  };
  render::write_png(file(".png"), render::tone_map(m.first_run));
  render::write_exr(file(".exr"), m.first_run, {{"relative_error", m.error_map}});
  // The root is a relative error: red where it is 100 %.
  render::write_png(file("_error.png"),
                    render::with_colour_bar(render::map(m.error_map, [](float e) { return std::sqrt(e); })));
}

int run(const arguments& given) {
  const scene plates(given.scene);
  if (given.samples < given.techniques) throw std::invalid_argument("--samples: fewer than --techniques");
  const papers::output_folder folder(given.output);
  const auto points = shading_points(plates, given.width, given.height, given.threads);
  const auto truth = reference(folder.path(), given.scene, plates, points, given.reference_samples, given.threads);
  render::write_png(folder.path() / "reference.png", render::tone_map(truth));

  const workplace at{given, plates, points, truth};
  const measured_method baseline = measure_method(at, 2, "equal");
  std::vector<measured_method> methods;
  for (const std::string& method : given.methods) {
    const bool measured = given.techniques == 2 && method == "equal";
    methods.push_back(measured ? baseline : measure_method(at, given.techniques, method));
    write_images(folder, methods.back());
  }
  print_table(methods, baseline);
  folder.write("direct_lighting.csv", to_csv(methods, baseline));

  // Its own check: one image of equal counts has no bias, |z| < 5.
  const double z = render::bias_in_standard_errors(baseline.first_run, truth);
  if (!(std::fabs(z) < 5)) std::fprintf(stderr, "direct_lighting: equal counts are biased, z = %.1f\n", z);
  return std::fabs(z) < 5 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  arguments given;
  CLI::App app("Direct lighting of four plates by four lights: images, errors and times of sampling methods.");
  add_options(app, given, {"brdf", "light", "equal"});
  try {
    app.parse(argc, argv);
    return run(given);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    std::fprintf(stderr, "direct_lighting: %s; --help lists the options\n", error.what());
  } catch (const std::bad_alloc&) {
    std::fputs("direct_lighting: not enough memory for an image of this size\n", stderr);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "direct_lighting: %s\n", error.what());
  }
  return 2;
}
