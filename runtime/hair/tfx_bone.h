// .tfxbone (AMD TressFX): which bones carry each strand of the .tfx file beside it. Up to four bones a strand, with
// weights that sum to 1: the files' own sums are not (AMD's sample: down to 0.92), so they are scaled here.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace pelage::hair {

struct StrandBones {
  std::array<std::uint32_t, 4> bones{};  // index into TfxBones::names; 0 where the weight is 0
  std::array<float, 4> weights{};        // >= 0, sum 1
};

struct TfxBones {
  std::vector<std::string> names;     // [bones]
  std::vector<StrandBones> strands;   // [strands]
  double farthest_sum = 1.0;          // of a strand's weights in the file, of all the one farthest from 1
  std::vector<std::size_t> repaired;  // strands without a usable weight: all of it on their first bone, else bone 0
};

/// @throws InputError naming what is wrong: truncated, an index out of range, a strand or bone missing or given twice
TfxBones parse_tfxbone(std::span<const std::byte> bytes, const std::string& where);
TfxBones read_tfxbone(const std::filesystem::path& file);

}  // namespace pelage::hair
