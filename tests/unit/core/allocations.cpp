// SPDX-License-Identifier: MIT
// Core takes no memory from a heap: this executable counts every call of operator new, for aligned types, too.
#include "catch.hpp"
#include "random.hpp"

#include <phimis/core.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <new>

namespace {

std::atomic<long> allocations{0};

void* allocate(std::size_t size, std::align_val_t alignment = {}) noexcept {
  ++allocations;
  // A multiple of the alignment, as aligned_alloc wants it.
  const auto unit = std::max(static_cast<std::size_t>(alignment), alignof(std::max_align_t));
  void* const memory = std::aligned_alloc(unit, (size / unit + 1) * unit);
  if (memory == nullptr) std::abort();
  return memory;
}

}  // namespace

void* operator new(std::size_t size) { return allocate(size); }
void* operator new[](std::size_t size) { return allocate(size); }
// A sanitizer has its own of these, whose memory only its own delete may have back.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return allocate(size); }
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept { return allocate(size); }
void* operator new(std::size_t size, std::align_val_t alignment) { return allocate(size, alignment); }
void* operator new[](std::size_t size, std::align_val_t alignment) { return allocate(size, alignment); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
void operator delete[](void* memory, const std::nothrow_t&) noexcept { std::free(memory); }

namespace {

using phimis::observation;

/// M bumps on [0, 1], and an f with signs.
template <class Real, int M>
observation<Real, M> sample_at(double x, int technique) {
  observation<Real, M> sample{static_cast<Real>(std::sin(9 * x) + 0.5), {}, 0, technique};
  for (int k = 0; k < M; ++k) {
    const double z = (x - (k + 0.5) / M) * M;
    sample.pdfs[k] = static_cast<Real>(std::exp(-z * z) + 0.01);
    sample.q += sample.pdfs[k] / M;
  }
  return sample;
}

/// What a host does with a rule: observations, updates, states that are kept apart, merged and copied.
template <class Rule>
long allocations_of(const Rule& fresh) {
  using real = typename Rule::real;
  constexpr int m = Rule::techniques;
  random_numbers random(1);
  const long before = allocations;
  Rule rule = fresh;
  for (int batch = 0; batch < 3; ++batch) {
    const auto counts = phimis::split_largest_remainder(rule.fractions(), 40);
    phimis::estimator<real, m> estimate;
    for (int k = 0; k < m; ++k) {
      for (int i = 0; i < counts[k]; ++i) {
        const auto sample = sample_at<real, m>(random(), k);
        rule.observe(sample);
        estimate.add(k, sample.f / sample.q);
      }
    }
    rule.update();
    Rule other = fresh;
    other.resume(rule.state());
    other.observe(sample_at<real, m>(random(), 0));
    rule.merge(other);
    rule.update();
    (void)estimate.standard_error(phimis::sampling_model::multi_sample);
  }
  return allocations - before;
}

template <class Real, int M>
void check_all() {
  using phimis::negative_fractions;
  using table = phimis::fixed_table<Real, M, 4000>;
  CHECK(allocations_of(phimis::fixed_fractions<Real, M>()) == 0);
  CHECK(allocations_of(phimis::streaming_newton<phimis::tsallis, Real, M>(phimis::tsallis{1.5})) == 0);
  CHECK(allocations_of(phimis::streaming_newton<phimis::multi_sample_variance, Real, M>()) == 0);
  CHECK(allocations_of(phimis::linear_heuristic<Real, M, negative_fractions::drop_most_negative>()) == 0);
  CHECK(allocations_of(phimis::linear_heuristic<Real, M, negative_fractions::project>()) == 0);
  CHECK(allocations_of(phimis::linear_heuristic<Real, M, negative_fractions::best_face, table>()) == 0);
  CHECK(allocations_of(phimis::second_order<Real, M>()) == 0);
  CHECK(allocations_of(phimis::sigma_proportional<Real, M>()) == 0);
  CHECK(allocations_of(phimis::inverse_variance_fractions<Real, M>()) == 0);
  CHECK(allocations_of(phimis::exact_minimiser<phimis::kullback_leibler, table>(phimis::kullback_leibler{})) == 0);
  CHECK(allocations_of(phimis::exact_minimiser<phimis::tsallis, table>(phimis::tsallis{0.7})) == 0);
  CHECK(allocations_of(phimis::exact_minimiser<phimis::total_variation, table>(phimis::total_variation{})) == 0);
  CHECK(allocations_of(phimis::exact_minimiser<phimis::multi_sample_variance, table>(phimis::multi_sample_variance{})) ==
        0);
}

}  // namespace

TEST_CASE("The counter of allocations counts") {
  const long before = allocations;
  int* volatile number = new int(1);
  CHECK(allocations == before + 1);
  delete number;
  struct alignas(64) wide {
    double lanes[8];
  };
  wide* volatile block = new wide{};
  CHECK(allocations == before + 2);
  delete block;
}

TEST_CASE("Core allocates nothing, whatever the rule") {
  check_all<float, 2>();
  check_all<double, 2>();
  check_all<double, 3>();
  check_all<float, 8>();
  CHECK(allocations_of(phimis::newton_raphson<phimis::tsallis, float>(phimis::tsallis{1})) == 0);
  CHECK(allocations_of(phimis::newton_raphson<phimis::tsallis, double>(phimis::tsallis{2})) == 0);
}
