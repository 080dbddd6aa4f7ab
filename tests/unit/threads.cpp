// SPDX-License-Identifier: MIT
// The result does not depend on the number of threads: a random stream belongs to a work item, results are merged in order.
#include "catch.hpp"
#include "random.hpp"

#include <phimis/phimis.hpp>

#include <atomic>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <thread>
#include <vector>

namespace {

struct power_density {
  double exponent;
  double pdf(double x) const { return x < 0 || x > 1 ? 0 : (exponent + 1) * std::pow(x, exponent); }
  template <phimis::uniform_source Next>
  double sample(Next&& next) const {
    return std::pow(1 - next(), 1 / (exponent + 1));
  }
};
const phimis::technique_set techniques(power_density{0}, power_density{1}, power_density{3});
double f(double x) { return 0.2 + x * std::sin(4 * x) * std::sin(4 * x); }

/// Calls work(item) for each item once, on so many threads.
template <class Work>
void on_threads(int threads, int items, const Work& work) {
  std::atomic<int> next = 0;
  const auto run = [&] {
    for (int item = next++; item < items; item = next++) work(item);
  };
  std::vector<std::jthread> all;
  for (int t = 0; t < threads; ++t) all.emplace_back(run);
}

std::vector<std::uint64_t> bits_of(const std::vector<double>& numbers) {
  std::vector<std::uint64_t> bits;
  for (const double x : numbers) bits.push_back(std::bit_cast<std::uint64_t>(x));
  return bits;
}

constexpr int items = 24;

/// Independent runs, merged in the order of their seeds: the estimate, its spread, and what one rule learns of all.
template <class Rule>
std::vector<double> merged_runs(int threads, const Rule& rule) {
  std::vector<phimis::moments<double>> estimates(items);
  std::vector<Rule> rules(items, rule);
  on_threads(threads, items, [&](int item) {
    const auto run = phimis::integrate(
        f, techniques, {.budget = 120, .iterations = 3, .seed = static_cast<std::uint64_t>(item) + 1}, rule);
    const auto i = static_cast<std::size_t>(item);
    estimates[i].add(run.estimate);
    rules[i] = run.rule;
  });
  phimis::moments<double> all;
  Rule learnt = rule;
  for (std::size_t i = 0; i < items; ++i) {
    all.merge(estimates[i]);
    learnt.merge(rules[i]);
  }
  learnt.update();
  std::vector<double> numbers{all.mean, all.variance()};
  for (int k = 0; k < 3; ++k) numbers.push_back(learnt.fractions()[k]);
  return numbers;
}

/// One batch whose samples are drawn by many: every block has the stream of its own index.
std::vector<double> batch_of_blocks(int threads) {
  std::vector<phimis::estimator<double, 3>> blocks(items);
  on_threads(threads, items, [&](int item) {
    random_numbers random(static_cast<std::uint64_t>(item));
    auto next = [&] { return random(); };
    blocks[static_cast<std::size_t>(item)] =
        phimis::draw_batch(f, techniques, phimis::fractions<double, 3>{{0.5, 0.25, 0.25}}, {.samples = 64},
                           phimis::balance{}, next, [](const auto&) {})
            .estimator;
  });
  phimis::estimator<double, 3> all;
  for (const auto& block : blocks) all.merge(block);
  return {all.estimate(), all.standard_error(phimis::sampling_model::multi_sample), all.effective_sample_size()};
}

template <class Rule>
void check_runs(const Rule& rule) {
  const auto one = merged_runs(1, rule);
  CHECK(one[1] > 0);
  for (const int threads : {2, 7}) CHECK(bits_of(merged_runs(threads, rule)) == bits_of(one));
}

}  // namespace

TEST_CASE("Runs on 1, 2 and 7 threads give the same estimate and fractions bit for bit") {
  check_runs(phimis::exact_rule<3>(phimis::chi_squared{}, {.prior = 1}));
  check_runs(phimis::streaming_rule<3>(phimis::kullback_leibler{}));
  check_runs(phimis::linear_rule<3>());
  check_runs(phimis::sigma_rule<3>());
}

TEST_CASE("A batch drawn in blocks on 1, 2 and 7 threads is the same bit for bit") {
  const auto one = batch_of_blocks(1);
  CHECK(one[1] > 0);
  for (const int threads : {2, 7}) CHECK(bits_of(batch_of_blocks(threads)) == bits_of(one));
}
