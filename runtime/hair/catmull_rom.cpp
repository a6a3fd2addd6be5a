#include "pelage/hair/catmull_rom.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <string>

#include "pelage/data_schema/errors.h"

namespace pelage::hair {
namespace {

constexpr int kMostPieces = 32;

struct Vertex {
  glm::dvec3 at;
  std::size_t index;  // in the strands
};

/// A strand's vertices but those that coincide with the one before.
void distinct_vertices(const Strands& strands, std::size_t s, std::vector<Vertex>& out) {
  constexpr double kEps = static_cast<double>(std::numeric_limits<float>::epsilon());
  out.clear();
  for (std::size_t i = strands.offsets[s]; i < strands.offsets[s + 1]; ++i) {
    const glm::dvec3 p(strands.vertices[i]);
    const double most = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    // Two coordinates that were each rounded to float may differ by an ulp and mean the same.
    if (out.empty() || glm::distance(p, out.back().at) > kEps * most) out.push_back({p, i});
  }
}

/// Derivative at b over the knots of (b, c), times their interval.
glm::dvec3 tangent(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, double before, double interval) {
  return interval * ((b - a) / before - (c - a) / (before + interval)) + (c - b);
}

class Smoother {
 public:
  Smoother(const Strands& from, int pieces) : from_(from), pieces_(pieces) {}

  Strands run() {
    to_.colours = from_.colours;
    to_.diameter_m = from_.diameter_m;
    for (std::size_t s = 0; s < from_.count(); ++s) {
      distinct_vertices(from_, s, points_);
      if (!points_.empty()) add(points_.front());
      for (std::size_t i = 0; i + 1 < points_.size(); ++i) add_segment(i);
      if (to_.vertices.size() > std::numeric_limits<std::uint32_t>::max()) {
        throw UsageError("smoothing: " + std::to_string(pieces_) +
                         " pieces make more than 2^32 - 1 vertices; take fewer");
      }
      to_.offsets.push_back(static_cast<std::uint32_t>(to_.vertices.size()));
    }
    return std::move(to_);
  }

 private:
  void add(const Vertex& v) {
    to_.vertices.push_back(from_.vertices[v.index]);
    if (!from_.diameters_m.empty()) to_.diameters_m.push_back(from_.diameters_m[v.index]);
  }

  /// What lies between vertices i and i + 1, and the latter: a cubic Hermite curve.
  void add_segment(std::size_t i) {
    const Vertex &v1 = points_[i], &v2 = points_[i + 1];
    const glm::dvec3 &p1 = v1.at, &p2 = v2.at;
    const glm::dvec3 p0 = i > 0 ? points_[i - 1].at : 2.0 * p1 - p2;
    const glm::dvec3 p3 = i + 2 < points_.size() ? points_[i + 2].at : 2.0 * p2 - p1;
    const double k0 = std::sqrt(glm::distance(p0, p1)), k1 = std::sqrt(glm::distance(p1, p2)),
                 k2 = std::sqrt(glm::distance(p2, p3));
    const glm::dvec3 m1 = tangent(p0, p1, p2, k0, k1), m2 = -tangent(p3, p2, p1, k2, k1);
    for (int k = 1; k < pieces_; ++k) {
      const double u = static_cast<double>(k) / pieces_, w = 1.0 - u;
      const glm::dvec3 p = w * w * ((1.0 + 2.0 * u) * p1 + u * m1) + u * u * ((1.0 + 2.0 * w) * p2 - w * m2);
      to_.vertices.emplace_back(p);
      if (from_.diameters_m.empty()) continue;
      to_.diameters_m.push_back(
          glm::mix(from_.diameters_m[v1.index], from_.diameters_m[v2.index], static_cast<float>(u)));
    }
    add(v2);
  }

  const Strands& from_;
  int pieces_;
  Strands to_;
  std::vector<Vertex> points_;
};

}  // namespace

Strands smooth(const Strands& strands, int pieces) {
  if (pieces < 1 || pieces > kMostPieces) {
    throw UsageError("smoothing: " + std::to_string(pieces) + " pieces are outside [1, " + std::to_string(kMostPieces) +
                     "]");
  }
  return pieces == 1 ? strands : Smoother(strands, pieces).run();
}

}  // namespace pelage::hair
