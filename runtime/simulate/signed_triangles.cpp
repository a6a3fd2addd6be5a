#include "pelage/simulate/signed_triangles.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>
#include <string>
#include <tuple>

#include "pelage/data_schema/errors.h"

namespace pelage {
namespace {

using glm::dvec3;

constexpr double kFlat = 1e-12;      // area / longest edge squared below which a triangle has no normal
constexpr double kSolidShare = 0.2;  // of the bounding box; a sphere has 0.52, a single triangle at most 0.09

enum Feature { kCorner0, kCorner1, kCorner2, kEdge0, kEdge1, kEdge2, kFace };  // edge k: from corner k to k + 1

struct Foot {
  dvec3 point;
  Feature feature;
};

/// Nearest point of a triangle, by the Voronoi regions of its corners and edges [Ericson2004 section 5.1.5].
Foot foot(const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& p) noexcept {
  const dvec3 ab = b - a, ac = c - a, ap = p - a;
  const double ab_ap = glm::dot(ab, ap), ac_ap = glm::dot(ac, ap);
  if (ab_ap <= 0 && ac_ap <= 0) return {a, kCorner0};

  const dvec3 bp = p - b;
  const double ab_bp = glm::dot(ab, bp), ac_bp = glm::dot(ac, bp);
  if (ab_bp >= 0 && ac_bp <= ab_bp) return {b, kCorner1};

  const double vc = ab_ap * ac_bp - ab_bp * ac_ap;
  if (vc <= 0 && ab_ap >= 0 && ab_bp <= 0) return {a + ab_ap / (ab_ap - ab_bp) * ab, kEdge0};

  const dvec3 cp = p - c;
  const double ab_cp = glm::dot(ab, cp), ac_cp = glm::dot(ac, cp);
  if (ac_cp >= 0 && ab_cp <= ac_cp) return {c, kCorner2};

  const double vb = ab_cp * ac_ap - ab_ap * ac_cp;
  if (vb <= 0 && ac_ap >= 0 && ac_cp <= 0) return {a + ac_ap / (ac_ap - ac_cp) * ac, kEdge2};

  const double va = ab_bp * ac_cp - ab_cp * ac_bp, towards_c = ac_bp - ab_bp, towards_b = ab_cp - ac_cp;
  if (va <= 0 && towards_c >= 0 && towards_b >= 0) return {b + towards_c / (towards_c + towards_b) * (c - b), kEdge1};

  const double sum = va + vb + vc;
  return {a + vb / sum * ab + vc / sum * ac, kFace};
}

double angle_at(const dvec3& p, const dvec3& a, const dvec3& b) noexcept {
  return std::atan2(glm::length(glm::cross(a - p, b - p)), glm::dot(a - p, b - p));
}

void check(const Mesh& mesh) {
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const glm::vec3& p = mesh.vertices[v];
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      throw InputError("mesh", "vertex " + std::to_string(v) + " is not finite: export it again");
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k)
      if (mesh.triangles[t][k] >= mesh.vertices.size())
        throw InputError("mesh", "triangle " + std::to_string(t) + " names vertex " +
                                     std::to_string(mesh.triangles[t][k]) + ", there are " +
                                     std::to_string(mesh.vertices.size()) + ": export it again");
}

/// [vertex] the first vertex at the same place.
std::vector<std::uint32_t> first_at_place(const std::vector<glm::vec3>& vertices) {
  std::vector<std::uint32_t> order(vertices.size()), first(vertices.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto key = [&](std::uint32_t v) {
    return std::tie(vertices[v].x, vertices[v].y, vertices[v].z);  // -0 == +0
  };
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return key(a) != key(b) ? key(a) < key(b) : a < b; });
  for (std::size_t k = 0; k < order.size(); ++k)
    first[order[k]] = k > 0 && key(order[k - 1]) == key(order[k]) ? first[order[k - 1]] : order[k];
  return first;
}

}  // namespace

SignedTriangles::SignedTriangles(const Mesh& mesh) {
  check(mesh);
  weld(mesh);
  turn_outwards();
  find_normals();
}

void SignedTriangles::weld(const Mesh& mesh) {
  const std::vector<std::uint32_t> first = first_at_place(mesh.vertices);
  vertices_.assign(mesh.vertices.begin(), mesh.vertices.end());
  for (const glm::uvec3& t : mesh.triangles) {
    const std::array<std::uint32_t, 3> c{first[t.x], first[t.y], first[t.z]};
    const dvec3 ab = vertices_[c[1]] - vertices_[c[0]], ac = vertices_[c[2]] - vertices_[c[0]];
    const double longest_sq = std::max({glm::dot(ab, ab), glm::dot(ac, ac), glm::dot(ac - ab, ac - ab)});
    if (glm::length(glm::cross(ab, ac)) > kFlat * longest_sq) corners_.push_back(c);
  }
}

void SignedTriangles::turn_outwards() {
  dvec3 low(static_cast<double>(INFINITY)), high(-low);
  for (std::size_t t = 0; t < size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) low = glm::min(low, corner(t, k)), high = glm::max(high, corner(t, k));
  const dvec3 centre = 0.5 * (low + high), extent = high - low;
  double volume = 0;  // of the cone over the triangles from the centre
  for (std::size_t t = 0; t < size(); ++t)
    volume += glm::dot(corner(t, 0) - centre, glm::cross(corner(t, 1) - centre, corner(t, 2) - centre)) / 6;
  if (volume >= -kSolidShare * extent.x * extent.y * extent.z) return;
  for (auto& c : corners_) std::swap(c[1], c[2]);
}

void SignedTriangles::find_normals() {
  struct Edge {
    std::uint32_t from, to, triangle, k;  // from < to
  };
  std::vector<Edge> edges;
  vertex_normals_.assign(vertices_.size(), dvec3(0));
  edge_normals_.resize(size());
  for (std::uint32_t t = 0; t < size(); ++t) {
    const dvec3 a = corner(t, 0), b = corner(t, 1), c = corner(t, 2);
    face_normals_.push_back(glm::normalize(glm::cross(b - a, c - a)));
    vertex_normals_[corners_[t][0]] += angle_at(a, b, c) * face_normals_[t];
    vertex_normals_[corners_[t][1]] += angle_at(b, c, a) * face_normals_[t];
    vertex_normals_[corners_[t][2]] += angle_at(c, a, b) * face_normals_[t];
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t from = corners_[t][k], to = corners_[t][(k + 1) % 3];
      edges.push_back({std::min(from, to), std::max(from, to), t, k});
    }
  }
  const auto place = [](const Edge& e) { return std::tie(e.from, e.to, e.triangle, e.k); };
  std::sort(edges.begin(), edges.end(), [&](const Edge& a, const Edge& b) { return place(a) < place(b); });
  for (std::size_t begin = 0, end; begin < edges.size(); begin = end) {
    dvec3 sum(0);
    for (end = begin; end < edges.size() && edges[end].from == edges[begin].from && edges[end].to == edges[begin].to;
         ++end)
      sum += face_normals_[edges[end].triangle];
    for (std::size_t e = begin; e < end; ++e) edge_normals_[edges[e].triangle][edges[e].k] = sum;
  }
}

double SignedTriangles::distance(std::size_t t, const dvec3& p) const noexcept {
  return glm::distance(p, foot(corner(t, 0), corner(t, 1), corner(t, 2), p).point);
}

bool SignedTriangles::inside(std::size_t t, const dvec3& p) const noexcept {
  const Foot nearest = foot(corner(t, 0), corner(t, 1), corner(t, 2), p);
  const auto k = static_cast<std::size_t>(nearest.feature);
  const dvec3& normal = k < 3 ? vertex_normals_[corners_[t][k]] : k < 6 ? edge_normals_[t][k - 3] : face_normals_[t];
  return glm::dot(p - nearest.point, normal) < 0;
}

}  // namespace pelage
