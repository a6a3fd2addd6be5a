// Procedural grooms on the parametric head: the demo's hair, and hair for tests without anybody's files.
//
// Every strand grows from its root in small steps: combed away from a parting, then bent by gravity, always outside the
// head; long hair falls before and behind the shoulders. Strands of a lock are drawn together towards their tips and
// share waves and curls. Hair is cut in layers; one strand in a hundred flies away from its lock, and short fine hair
// softens the hairline. Strands narrow towards their tips. The ponytail is combed to a tie. The result depends on the
// settings only: not on threads, nor on the CPU.
#pragma once

#include <cstdint>
#include <string_view>

#include "pelage/data_schema/strands.h"
#include "pelage/hair/head.h"

namespace pelage::hair {

enum class GroomStyle { straight, wavy, curly, bob, ponytail };

struct GroomSettings {
  GroomStyle style = GroomStyle::wavy;
  std::uint32_t strands = 10'000;  // [1, 1,000,000]
  std::uint64_t seed = 1;
  int vertices = 0;           // per strand, [4, 1000]; 0: 32, and 64 for curls
  float length_scale = 1.0F;  // of what hangs down, [0.2, 3]
  HeadParameters head{};
};

/// "straight", "wavy", "curly", "bob", "ponytail". @throws UsageError
GroomStyle parse_groom_style(std::string_view name);

/// With a diameter for each vertex: the default for their number, and what tapers of it.
/// @throws UsageError for settings out of range
Strands groom(const GroomSettings& settings);

}  // namespace pelage::hair
