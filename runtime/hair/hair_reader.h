// Private to this box: the formats' decoders. They return what the file says, in the file's unit and axes;
// hair_file.cpp turns that into clean Strands.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace pelage::hair {

struct RawHair {
  std::string format;
  std::vector<std::uint32_t> offsets{0};  // [strands + 1]
  std::vector<glm::vec3> points;          // [points]
  std::vector<float> thickness;           // [points], or empty: default_thickness for all, 0 where unknown
  std::vector<glm::vec3> colours;         // [strands] or empty
  float default_thickness = 0.0F;
  std::optional<float> opacity;  // as the file has it: may be NaN or out of range
  std::vector<std::string> notes;
};

/// Magic "HAIR" (or "hair"): shared/FORMATS.md section 1. @throws InputError
RawHair decode_hair(std::span<const std::byte> bytes, const std::string& where);

/// TFX 4, binary: shared/FORMATS.md section 2. @throws InputError
RawHair decode_tfx(std::span<const std::byte> bytes, const std::string& where);

/// Unaligned little-endian loads; the caller has checked the bounds. (All supported machines are little-endian.)
template <class T>
T load(std::span<const std::byte> bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

template <class T>
std::vector<T> load_array(std::span<const std::byte> bytes, std::size_t offset, std::size_t count) {
  std::vector<T> values(count);
  if (count > 0) std::memcpy(values.data(), bytes.data() + offset, count * sizeof(T));
  return values;
}

}  // namespace pelage::hair
