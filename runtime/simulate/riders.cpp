#include "pelage/simulate/riders.h"

#include <algorithm>
#include <array>
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
    const glm::vec3& o = place->offset;
    v = MovingLine::vec(line.carried(place->segment, Four{o.x, o.y, o.z, place->fraction}));
    ++place;
  }
}

void Riders::ride(const Strands& lines, const glm::dquat& turn, std::span<glm::vec3> out) const {
  PELAGE_ASSERT(lines.offsets == line_offsets && out.size() == places.size());
  const glm::quat turn_f(turn);
  for_strands(first.size(), [&](std::size_t begin, std::size_t end) {
    MovingLines moving;
    std::array<std::span<const glm::vec3>, kFrameLanes> group;
    std::array<glm::quat, kFrameLanes> frames;
    for (std::size_t s = begin; s < end; s += kFrameLanes) {
      const std::size_t n = std::min(kFrameLanes, end - s);
      for (std::size_t l = 0; l < n; ++l) group[l] = lines.strand(s + l), frames[l] = turn_f * first[s + l];
      moving.set(std::span(group).first(n), frames);
      for (std::size_t l = 0; l < n; ++l)
        ride(s + l, moving[l], out.subspan(offsets[s + l], offsets[s + l + 1] - offsets[s + l]));
    }
  });
}

}  // namespace pelage
