// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_RENDER_PROGRESS_HPP
#define PHIMIS_EXAMPLES_RENDER_PROGRESS_HPP

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <mutex>
#include <string>
#include <utility>

namespace render {

/// A bar with the time left on standard error, where that is a terminal; nothing elsewhere. Gone when its work is done.
class progress {
 public:
  progress(std::string label, std::int64_t steps)
      : label_(std::move(label)), steps_(std::max<std::int64_t>(steps, 1)) {}
  progress(const progress&) = delete;
  progress& operator=(const progress&) = delete;
  ~progress() {
    if (shown_) std::fputs("\r\033[K", stderr);
  }

  /// One step is done, in any thread.
  void advance() {
    if (!terminal_) return;
    const std::lock_guard lock(showing_);
    ++done_;
    const auto now = clock::now();
    if (now - last_ < std::chrono::milliseconds(100)) return;
    last_ = now;
    shown_ = true;
    const double elapsed = std::chrono::duration<double>(now - begin_).count();
    const double share = static_cast<double>(done_) / static_cast<double>(steps_);
    constexpr int width = 30;
    std::string bar(width, '.');
    std::fill_n(bar.begin(), static_cast<int>(std::min(share, 1.0) * width), '#');
    std::fprintf(stderr, "\r\033[K%s [%s] %.0f %%, %.0f s left", label_.c_str(), bar.c_str(), 100 * share,
                 elapsed * std::max(0.0, 1 / share - 1));
  }

 private:
  using clock = std::chrono::steady_clock;

  std::string label_;
  std::int64_t steps_;
  std::int64_t done_ = 0;
  bool terminal_ = isatty(STDERR_FILENO) != 0;
  bool shown_ = false;
  std::mutex showing_;
  clock::time_point begin_ = clock::now();
  clock::time_point last_ = begin_;
};

}  // namespace render

#endif  // PHIMIS_EXAMPLES_RENDER_PROGRESS_HPP
