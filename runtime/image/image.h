// Image: linear RGBA, premultiplied, float; what every renderer returns.
#pragma once

#include <cstddef>
#include <vector>

namespace pelage {

struct Image {
  int width = 0, height = 0;
  std::vector<float> rgba;  // [y][x][4], row 0 at the top, linear, premultiplied

  Image() = default;
  Image(int w, int h) : width(w), height(h), rgba(4U * static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
  float* pixel(int x, int y) noexcept {
    return rgba.data() +
           4U * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
  }
  const float* pixel(int x, int y) const noexcept {
    return rgba.data() +
           4U * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
  }
};

}  // namespace pelage
