// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_DIRECT_LIGHTING_OVERHEAD_HPP
#define PHIMIS_EXAMPLES_DIRECT_LIGHTING_OVERHEAD_HPP

#include <direct_lighting/methods.hpp>
#include <direct_lighting/table.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

// What rules cost. Counts are equal all along: other counts would take other samples, which take other times.

namespace direct_lighting {

/// Equal fractions, without a look at the samples.
template <int M>
struct idle_rule {
  phimis::fractions<float, M> fractions() const { return phimis::equal_fractions<float, M>(); }
  void observe(const phimis::observation<float, M>&) {}
  void update() {}
};

/// A rule that learns, and is not listened to.
template <class Rule>
struct unheard_rule : Rule {
  explicit unheard_rule(const Rule& rule) : Rule(rule) {}
  auto fractions() const { return phimis::equal_fractions<float, Rule::techniques>(); }
};

inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// One line for each rule; each repetition renders all of them in turn, on one thread.
template <int M, class LightSampling>
void print_overhead(const view& of, const char* sampler, std::int64_t samples, std::uint64_t seed, int repetitions) {
  struct contender {
    const char* name;
    const char* plan;
    std::size_t bytes;
    int idle;  ///< which one renders the same without a rule
    method draw;
    std::vector<double> seconds{};
  };
  const techniques<M, LightSampling> of_light(of.plates);
  const learning_plan cells = recommended_plan<M>(samples, of.points.width);
  const learning_plan pixels = render::papers_plan(samples, M, 10);
  const auto learning = [&](const auto& rule, const learning_plan& plan) {
    return render::learning_method(of.points, of_light, rule, plan);
  };
  const auto recommended = recommended_rule<M>(1, of.points.width);
  const auto linear = render::make_linear_rule<M>();
  contender all[] = {
      {"equal counts", "none", 0, 0, render::fixed_method(of.points, of_light, render::equal_counts<M>(samples))},
      {"none", "default", 0, 1, learning(idle_rule<M>(), cells)},
      {"default", "default", sizeof(recommended.state()), 1, learning(unheard_rule(recommended), cells)},
      {"linear", "default", sizeof(linear.state()), 1, learning(unheard_rule(linear), cells)},
      {"none", "papers'", 0, 4, learning(idle_rule<M>(), pixels)},
      {"linear", "papers'", sizeof(linear.state()), 4, learning(unheard_rule(linear), pixels)}};
  render::progress bar(std::string("overhead, ") + sampler, repetitions);
  for (int i = 0; i < repetitions; ++i) {
    for (contender& c : all) {
      const render::random_stream random(seed, static_cast<std::uint32_t>(i));
      c.seconds.push_back(timed([&] { return c.draw(random, 1, [] {}); }).first);
    }
    bar.advance();
  }
  const auto lit = std::count_if(of.points.pixels.begin(), of.points.pixels.end(),
                                 [](const shading_point& p) { return p.part != shading_point::no_part; });
  for (const contender& c : all) {
    std::vector<double> of_rule;
    for (std::size_t i = 0; i < c.seconds.size(); ++i) of_rule.push_back(c.seconds[i] - all[c.idle].seconds[i]);
    const double unit = 1e-9 * static_cast<double>(lit * samples);
    const double time = median(c.seconds), rule = median(of_rule);
    char share[60] = " | ";
    if (c.bytes > 0) std::snprintf(share, sizeof share, "%.1f | %.1f %%", rule / unit, 100 * rule / time);
    std::printf("| %s | %d | %s | %s | %.1f | %s | %zu |\n", sampler, M, c.plan, c.name, time / unit, share, c.bytes);
  }
}

inline void print_overheads(const view& of, std::int64_t samples, std::uint64_t seed, int repetitions) {
  std::printf(
      "\nTime of a sample with equal counts, and the share of it that a rule takes to observe and update; %d "
      "repetitions\n\n| sampler | techniques | plan | rule | ns | observe + update, ns | share | bytes of a state |\n"
      "|---|---|---|---|---|---|---|---|\n",
      repetitions);
  print_overhead<2, area_sampling>(of, "area", samples, seed, repetitions);
  print_overhead<5, area_sampling>(of, "area", samples, seed, repetitions);
  print_overhead<2, cone_sampling>(of, "cone", samples, seed, repetitions);
  print_overhead<5, cone_sampling>(of, "cone", samples, seed, repetitions);
}

}  // namespace direct_lighting

#endif  // PHIMIS_EXAMPLES_DIRECT_LIGHTING_OVERHEAD_HPP
