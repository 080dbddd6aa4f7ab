// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_RENDER_IMAGE_HPP
#define PHIMIS_EXAMPLES_RENDER_IMAGE_HPP

#include <phimis/core/config.hpp>

#include <cstddef>
#include <vector>

namespace render {

/// One value per pixel, row by row from the top left. image<rgb> is a picture; image<float> a map.
template <class T>
struct image {
  image() = default;
  image(int columns, int rows, T value = T())
      : width(columns),
        height(rows),
        pixels(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), value) {}

  T& operator()(int x, int y) { return pixels[index(x, y)]; }
  const T& operator()(int x, int y) const { return pixels[index(x, y)]; }

  int width = 0;
  int height = 0;
  std::vector<T> pixels;

 private:
  std::size_t index(int x, int y) const {
    PHIMIS_EXPECTS(x >= 0 && x < width && y >= 0 && y < height);
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
};

/// The image of f(pixel).
template <class T, class F>
auto map(const image<T>& from, const F& f) {
  image<decltype(f(from.pixels[0]))> to(from.width, from.height);
  for (std::size_t i = 0; i < from.pixels.size(); ++i) to.pixels[i] = f(from.pixels[i]);
  return to;
}

}  // namespace render

#endif  // PHIMIS_EXAMPLES_RENDER_IMAGE_HPP
