#include "pelage/simulate/strand_blocks.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>
#include <span>
#include <string>

#include "pelage/data_schema/errors.h"

namespace pelage {
namespace {

constexpr float kMortonCells = 1023;

std::uint32_t spread_bits(std::uint32_t x) noexcept {
  x = (x | (x << 16)) & 0x030000FFU;
  x = (x | (x << 8)) & 0x0300F00FU;
  x = (x | (x << 4)) & 0x030C30C3U;
  return (x | (x << 2)) & 0x09249249U;
}

/// Place on a curve that visits near points one after the other: Morton's, 10 bits per axis.
std::vector<std::uint32_t> morton_codes(const Strands& lines) {
  glm::vec3 low(INFINITY), high(-INFINITY);
  for (std::size_t s = 0; s < lines.count(); ++s) {
    low = glm::min(low, lines.strand(s)[0]);
    high = glm::max(high, lines.strand(s)[0]);
  }
  const glm::vec3 size = high - low;
  const float scale = kMortonCells / std::max({size.x, size.y, size.z, 1e-9F});  // one for all: near is near
  std::vector<std::uint32_t> codes(lines.count());
  for (std::size_t s = 0; s < codes.size(); ++s) {
    const glm::vec3 cell = (lines.strand(s)[0] - low) * scale;
    for (int a = 0; a < 3; ++a) codes[s] |= spread_bits(static_cast<std::uint32_t>(cell[a])) << a;
  }
  return codes;
}

/// Strands of like length next to each other, among those neighbours on the head.
std::vector<std::uint32_t> order_of(const Strands& lines) {
  const std::vector<std::uint32_t> codes = morton_codes(lines);
  std::vector<std::uint32_t> order(lines.count());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const std::size_t na = lines.strand(a).size(), nb = lines.strand(b).size();
    if (na != nb) return na > nb;
    return codes[a] != codes[b] ? codes[a] < codes[b] : a < b;
  });
  return order;
}

void check(const Strands& lines) {
  for (std::size_t s = 0; s < lines.count(); ++s) {
    if (lines.strand(s).empty()) throw InputError("strand " + std::to_string(s), "has no vertices: leave it out");
    for (const glm::vec3& p : lines.strand(s))
      if (!std::isfinite(p.x + p.y + p.z)) throw InputError("strand " + std::to_string(s), "a vertex is not finite");
  }
}

void put(Lanes3& lanes, std::size_t lane, const glm::vec3& p) noexcept {
  lanes.x[lane] = p.x;
  lanes.y[lane] = p.y;
  lanes.z[lane] = p.z;
}

glm::vec3 get(const Lanes3& lanes, std::size_t lane) noexcept {
  return {lanes.x[lane], lanes.y[lane], lanes.z[lane]};
}

void fill_lane(StrandBlocks& blocks, std::size_t block, std::size_t lane, std::span<const glm::vec3> line,
               const glm::dvec3& pivot) {
  put(blocks.root_rest[block], lane, glm::vec3(glm::dvec3(line[0]) - pivot));
  double length = 0;
  for (std::size_t i = 1; i < line.size(); ++i) length += glm::distance(glm::dvec3(line[i - 1]), glm::dvec3(line[i]));
  blocks.vertices[block].v[lane] = static_cast<float>(line.size());
  if (line.size() > 1)
    blocks.segment_m[block].v[lane] = static_cast<float>(length / static_cast<double>(line.size() - 1));
  for (std::uint32_t i = 0; i < blocks.length(block); ++i) {
    const glm::vec3 p = line[std::min<std::size_t>(i, line.size() - 1)];
    put(blocks.rest[blocks.first[block] + i], lane, p - line[0]);
  }
}

}  // namespace

StrandBlocks make_blocks(const Strands& lines, const glm::dvec3& pivot) {
  check(lines);
  const std::vector<std::uint32_t> order = order_of(lines);
  StrandBlocks blocks;
  blocks.strands = order.size();
  blocks.block_of.resize(order.size());
  const std::size_t count = (order.size() + kLanes - 1) / kLanes;
  for (std::size_t b = 0; b < count; ++b) {
    const auto longest = static_cast<std::uint32_t>(lines.strand(order[b * kLanes]).size());
    blocks.first.push_back(blocks.first.back() + longest);
  }
  blocks.strand_of.assign(count * kLanes, StrandBlocks::kNoStrand);
  blocks.vertices.assign(count, Lanes{});
  blocks.segment_m.assign(count, Lanes{});
  blocks.root_rest.assign(count, Lanes3{});
  blocks.rest.assign(blocks.first.back(), Lanes3{});
  for (std::size_t k = 0; k < order.size(); ++k) {
    blocks.strand_of[k] = order[k];
    blocks.block_of[order[k]] = static_cast<std::uint32_t>(k);
    fill_lane(blocks, k / kLanes, k % kLanes, lines.strand(order[k]), pivot);
  }
  blocks.root = blocks.root_rest;
  blocks.position = blocks.rest;
  blocks.velocity.assign(blocks.first.back(), Lanes3{});
  blocks.impulse.assign(blocks.first.back(), Lanes3{});
  return blocks;
}

void world_positions(const StrandBlocks& blocks, const glm::dvec3& pivot, Strands& out) {
  for (std::size_t s = 0; s < blocks.strands; ++s) {
    const std::size_t block = blocks.block_of[s] / kLanes, lane = blocks.block_of[s] % kLanes;
    const glm::dvec3 root = pivot + glm::dvec3(get(blocks.root[block], lane));
    for (std::uint32_t i = 0, v = out.offsets[s]; v < out.offsets[s + 1]; ++i, ++v)
      out.vertices[v] = glm::vec3(root + glm::dvec3(get(blocks.position[blocks.first[block] + i], lane)));
  }
}

}  // namespace pelage
