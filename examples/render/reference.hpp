// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_RENDER_REFERENCE_HPP
#define PHIMIS_EXAMPLES_RENDER_REFERENCE_HPP

#include <papers/output_folder.hpp>
#include <render/exr.hpp>
#include <render/image.hpp>
#include <render/rgb.hpp>

#include <cstdint>
#include <filesystem>

namespace render {

/// Random streams of this purpose are for references alone.
inline constexpr std::uint32_t of_reference = 1;

/// The image of a file where it is there and has that size; else what draw() gives, which is written there.
///
/// Errors papers::cannot_run where it cannot be written. A file that cannot be read is replaced.
template <class Draw>
image<rgb> kept_image(const std::filesystem::path& file, int width, int height, const Draw& draw) {
  if (std::filesystem::exists(file)) {
    try {
      image<rgb> kept = read_exr(file);
      if (kept.width == width && kept.height == height) return kept;
    } catch (const papers::cannot_run&) {
    }
  }
  const image<rgb> picture = draw();
  write_exr(file, picture);
  return picture;
}

}  // namespace render

#endif  // PHIMIS_EXAMPLES_RENDER_REFERENCE_HPP
