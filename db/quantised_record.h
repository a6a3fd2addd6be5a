// HRIR records as they are stored: 8 bits with one scale per record, or IEEE half.
//   u8:   value = scale * q / 255, scale = the record's maximum; error <= scale / 510.
//   half: value = the half itself, scale = 1; relative error <= 2^-11 (absolute <= 2^-25 below 2^-14).
// Both round to nearest and are exact at 0; half refuses values beyond 65504.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pelage/data_schema/bake_settings.h"
#include "pelage/data_schema/hrir_record.h"

namespace pelage {

struct QuantisedArray {
  float scale = 1;
  std::vector<std::uint8_t> bytes;  // 1 or 2 (little-endian) bytes per value
};

/// A stored array where it lies.
struct QuantisedView {
  float scale = 1;
  std::span<const std::uint8_t> bytes;
  QuantisedView() = default;
  QuantisedView(float s, std::span<const std::uint8_t> b) : scale(s), bytes(b) {}
  QuantisedView(const QuantisedArray& array) : scale(array.scale), bytes(array.bytes) {}
};

std::size_t bytes_per_value(Storage storage) noexcept;

/// @throws InputError for a value that is negative, not finite or beyond the storage's range; `where` names it.
QuantisedArray quantise(const std::vector<float>& values, Storage storage, const std::string& where);
std::vector<float> dequantise(const QuantisedView& array, Storage storage);

/// IEEE 754 binary16, round to nearest even. Portable: the same bits on every CPU.
std::uint16_t half_from_float(float value) noexcept;
float float_from_half(std::uint16_t half) noexcept;

}  // namespace pelage
