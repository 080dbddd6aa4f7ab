// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_RENDER_PNG_HPP
#define PHIMIS_EXAMPLES_RENDER_PNG_HPP

#include <render/image.hpp>
#include <render/rgb.hpp>
#include <render/whole_file.hpp>

#include <png.h>

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <vector>

namespace render {

namespace detail {

inline std::uint8_t to_byte(float v) {
  return static_cast<std::uint8_t>(v > 0 ? (v < 1 ? v * 255 + 0.5f : 255.0f) : 0.0f);  // not a number: 0
}

}  // namespace detail

/// Writes display values, as tone_map and the colour map give them: [0, 1] becomes 0..255.
///
/// Errors papers::cannot_run, and there is no file.
inline void write_png(const std::filesystem::path& file, const image<rgb>& picture) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(3 * picture.pixels.size());
  for (const rgb& c : picture.pixels) {
    for (const float v : {c.r, c.g, c.b}) bytes.push_back(detail::to_byte(v));
  }
  write_whole(file, [&](const std::filesystem::path& unfinished) {
    png_image header{};
    header.version = PNG_IMAGE_VERSION;
    header.width = static_cast<png_uint_32>(picture.width);
    header.height = static_cast<png_uint_32>(picture.height);
    header.format = PNG_FORMAT_RGB;
    if (!png_image_write_to_file(&header, unfinished.c_str(), 0, bytes.data(), 0, nullptr)) {
      throw std::runtime_error(header.message);
    }
  });
}

}  // namespace render

#endif  // PHIMIS_EXAMPLES_RENDER_PNG_HPP
