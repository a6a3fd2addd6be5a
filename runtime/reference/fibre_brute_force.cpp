#include "pelage/reference/fibre_brute_force.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <optional>

namespace pelage {
namespace {

/// A strand's vertices as the ray sees them: x, y across it, z along it from its origin; without repeated ones.
struct Seen {
  std::vector<glm::dvec3> at;
  std::vector<double> radius;
  std::vector<std::size_t> vertex;  // of Strands
};

glm::dmat3 frame(const glm::dvec3& z) {
  const glm::dvec3 helper = std::abs(z.z) < 0.7 ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
  const glm::dvec3 x = glm::normalize(glm::cross(helper, z)), y = glm::cross(z, x);
  return glm::transpose(glm::dmat3(x, y, z));
}

Seen see(const Strands& strands, std::size_t strand, const FibreRay& ray) {
  const glm::dmat3 turn = frame(ray.direction);
  const float all = strands.diameter_m > 0 ? strands.diameter_m : default_diameter_m(strands.count());
  Seen seen;
  for (std::size_t i = strands.offsets[strand]; i < strands.offsets[strand + 1]; ++i) {
    if (!seen.at.empty() && strands.vertices[i] == strands.vertices[seen.vertex.back()]) continue;
    seen.at.push_back(turn * (glm::dvec3(strands.vertices[i]) - ray.origin));
    seen.radius.push_back(0.5 * static_cast<double>(strands.diameters_m.empty() ? all : strands.diameters_m[i]));
    seen.vertex.push_back(i);
  }
  return seen;
}

/// Depth and half chord where the ray, the line x = y = 0, meets segment i.
struct Meeting {
  double depth, half_chord;
};
std::optional<Meeting> meet(const Seen& s, std::size_t i, double length) {
  const glm::dvec3 a = s.at[i], b = s.at[i + 1];
  const glm::dvec2 a2(a), b2(b);
  const double seen_length = glm::distance(a2, b2), segment_length = glm::distance(a, b);
  // Distance along the axis as the ray sees it, from a; and from the axis.
  const glm::dvec2 axis = seen_length > 0 ? (b2 - a2) / seen_length : glm::dvec2(0);
  const double along = -glm::dot(a2, axis);
  double share = 0, off = glm::length(a2);
  if (along >= seen_length && seen_length > 0) {
    if (i + 2 == s.at.size() && along > seen_length) return std::nullopt;
    share = 1, off = glm::length(b2);
  } else if (along > 0) {
    share = along / seen_length, off = std::abs(a2.x * axis.y - a2.y * axis.x);
  } else if (i == 0 && along < 0) {
    return std::nullopt;
  }
  const double radius = (1 - share) * s.radius[i] + share * s.radius[i + 1];
  const double depth = (1 - share) * a.z + share * b.z;
  if (off >= radius || depth <= 0 || depth >= length) return std::nullopt;
  return Meeting{depth, radius * segment_length / seen_length};
}

/// The owner's segment: the one that starts at the vertex, or, at the end of a strand, ends there.
std::size_t segment_at(const Seen& s, std::size_t vertex) {
  std::size_t i = 0;
  while (i + 2 < s.at.size() && s.vertex[i + 1] <= vertex) ++i;
  return i;
}

}  // namespace

std::vector<double> brute_force_crossings(const Strands& strands, const FibreRay& ray, std::uint32_t owner) {
  std::vector<double> depths;
  for (std::size_t strand = 0; strand < strands.count(); ++strand) {
    const Seen seen = see(strands, strand, ray);
    const bool owned = owner >= strands.offsets[strand] && owner < strands.offsets[strand + 1];
    const std::size_t own = owned ? segment_at(seen, owner) : 0;
    std::optional<Meeting> before;
    for (std::size_t i = 0; i + 1 < seen.at.size(); ++i) {
      const bool skip = owned && i + 1 >= own && i <= own + 1;
      const std::optional<Meeting> here = skip ? std::nullopt : meet(seen, i, ray.length_m);
      const bool same =
          here && before && std::abs(here->depth - before->depth) <= here->half_chord + before->half_chord;
      if (here && !same) depths.push_back(here->depth);
      before = here;
    }
  }
  std::sort(depths.begin(), depths.end());
  return depths;
}

}  // namespace pelage
