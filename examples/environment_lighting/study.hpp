// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_STUDY_HPP
#define PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_STUDY_HPP

#include <environment_lighting/arguments.hpp>
#include <environment_lighting/cases.hpp>
#include <environment_lighting/methods.hpp>
#include <environment_lighting/techniques.hpp>
#include <papers/output_folder.hpp>
#include <render/colour_map.hpp>
#include <render/exr.hpp>
#include <render/fixed_counts.hpp>
#include <render/metrics.hpp>
#include <render/png.hpp>
#include <render/progress.hpp>
#include <render/reference.hpp>
#include <render/study.hpp>
#include <render/tone_map.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

// What is measured of each case.

namespace environment_lighting {

/// The image that others are compared with, and its own mean squared error: two halves tell it.
struct reference_image {
  render::image<render::rgb> picture;
  double mse;
};

namespace detail {

/// A name that changes with a file's contents.
inline std::string version_of(const std::string& name) {
  if (!std::filesystem::exists(name)) return name;
  const auto written = std::filesystem::last_write_time(name).time_since_epoch().count();
  return std::filesystem::path(name).stem().string() + '_' + std::to_string(written);
}

inline double mean(const render::image<float>& of) {
  double sum = 0;
  for (const float v : of.pixels) sum += static_cast<double>(v);
  return sum / static_cast<double>(of.pixels.size());
}

}  // namespace detail

/// Three techniques at equal counts, random numbers of its own.   Errors as render::kept_image.
inline reference_image reference(const std::filesystem::path& folder, const test_case& of, const view& seen,
                                 std::int64_t samples, int threads) {
  const int width = seen.points.width, height = seen.points.height;
  std::string material = of.material;
  std::replace(material.begin(), material.end(), ':', '_');
  const std::string name = detail::version_of(of.map) + '_' + detail::version_of(of.object) + '_' + material + '_' +
                           std::to_string(width) + 'x' + std::to_string(height) + '_' + std::to_string(samples / 2);
  render::image<render::rgb> halves[2];
  render::progress bar("reference", 2 * render::tile_count(width, height));
  for (std::uint32_t half = 0; half < 2; ++half) {
    halves[half] = render::kept_image(folder / (name + (half == 0 ? "_a.exr" : "_b.exr")), width, height, [&] {
      return render::render_image(seen.points, techniques<3>(seen.world), render::equal_counts<3>(samples / 2),
                                  render::random_stream(0, half, render::of_reference), threads,
                                  [&] { bar.advance(); });
    });
  }
  reference_image result{halves[0], detail::mean(render::squared_error_map(halves[0], halves[1])) / 4};
  for (std::size_t i = 0; i < result.picture.pixels.size(); ++i) {
    result.picture.pixels[i] = (halves[0].pixels[i] + halves[1].pixels[i]) * 0.5f;
  }
  return result;
}

/// One method with one number of samples in one case.
struct result {
  render::configuration of;
  double mse;     ///< mean (I−R)² over pixels, channels and runs, without the reference's own
  double relmse;  ///< mean (I−R)²/(R² + 0.01)
  double seconds;
  /// mse to that of equal counts of two techniques. Its standard error treats pixels as independent of each other and of
  /// their kind: rather too large.
  double ratio, standard_error;
  double relmse_ratio, time_ratio;
  double bias;  ///< of the first run, in standard errors; not said where a method alone has too skewed an error

  /// 1/(MSE × time), to that of equal counts.
  double efficiency() const { return 1 / (ratio * time_ratio); }
};

inline std::vector<result> results_of(const std::vector<render::measured_method>& measured,
                                      const reference_image& truth) {
  const auto& equal = *std::find_if(measured.begin(), measured.end(),
                                    [](const render::measured_method& m) { return m.of.method == "equal"; });
  const auto mse_of = [&](const render::measured_method& m) { return detail::mean(m.squares) - truth.mse; };
  std::vector<result> results;
  for (const render::measured_method& m : measured) {
    result one{m.of, mse_of(m), m.error().relmse, m.seconds, mse_of(m) / mse_of(equal), 0, 0, 0, 0};
    double squares = 0;
    for (std::size_t i = 0; i < m.squares.pixels.size(); ++i) {
      const double off = static_cast<double>(m.squares.pixels[i]) - one.ratio * static_cast<double>(equal.squares.pixels[i]);
      squares += off * off;
    }
    one.standard_error = std::sqrt(squares) / (static_cast<double>(m.squares.pixels.size()) * mse_of(equal));
    one.relmse_ratio = one.relmse / equal.error().relmse;
    one.time_ratio = one.seconds / equal.seconds;
    one.bias = render::bias_in_standard_errors(m.first_run.picture, truth.picture);
    results.push_back(one);
  }
  return results;
}

/// The name of a case's files.
inline std::string file_name(const test_case& of) {
  std::string name = of.name;
  for (char& c : name) {
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  }
  return name;
}

/// Pictures, and where fractions are learnt a map of those of BRDF sampling, in the papers' colours, of the last batch; EXR
/// files have the fractions of all techniques.
inline void write_images(const papers::output_folder& folder, const std::string& name, const render::measured_method& m,
                         const render::image<shading_point>& points) {
  const std::string stem = name + '_' + m.of.method;
  const auto file = [&](const char* ending) {
    std::string of = stem;
    std::replace(of.begin(), of.end(), ':', '_');
    return folder.path() / (of + ending);
  };
  std::map<std::string, render::image<float>> channels{{"relative_error", m.error_map}};
  const auto& fractions = m.first_run.fractions;
  for (std::size_t k = 0; k < fractions.size(); ++k) {
    const bool brdf = k + 1 == fractions.size();
    channels[brdf ? "alpha_brdf" : fractions.size() == 2 ? "alpha_map" : k == 0 ? "alpha_bright" : "alpha_rest"] =
        fractions[k];
  }
  render::write_png(file(".png"), render::tone_map(m.first_run.picture));
  render::write_exr(file(".exr"), m.first_run.picture, channels);
  if (fractions.empty()) return;
  render::image<float> alpha = fractions.back();
  for (std::size_t i = 0; i < alpha.pixels.size(); ++i) {
    if (points.pixels[i].part == shading_point::no_part) {
      alpha.pixels[i] = std::numeric_limits<float>::quiet_NaN();
    }
  }
  render::write_png(file("_alpha.png"), render::with_colour_bar(alpha));
}

/// What is measured of a case: a row for each number of samples and each method.
struct case_study {
  test_case of;
  std::string files;  ///< the first part of the names of its images
  std::vector<result> results;

  const result& at(const std::string& method, std::int64_t samples) const {
    return *std::find_if(results.begin(), results.end(), [&](const result& r) {
      return r.of.method == method && r.of.samples_per_pixel == samples;
    });
  }
};

/// The number of samples of which images are written: V's 200, or the nearest.
inline std::int64_t samples_of_images(const std::vector<std::int64_t>& all) {
  return *std::min_element(all.begin(), all.end(), [](std::int64_t a, std::int64_t b) {
    return std::abs(a - 200) < std::abs(b - 200);
  });
}

inline case_study measure(const test_case& of, const arguments& given, const std::filesystem::path& references,
                          const papers::output_folder& images) {
  const lit_scene scene(of, given.width, given.height, given.threads);
  const view seen{scene.world(), scene.points()};
  const reference_image truth = reference(references, of, seen, given.reference_samples, given.threads);
  case_study study{of, file_name(of), {}};
  render::write_png(images.path() / (study.files + "_reference.png"), render::tone_map(truth.picture));
  const render::study measuring{
      [&](const render::configuration& one) { return make_method(seen, one.method, one.samples_per_pixel); },
      truth.picture, given.runs, given.seed, given.threads};
  for (const std::int64_t samples : given.samples) {
    const auto measured = measuring.measure(configurations(of.name, given.methods, samples),
                                            of.name + ", " + std::to_string(samples) + " samples");
    const std::vector<result> results = results_of(measured, truth);
    study.results.insert(study.results.end(), results.begin(), results.end());
    if (samples != samples_of_images(given.samples)) continue;
    for (const render::measured_method& m : measured) write_images(images, study.files, m, scene.points());
  }
  return study;
}

}  // namespace environment_lighting

#endif  // PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_STUDY_HPP
