#include "pelage/db/quantised_record.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "pelage/data_schema/errors.h"

namespace pelage {
namespace {

constexpr float kHalfMax = 65504.0F;
constexpr float kLargest = 1e6F;  // the schema's CHECK on scales

void check(const std::vector<float>& values, float limit, const std::string& where) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i] >= 0 && values[i] <= limit) continue;
    throw InputError(where, "value " + std::to_string(i) + " is " + std::to_string(values[i]) + ", outside [0, " +
                                std::to_string(limit) + "]; the record is not stored");
  }
}

}  // namespace

std::size_t bytes_per_value(Storage storage) noexcept {
  return storage == Storage::u8 ? 1 : 2;
}

std::uint16_t half_from_float(float value) noexcept {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  const auto sign = static_cast<std::uint16_t>((bits >> 16) & 0x8000U);
  const float magnitude = std::bit_cast<float>(bits & 0x7FFFFFFFU);
  if (!(magnitude < 65520.0F)) {  // rounds to infinity, or is NaN
    return static_cast<std::uint16_t>(sign | (std::isnan(magnitude) ? 0x7E00U : 0x7C00U));
  }
  if (magnitude < std::bit_cast<float>(113U << 23)) {  // subnormal half: adding 0.5 leaves the value in the low bits
    const auto shifted = std::bit_cast<std::uint32_t>(magnitude + 0.5F) - std::bit_cast<std::uint32_t>(0.5F);
    return static_cast<std::uint16_t>(sign | shifted);
  }
  const std::uint32_t m = std::bit_cast<std::uint32_t>(magnitude);
  const std::uint32_t even = (m >> 13) & 1U;
  return static_cast<std::uint16_t>(sign | ((m - (112U << 23) + 0xFFFU + even) >> 13));
}

float float_from_half(std::uint16_t half) noexcept {
  const std::uint32_t sign = static_cast<std::uint32_t>(half & 0x8000U) << 16;
  const std::uint32_t exponent = (half >> 10) & 0x1FU;
  const std::uint32_t mantissa = half & 0x3FFU;
  if (exponent == 0) {
    const float magnitude = static_cast<float>(mantissa) * 0x1p-24F;
    return std::bit_cast<float>(sign | std::bit_cast<std::uint32_t>(magnitude));
  }
  const std::uint32_t wide = exponent == 31 ? 255U : exponent + 112U;
  return std::bit_cast<float>(sign | (wide << 23) | (mantissa << 13));
}

QuantisedArray quantise(const std::vector<float>& values, Storage storage, const std::string& where) {
  check(values, storage == Storage::u8 ? kLargest : kHalfMax, where);
  QuantisedArray out;
  out.bytes.reserve(values.size() * bytes_per_value(storage));
  if (storage == Storage::u8) {
    out.scale = values.empty() ? 0.0F : *std::max_element(values.begin(), values.end());
    const double gain = out.scale > 0 ? 255.0 / static_cast<double>(out.scale) : 0.0;
    for (const float v : values) out.bytes.push_back(static_cast<std::uint8_t>(static_cast<double>(v) * gain + 0.5));
    return out;
  }
  for (const float v : values) {
    const std::uint16_t h = half_from_float(v);
    out.bytes.push_back(static_cast<std::uint8_t>(h & 0xFFU));
    out.bytes.push_back(static_cast<std::uint8_t>(h >> 8));
  }
  return out;
}

std::vector<float> dequantise(const QuantisedView& array, Storage storage) {
  std::vector<float> values(array.bytes.size() / bytes_per_value(storage));
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = storage == Storage::u8 ? array.scale * (1.0F / 255.0F) * static_cast<float>(array.bytes[i])
                                       : array.scale * float_from_half(static_cast<std::uint16_t>(
                                                           array.bytes[2 * i] | (array.bytes[2 * i + 1] << 8)));
  }
  return values;
}

}  // namespace pelage
