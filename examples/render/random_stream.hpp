// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_RENDER_RANDOM_STREAM_HPP
#define PHIMIS_EXAMPLES_RENDER_RANDOM_STREAM_HPP

#include <phimis/core/uniform.hpp>

#include <Random123/philox.h>

#include <array>
#include <cstdint>

namespace render {

/// The random numbers of a run, by their place and not by their turn: the same for any number and order of threads.
///
/// Source Salmon, Moraes, Dror & Shaw 2011, Philox4x32-10: the seed is its key, (pixel, sample, run, purpose) its counter.
class random_stream {
 public:
  /// Streams of different purpose, a reference's and those that are compared with it, have no number in common.
  random_stream(std::uint64_t seed, std::uint32_t run, std::uint32_t purpose = 0)
      : key_{{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)}},
        run_(run),
        purpose_(purpose) {}

  /// Four uniform numbers in [0, 1).
  std::array<float, 4> operator()(std::uint32_t pixel, std::uint32_t sample) const {
    const r123::Philox4x32::ctr_type bits = r123::Philox4x32()({{pixel, sample, run_, purpose_}}, key_);
    return {uniform(bits[0]), uniform(bits[1]), uniform(bits[2]), uniform(bits[3])};
  }

 private:
  static float uniform(std::uint32_t bits) { return phimis::uniform<float>(std::uint64_t{bits} << 32); }

  r123::Philox4x32::key_type key_;
  std::uint32_t run_;
  std::uint32_t purpose_;
};

}  // namespace render

#endif  // PHIMIS_EXAMPLES_RENDER_RANDOM_STREAM_HPP
