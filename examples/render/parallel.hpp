// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_RENDER_PARALLEL_HPP
#define PHIMIS_EXAMPLES_RENDER_PARALLEL_HPP

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace render {

/// Calls f(i) for i = 0..n-1, each once, on so many threads; which thread gets which i is left to chance.
///
/// Requires calls of f that do not disturb each other, threads >= 1.
/// Errors   the first exception of f, once all threads have stopped.
template <class F>
void for_each_index(int n, int threads, const F& f) {
  std::atomic<int> next{0};
  std::exception_ptr failure;
  std::mutex failing;
  const auto work = [&] {
    try {
      for (int i = next++; i < n; i = next++) f(i);
    } catch (...) {
      const std::lock_guard lock(failing);
      if (!failure) failure = std::current_exception();
      next = n;
    }
  };
  {
    std::vector<std::jthread> others;
    // A thread that the system denies is done without: this one does all the work if it must.
    try {
      for (int t = 1; t < std::min(threads, n); ++t) others.emplace_back(work);
    } catch (const std::system_error&) {
    }
    work();
  }
  if (failure) std::rethrow_exception(failure);
}

/// Pixels x0 <= x < x1, y0 <= y < y1.
struct tile {
  int x0, y0, x1, y1;
};

template <class F>
void for_each_pixel(const tile& t, const F& f) {
  for (int y = t.y0; y < t.y1; ++y) {
    for (int x = t.x0; x < t.x1; ++x) f(x, y);
  }
}

inline constexpr int tile_size = 16;

inline int tiles_across(int pixels) { return (pixels + tile_size - 1) / tile_size; }
inline int tile_count(int width, int height) { return tiles_across(width) * tiles_across(height); }

/// Calls f(tile) for tiles that cover the image, as for_each_index does.
template <class F>
void for_each_tile(int width, int height, int threads, const F& f) {
  for_each_index(tile_count(width, height), threads, [&](int i) {
    const int x = i % tiles_across(width) * tile_size;
    const int y = i / tiles_across(width) * tile_size;
    f(tile{x, y, std::min(x + tile_size, width), std::min(y + tile_size, height)});
  });
}

}  // namespace render

#endif  // PHIMIS_EXAMPLES_RENDER_PARALLEL_HPP
