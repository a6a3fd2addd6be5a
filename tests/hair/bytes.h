// Byte fixtures of the hair formats, built field by field.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

namespace pelage::test {

using Bytes = std::vector<std::byte>;

template <class T>
void put(Bytes& bytes, std::size_t offset, T value) {
  if (bytes.size() < offset + sizeof value) bytes.resize(offset + sizeof value);
  std::memcpy(bytes.data() + offset, &value, sizeof value);
}

template <class T>
void append(Bytes& bytes, T value) {
  put(bytes, bytes.size(), value);
}

inline void append_point(Bytes& bytes, float x, float y, float z) {
  append(bytes, x);
  append(bytes, y);
  append(bytes, z);
}

inline Bytes hair_header(std::uint32_t strands, std::uint32_t points, std::uint32_t bits, std::uint32_t segments) {
  Bytes bytes(128);
  std::memcpy(bytes.data(), "HAIR", 4);
  put(bytes, 4, strands);
  put(bytes, 8, points);
  put(bytes, 12, bits);
  put(bytes, 16, segments);
  return bytes;
}

/// Three strands of 3, 2 and 4 points 5 cm apart: an odd count, so that the floats lie unaligned. All five arrays.
inline Bytes small_hair() {
  Bytes bytes = hair_header(3, 9, 31, 0);
  const int points[] = {3, 2, 4};
  for (const int n : points) append(bytes, static_cast<std::uint16_t>(n - 1));
  for (int s = 0; s < 3; ++s) {
    for (int k = 0; k < points[s]; ++k)
      append_point(bytes, 0.01F * static_cast<float>(s), -0.05F * static_cast<float>(k), 0.5F);
  }
  for (int k = 0; k < 9; ++k) append(bytes, 1e-4F);
  for (int k = 0; k < 9; ++k) append(bytes, 0.25F);
  for (int k = 0; k < 9; ++k) append_point(bytes, 0.5F, 0.25F, 0.125F);
  return bytes;
}

/// Two strands of four vertices 5 cm apart, with thickness and colours.
inline Bytes small_tfx() {
  Bytes bytes(160);
  put(bytes, 0, 4.0F);
  put(bytes, 4, std::uint32_t{2});
  put(bytes, 8, std::uint32_t{4});
  put(bytes, 12, std::uint32_t{160});
  put(bytes, 24, std::uint32_t{160 + 128});
  put(bytes, 28, std::uint32_t{160 + 128 + 8});
  for (int s = 0; s < 2; ++s) {
    for (int k = 0; k < 4; ++k) {
      append_point(bytes, 0.01F * static_cast<float>(s), 1.0F - 0.05F * static_cast<float>(k), 0.0F);
      append(bytes, k == 0 ? 0.0F : 1.0F);
    }
  }
  append(bytes, 2e-4F);
  append(bytes, 3e-4F);
  for (int k = 0; k < 8; ++k) {
    append_point(bytes, 0.75F, 0.5F, 0.25F);
    append(bytes, 1.0F);
  }
  return bytes;
}

}  // namespace pelage::test
