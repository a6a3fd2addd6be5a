#include "pelage/render/strand_geometry.h"

#include <algorithm>
#include <array>
#include <bit>
#include <glm/geometric.hpp>
#include <string>
#include <utility>

#include "pelage/data_schema/errors.h"

namespace pelage {
namespace {

/// Unit direction from a to b, or 0 where they are the same in float.
glm::vec3 direction(const glm::vec3& a, const glm::vec3& b) {
  const glm::dvec3 d = glm::dvec3(b) - glm::dvec3(a);
  const double length = glm::length(d);
  return length > 0 ? glm::vec3(d / length) : glm::vec3(0.0F);
}

/// A float's bits as an unsigned number of the same order.
std::uint32_t ordered_bits(float x) noexcept {
  const auto bits = std::bit_cast<std::uint32_t>(x);
  return (bits & 0x80000000U) != 0 ? ~bits : bits | 0x80000000U;
}

}  // namespace

std::vector<StrandSegment> strand_segments(const Strands& strands) {
  if (strands.vertices.size() > StrandSegment::kVertex) {
    throw UsageError("the hair has " + std::to_string(strands.vertices.size()) +
                     " vertices, 2^30 can be drawn: use fewer strands or less smoothing");
  }
  std::vector<StrandSegment> segments;
  segments.reserve(strands.vertices.size());
  for (std::uint32_t s = 0; s < strands.count(); ++s) {
    const std::uint32_t begin = strands.offsets[s], end = strands.offsets[s + 1];
    for (std::uint32_t i = begin; i + 1 < end; ++i) {
      const std::uint32_t flags =
          (i == begin ? StrandSegment::kFirst : 0U) | (i + 2 == end ? StrandSegment::kLast : 0U);
      segments.push_back({i | flags, s});
    }
  }
  return segments;
}

std::vector<glm::vec4> strand_vertices(const Strands& strands) {
  std::vector<glm::vec4> out;
  out.reserve(strands.vertices.size());
  for (std::size_t i = 0; i < strands.vertices.size(); ++i) {
    out.emplace_back(strands.vertices[i], strands.diameters_m.empty() ? strands.diameter_m : strands.diameters_m[i]);
  }
  return out;
}

std::vector<glm::vec4> strand_tangents(const Strands& strands) {
  std::vector<glm::vec4> tangents(strands.vertices.size());
  std::vector<glm::vec3> next;  // direction of the segment after each vertex, or of the nearest one that has any
  for (std::size_t s = 0; s < strands.count(); ++s) {
    const auto points = strands.strand(s);
    next.assign(points.size(), glm::vec3(0.0F));
    glm::vec3 known(0.0F);
    for (std::size_t i = points.size(); i-- > 0;) {
      if (i + 1 < points.size()) {
        const glm::vec3 d = direction(points[i], points[i + 1]);
        if (d != glm::vec3(0.0F)) known = d;
      }
      next[i] = known;
    }
    glm::vec3 before(0.0F);
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (i > 0) {
        const glm::vec3 d = direction(points[i - 1], points[i]);
        if (d != glm::vec3(0.0F)) before = d;
      }
      glm::vec3 sum = before + next[i];
      // A turn back on itself has no half-way.
      if (glm::dot(sum, sum) < 1e-8F) sum = next[i] != glm::vec3(0.0F) ? next[i] : before;
      if (sum == glm::vec3(0.0F)) sum = {0, 1, 0};
      tangents[strands.offsets[s] + i] = glm::vec4(glm::normalize(sum), 0.0F);
    }
  }
  return tangents;
}

void sort_by_depth(std::span<const StrandSegment> segments, std::span<const glm::vec3> vertices, const glm::vec3& eye,
                   const glm::vec3& forward, std::span<StrandSegment> sorted) {
  struct Entry {
    std::uint32_t key, segment;
  };
  constexpr int kBits = 11, kDigits = 3;  // 3 x 11 >= 32
  constexpr std::uint32_t kMask = (1U << kBits) - 1;
  std::vector<Entry> from(segments.size()), to(segments.size());
  std::array<std::array<std::uint32_t, kMask + 1>, kDigits> starts{};
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const std::uint32_t v = segments[i].first();
    const float depth = glm::dot(0.5F * (vertices[v] + vertices[v + 1]) - eye, forward);
    from[i] = {~ordered_bits(depth), static_cast<std::uint32_t>(i)};
    for (int d = 0; d < kDigits; ++d) ++starts[static_cast<std::size_t>(d)][from[i].key >> (kBits * d) & kMask];
  }
  for (auto& digit : starts) {
    std::uint32_t sum = 0;
    for (std::uint32_t& n : digit) n = std::exchange(sum, sum + n);
  }
  for (int d = 0; d < kDigits; ++d) {
    auto& digit = starts[static_cast<std::size_t>(d)];
    for (const Entry& e : from) to[digit[e.key >> (kBits * d) & kMask]++] = e;
    from.swap(to);
  }
  for (std::size_t i = 0; i < sorted.size(); ++i) sorted[i] = segments[from[i].segment];
}

}  // namespace pelage
