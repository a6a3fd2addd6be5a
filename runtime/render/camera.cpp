#include "pelage/render/camera.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vector_relational.hpp>
#include <iterator>

#include "pelage/data_schema/errors.h"

namespace pelage {
namespace {

using glm::vec3;

constexpr float kMargin = 0.04F;     // of the picture, on each side that the hair touches
constexpr float kStrayReach = 2.0F;  // times what nineteen of twenty strands reach
constexpr float kHeadReach =
    0.12F;  // of the hair's longest side: the head that is this near to the hair's box is framed

/// Middle of the roots, coordinate by coordinate, so that a few that are far away do not move it.
vec3 median_root(const Strands& hair) {
  vec3 middle(0.0F);
  std::vector<float> values(hair.count());
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = hair.strand(i)[0][axis];
    const auto half = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), half, values.end());
    middle[axis] = *half;
  }
  return middle;
}

/// Reach of each strand from a point, squared.
std::vector<float> reaches_sq(const Strands& hair, vec3 from) {
  std::vector<float> reach_sq(hair.count());
  for (std::size_t i = 0; i < reach_sq.size(); ++i) {
    for (const vec3& p : hair.strand(i)) reach_sq[i] = std::max(reach_sq[i], glm::dot(p - from, p - from));
  }
  return reach_sq;
}

/// What a strand may reach, squared, and not be stray.
float longest_reach_sq(std::vector<float> reach_sq) {
  const std::size_t place = reach_sq.size() - 1 - reach_sq.size() / 20;
  std::nth_element(reach_sq.begin(), reach_sq.begin() + static_cast<std::ptrdiff_t>(place), reach_sq.end());
  return kStrayReach * kStrayReach * reach_sq[place];
}

bool is_inside(const Bounds& b, vec3 p) {
  return glm::all(glm::lessThanEqual(b.low, p)) && glm::all(glm::lessThanEqual(p, b.high));
}

/// Where the eye is along one axis of the picture, and how far out. Of a point at `a` on the axis and `c` towards the
/// eye, an eye at (e, d) sees |a - e| <= slope (d - c): the largest a + slope c and the least a - slope c give both.
struct Fit {
  float middle, distance;
};
Fit fit(std::span<const vec3> points, vec3 axis, vec3 from, vec3 origin, float slope) {
  float most = -1e30F, least = 1e30F;
  for (const vec3& p : points) {
    const float a = glm::dot(p - origin, axis), c = slope * glm::dot(p - origin, from);
    most = std::max(most, a + c);
    least = std::min(least, a - c);
  }
  return {0.5F * (most + least), 0.5F * (most - least) / slope};
}

/// How far out the eye stays at least: a lone point, or a strand that points at the eye, would draw it into the hair.
float least_distance(std::span<const vec3> points, vec3 from, vec3 origin, const Bounds& bounds) {
  float nearest = -1e30F;
  for (const vec3& p : points) nearest = std::max(nearest, glm::dot(p - origin, from));
  return nearest + std::max(1e-3F, 0.25F * glm::length(bounds.high - bounds.low));
}

}  // namespace

std::vector<vec3> framed_points(const Strands& hair, const Mesh& head) {
  if (hair.count() == 0) return head.vertices;
  std::vector<vec3> points;
  points.reserve(hair.vertices.size());
  Bounds bounds;
  const std::vector<float> reach_sq = reaches_sq(hair, median_root(hair));
  const float most_sq = longest_reach_sq(reach_sq);
  for (std::size_t i = 0; i < hair.count(); ++i) {
    if (reach_sq[i] > most_sq) continue;
    for (const vec3& p : hair.strand(i)) {
      points.push_back(p);
      bounds.add(p);
    }
  }
  const vec3 size = bounds.high - bounds.low;
  const vec3 room(kHeadReach * std::max({size.x, size.y, size.z}));
  const Bounds near{bounds.low - room, bounds.high + room};
  std::copy_if(head.vertices.begin(), head.vertices.end(), std::back_inserter(points),
               [&](const vec3& p) { return is_inside(near, p); });
  return points;
}

Camera framed_camera(std::span<const vec3> points, float aspect) {
  constexpr vec3 kAnything[] = {vec3(-0.1F), vec3(0.1F)};
  if (points.empty()) points = kAnything;
  Camera camera;
  const vec3 from = glm::normalize(vec3(0.55F, 0.18F, 1.0F));
  const vec3 side = glm::normalize(glm::cross(camera.up, from)), above = glm::cross(from, side);
  Bounds bounds;  // the middle as origin: far from the world's, floats keep their digits
  for (const vec3& p : points) bounds.add(p);
  const vec3 middle = 0.5F * (bounds.low + bounds.high);

  const float slope = (1.0F - 2.0F * kMargin) * std::tan(glm::radians(0.5F * camera.fov_deg));
  const Fit across = fit(points, side, from, middle, slope * aspect), up = fit(points, above, from, middle, slope);
  const float distance = std::max({across.distance, up.distance, least_distance(points, from, middle, bounds)});
  camera.target = middle + across.middle * side + up.middle * above;
  camera.eye = camera.target + distance * from;
  return camera;
}

glm::mat4 world_to_clip(const Camera& camera, const Bounds& bounds, float aspect) {
  const glm::vec3 forward = camera.target - camera.eye;
  const float length = glm::length(forward);
  if (!(length > 0.0F) || !std::isfinite(length)) {
    throw UsageError("camera: eye and target are the same point; give two different ones");
  }
  const bool parallel = glm::length(glm::cross(forward / length, camera.up)) < 1e-4F * glm::length(camera.up);
  const glm::vec3 up = parallel ? glm::vec3(0, 0, forward.y > 0 ? -1 : 1) : camera.up;
  float nearest = 1e30F, farthest = 0.0F;
  for (int i = 0; i < 8; ++i) {
    const glm::vec3 corner{i & 1 ? bounds.high.x : bounds.low.x, i & 2 ? bounds.high.y : bounds.low.y,
                           i & 4 ? bounds.high.z : bounds.low.z};
    const float depth = glm::dot(corner - camera.eye, forward / length);
    nearest = std::min(nearest, depth);
    farthest = std::max(farthest, depth);
  }
  if (bounds.empty()) nearest = 0.5F * length, farthest = 2.0F * length;
  // Inside or behind the hair: the near plane stays in front of the eye and 1/10,000 of the far plane keeps depth
  // precise.
  farthest = std::max(farthest * 1.01F, 1e-3F * length);
  nearest = std::max(nearest * 0.99F, farthest * 1e-4F);
  return glm::perspective(glm::radians(camera.fov_deg), aspect, nearest, farthest) *
         glm::lookAt(camera.eye, camera.target, up);
}

}  // namespace pelage
