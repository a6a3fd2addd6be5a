#include "pelage/reference/fibre_curves.h"

#include <string>

#include "pelage/data_schema/errors.h"

namespace pelage {
namespace {

bool finite(const glm::vec3& v) noexcept {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Diameter of a vertex. @throws InputError
float diameter_at(const Strands& strands, std::size_t strand, std::size_t i) {
  const float all = strands.diameter_m > 0 ? strands.diameter_m : default_diameter_m(strands.count());
  const float d = strands.diameters_m.empty() ? all : strands.diameters_m[i];
  const glm::vec3 p = strands.vertices[i];
  if (finite(p) && std::isfinite(d) && d >= 0) return d;
  throw InputError("strand " + std::to_string(strand) + ", vertex " + std::to_string(i - strands.offsets[strand]),
                   "position (" + std::to_string(p.x) + ", " + std::to_string(p.y) + ", " + std::to_string(p.z) +
                       ") m, diameter " + std::to_string(d) + " m: both must be finite, and the diameter not below 0");
}

}  // namespace

/// Keeps vertices that differ from the one before, and strands of at least two.
void FibreCurves::take(const Strands& strands) {
  points.reserve(strands.vertices.size() + 1);
  segment_of.assign(strands.vertices.size(), kNoSegment);
  for (std::size_t s = 0; s < strands.count(); ++s) {
    const std::size_t begin = strands.offsets[s], end = strands.offsets[s + 1], before = first.size();
    std::size_t waiting = begin;  // vertices from here on belong to the next segment
    for (std::size_t i = begin; i < end; ++i) {
      const glm::vec4 point(strands.vertices[i], 0.5F * diameter_at(strands, s, i));
      if (i > begin && glm::vec3(points.back()) == glm::vec3(point)) continue;
      points.push_back(point);
      if (i == begin) continue;
      for (; waiting < i; ++waiting) segment_of[waiting] = static_cast<std::uint32_t>(first.size());
      vertex_of.push_back(static_cast<std::uint32_t>(i - 1));
      first.push_back(static_cast<std::uint32_t>(points.size() - 2));
    }
    if (first.size() == before) {
      if (end > begin) points.pop_back();
      continue;
    }
    for (; waiting < end; ++waiting) segment_of[waiting] = static_cast<std::uint32_t>(first.size() - 1);
  }
}

void FibreCurves::note_starts() {
  starts_.resize(first.size() / 64 + 1);
  std::uint32_t strands = 0;
  for (std::uint32_t i = 0; i < size(); ++i) {
    Starts& s = starts_[i / 64];
    if (i % 64 == 0) s.before = strands;
    if (i > 0 && first[i - 1] + 1 == first[i]) continue;
    s.here |= std::uint64_t{1} << (i % 64);
    ++strands;
  }
}

/// Radii as Embree gets them.
void FibreCurves::widen() {
  for (const std::uint32_t i : first) {
    for (const std::uint32_t p : {i, i + 1}) {
      box.add(glm::dvec3(points[p]), static_cast<double>(points[p].w));
      greatest_radius = std::max(greatest_radius, static_cast<double>(points[p].w));
    }
  }
  if (first.empty()) return;
  const glm::dvec3 farthest = glm::max(glm::abs(box.low), glm::abs(box.high));
  // As float: then a radius of 0 comes back as 0.
  least_widening =
      static_cast<double>(static_cast<float>(kRounding * (glm::length(box.high - box.low) + glm::length(farthest))));
  for (glm::vec4& p : points) p.w = static_cast<float>(kWiden * static_cast<double>(p.w) + least_widening);
  points.emplace_back(0.0F);
}

FibreCurves::FibreCurves(const Strands& strands) {
  take(strands);
  note_starts();
  widen();
}

}  // namespace pelage
