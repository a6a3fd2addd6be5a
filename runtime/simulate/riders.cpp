#include "pelage/simulate/riders.h"

#include <utility>

#include "pelage/data_schema/errors.h"
#include "pelage/simulate/for_strands.h"
#include "pelage/simulate/moving_line.h"

namespace pelage {

Riders::Riders(std::vector<std::uint32_t> vertex_offsets, const Strands& lines)
    : offsets(std::move(vertex_offsets)), line_offsets(lines.offsets), places(offsets.back()), first(lines.count()) {
  PELAGE_ASSERT(offsets.size() == line_offsets.size());
  for_strands(first.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) first[s] = first_frame(lines.strand(s));
  });
}

void Riders::ride(std::size_t s, const MovingLine& line, std::span<glm::vec3> out) const noexcept {
  const Place* place = places.data() + offsets[s];
  for (glm::vec3& v : out) {
    v = line.point(place->segment, place->fraction) +
        turned(line.frame(place->segment, place->fraction), place->offset);
    ++place;
  }
}

void Riders::ride(const Strands& lines, const glm::dquat& turn, std::span<glm::vec3> out) const {
  PELAGE_ASSERT(lines.offsets == line_offsets && out.size() == places.size());
  const glm::quat turn_f(turn);
  for_strands(first.size(), [&](std::size_t begin, std::size_t end) {
    MovingLine line;
    for (std::size_t s = begin; s < end; ++s) {
      if (offsets[s] == offsets[s + 1]) continue;
      line.set(lines.strand(s), turn_f * first[s]);
      ride(s, line, out.subspan(offsets[s], offsets[s + 1] - offsets[s]));
    }
  });
}

}  // namespace pelage
