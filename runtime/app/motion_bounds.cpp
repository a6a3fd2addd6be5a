#include "pelage/app/motion_bounds.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "pelage/simulate/head_motion.h"

namespace pelage::app {
namespace {

constexpr std::size_t kPoints = 4000;  // of each: enough to frame by
constexpr double kPosesPerSecond = 20;

/// By the golden ratio: a stride would meet the strands' number of vertices, and take roots alone.
void sample(const std::vector<glm::vec3>& points, std::vector<glm::dvec3>& out) {
  if (points.size() <= kPoints) {
    out.insert(out.end(), points.begin(), points.end());
    return;
  }
  for (std::size_t i = 0; i < kPoints; ++i) {
    const double turns = static_cast<double>(i) * 0.6180339887498949;
    out.emplace_back(
        points[static_cast<std::size_t>((turns - std::floor(turns)) * static_cast<double>(points.size()))]);
  }
}

}  // namespace

Bounds motion_bounds(const Strands& lines, const Mesh& head, const MotionSettings& motion, const glm::dvec3& pivot,
                     double seconds) {
  std::vector<glm::dvec3> points;
  sample(lines.vertices, points);
  sample(head.vertices, points);
  Bounds bounds;
  const double last_s = std::min(seconds, motion_length_s(motion));  // then it begins again, or stands still
  for (int k = 0; k <= kPosesPerSecond * last_s; ++k) {
    const RigidPose pose = head_pose(motion, pivot, k / kPosesPerSecond);
    for (const glm::dvec3& p : points) bounds.add(glm::vec3(pose.position + pose.rotation * (p - pivot)));
  }
  return bounds;
}

}  // namespace pelage::app
