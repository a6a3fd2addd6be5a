// Strands in the coordinates of a centre line: for each vertex the t whose plate plane holds it, and where in that
// plane. A strand's vertices are followed from the root, each from the t of the one before, so that a vertex near two
// parts of a bent line stays on its own. Before the root and beyond the tip the line goes on straight (t < 0, t > 1).
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "pelage/data_schema/cluster.h"

namespace pelage::hair {

/// Vertex `vertex` of a strand lies in the plane of t, at (normal, binormal) coordinates `plane_m`.
struct PlanePoint {
  double t;
  glm::dvec2 plane_m;
  std::uint32_t vertex;
};

class Projector {
 public:
  explicit Projector(const CentreLine& line);

  /// All vertices, in order.
  std::vector<PlanePoint> project(std::span<const glm::vec3> strand) const;

 private:
  struct Plane {
    glm::dvec3 position, tangent;
    double behind(const glm::dvec3& p) const noexcept;  // signed distance of p along the tangent [m]
  };
  std::size_t first_slab(const glm::dvec3& p) const noexcept;
  std::size_t walk(std::size_t slab, const glm::dvec3& p) const noexcept;
  PlanePoint locate(std::size_t slab, const glm::dvec3& p) const noexcept;

  const CentreLine& line_;
  std::vector<Plane>
      planes_;  // slab i lies between planes i - 1 and i; slab 0 before the root, the last beyond the tip
};

/// The part of a projected strand along which t increases strictly (also as float): its longest increasing run,
/// measured along the strand, and from there outwards the vertices that go on increasing. The others turn back and are
/// left out.
std::vector<PlanePoint> increasing_part(std::span<const PlanePoint> points, std::span<const glm::vec3> strand);

}  // namespace pelage::hair
