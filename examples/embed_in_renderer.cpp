// SPDX-License-Identifier: MIT
// A renderer's loop with phimis/core.hpp alone: no heap, no exceptions, 64 bytes a pixel. Directions are numbers in [0, 1].
//
// test:
#include <phimis/core.hpp>

#include <cmath>
#include <cstdio>
#include <random>

using rule = phimis::streaming_newton<phimis::chi_squared, float, 2>;
static_assert(sizeof(rule::state_type) <= 64, "per pixel");

struct light_sample {
  float f;                               // luminance of radiance · BRDF · cosine
  phimis::per_technique<float, 2> pdfs;  // of the light and of the BRDF at this direction, whichever drew it
};
light_sample draw(float glossiness, int technique, float u) {
  const float x = technique == 0 ? std::sqrt(u) : std::pow(u, 1 / (glossiness + 1));
  const phimis::per_technique<float, 2> pdfs{{2 * x, (glossiness + 1) * std::pow(x, glossiness)}};
  return {(1.2f - x) * (0.05f + pdfs[1]), pdfs};
}

constexpr int pixels = 1000, batches = 5, samples = 10;
rule::state_type states[pixels];  // fractions, counters, sums: copied by their bytes, on a GPU or a disk as well
float image[pixels];

int main() {
  phimis::rule_options<float, 2> options;
  options.prior = 2;                                    // samples that equal counts are trusted like
  options.floors = {{0.1f, 0.1f}};                      // what no evidence takes from a technique
  rule learning(phimis::chi_squared{}, options, 0.5f);  // one for the whole image
  for (auto& state : states) state = learning.state();
  std::mt19937 random(1);
  for (int b = 0; b < batches; ++b) {
    for (int i = 0; i < pixels; ++i) {
      learning.resume(states[i]);
      // What was learnt before, rounded to samples, one of each technique at least: each batch is unbiased.
      const phimis::counts<2> n = phimis::split_largest_remainder(learning.fractions(), samples);
      const phimis::fractions<float, 2> alpha{{float(n[0]) / samples, float(n[1]) / samples}};
      for (int j = 0; j < samples; ++j) {
        const int k = j < n[0] ? 0 : 1;
        const float u = phimis::uniform<float>(std::uint64_t{random()} << 32);
        const light_sample x = draw(i < pixels / 2 ? 1.0f : 100.0f, k, u);
        const float q = phimis::mixture(alpha, x.pdfs);
        image[i] += x.f / q / (samples * batches);  // the balance heuristic
        learning.observe({x.f, x.pdfs, q, k});
      }
      learning.update();
      states[i] = learning.state();
    }
  }
  double mean[2] = {}, light[2] = {};  // of the dull half of the image and of the glossy one
  for (int i = 0; i < pixels; ++i) mean[2 * i / pixels] += double(image[i]) * 2 / pixels;
  for (int i = 0; i < pixels; ++i) light[2 * i / pixels] += double(states[i].fractions[0]) * 2 / pixels;
  std::printf("mean %.4f and %.4f, exactly 0.5683 and 0.2448\n", mean[0], mean[1]);
  std::printf("fraction of light samples %.2f and %.2f\n", light[0], light[1]);
  return std::fabs(mean[0] - 0.5683) < 0.01 && std::fabs(mean[1] - 0.2448) < 0.01 ? 0 : 1;
}
