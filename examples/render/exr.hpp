// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_RENDER_EXR_HPP
#define PHIMIS_EXAMPLES_RENDER_EXR_HPP

#include <render/image.hpp>
#include <render/rgb.hpp>
#include <render/whole_file.hpp>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>

#include <cstddef>
#include <exception>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>

namespace render {

namespace detail {

/// A channel that lies in memory with `step` bytes from pixel to pixel.
inline Imf::Slice slice(const float* first, std::size_t step, int width) {
  char* const base = reinterpret_cast<char*>(const_cast<float*>(first));  // the same type reads and writes
  return {Imf::FLOAT, base, step, step * static_cast<std::size_t>(width)};
}

inline Imf::FrameBuffer rgb_channels(const image<rgb>& picture) {
  Imf::FrameBuffer buffer;
  buffer.insert("R", slice(&picture.pixels[0].r, sizeof(rgb), picture.width));
  buffer.insert("G", slice(&picture.pixels[0].g, sizeof(rgb), picture.width));
  buffer.insert("B", slice(&picture.pixels[0].b, sizeof(rgb), picture.width));
  return buffer;
}

}  // namespace detail

/// Writes linear radiance, and maps of the same size as further channels, each under its name; all 32-bit float.
///
/// Errors papers::cannot_run, and there is no file.
inline void write_exr(const std::filesystem::path& file, const image<rgb>& picture,
                      const std::map<std::string, image<float>>& maps = {}) {
  write_whole(file, [&](const std::filesystem::path& unfinished) {
    Imf::Header header(picture.width, picture.height);
    Imf::FrameBuffer buffer = detail::rgb_channels(picture);
    for (const auto& [name, map] : maps) {
      if (map.width != picture.width || map.height != picture.height) {
        throw std::invalid_argument("channel " + name + " has another size than the picture");
      }
      buffer.insert(name, detail::slice(map.pixels.data(), sizeof(float), map.width));
    }
    for (auto channel = buffer.begin(); channel != buffer.end(); ++channel) {
      header.channels().insert(channel.name(), Imf::Channel(Imf::FLOAT));
    }
    Imf::OutputFile out(unfinished.c_str(), header);
    out.setFrameBuffer(buffer);
    out.writePixels(picture.height);
  });
}

/// The channels R, G and B of a file.
///
/// Errors papers::cannot_run where the file is not there, is no EXR or not a whole one, or has no such channels.
inline image<rgb> read_exr(const std::filesystem::path& file) {
  try {
    Imf::InputFile in(file.c_str());
    const Imath::Box2i window = in.header().dataWindow();
    if (window.min != Imath::V2i(0, 0)) throw std::runtime_error("its first pixel is not (0, 0)");
    for (const char* const name : {"R", "G", "B"}) {
      if (!in.header().channels().findChannel(name)) throw std::runtime_error(std::string("no channel ") + name);
    }
    image<rgb> picture(window.max.x + 1, window.max.y + 1);
    in.setFrameBuffer(detail::rgb_channels(picture));
    in.readPixels(0, window.max.y);
    return picture;
  } catch (const std::exception& error) {
    throw papers::cannot_run("cannot read " + file.string() + ": " + error.what());
  }
}

}  // namespace render

#endif  // PHIMIS_EXAMPLES_RENDER_EXR_HPP
