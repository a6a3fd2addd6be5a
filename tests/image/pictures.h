// Pictures to compare.
#pragma once

#include <glm/vec3.hpp>
#include <random>

#include "pelage/image/image.h"

namespace pelage::test {

inline Image constant(int width, int height, glm::vec3 rgb) {
  Image image(width, height);
  for (std::size_t i = 0; i < image.rgba.size(); ++i) image.rgba[i] = i % 4 == 3 ? 1 : rgb[static_cast<int>(i % 4)];
  return image;
}

inline Image noise(int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  Image image(width, height);
  for (std::size_t i = 0; i < image.rgba.size(); ++i)
    image.rgba[i] = i % 4 == 3 ? 1 : static_cast<float>(random() % 10000) / 10000;
  return image;
}

inline std::vector<float> covered(const Image& image) {
  return std::vector<float>(image.rgba.size() / 4, 1.0F);
}

}  // namespace pelage::test
