// FLIP's map of two pictures for flip_twin.py: reads WIDTH, HEIGHT as text and two pictures as float linear RGB from
// stdin, writes [y][x] float to stdout.
#include <cstdio>
#include <iostream>

#include "pelage/image/flip.h"

int main() {
  int width = 0, height = 0;
  if (!(std::cin >> width >> height) || std::cin.get() != '\n') return 1;
  pelage::Image pictures[2] = {{width, height}, {width, height}};
  for (pelage::Image& picture : pictures)
    for (std::size_t i = 0; i < picture.rgba.size(); i += 4)
      std::cin.read(reinterpret_cast<char*>(&picture.rgba[i]), 3 * sizeof(float));
  if (!std::cin) return 1;
  const std::vector<float> map = pelage::flip_map(pictures[0], pictures[1]);
  return std::fwrite(map.data(), sizeof(float), map.size(), stdout) == map.size() ? 0 : 1;
}
