#include "pelage/app/motion_bounds.h"

#include <algorithm>
#include <vector>

#include "pelage/simulate/head_motion.h"

namespace pelage::app {
namespace {

constexpr std::size_t kPoints = 1000;  // of each, spread evenly: enough to frame by
constexpr double kPosesPerSecond = 20;

void sample(const std::vector<glm::vec3>& points, std::vector<glm::dvec3>& out) {
  const std::size_t stride = std::max<std::size_t>(1, points.size() / kPoints);
  for (std::size_t i = 0; i < points.size(); i += stride) out.emplace_back(points[i]);
}

}  // namespace

Bounds motion_bounds(const Strands& lines, const Mesh& head, const MotionSettings& motion, const glm::dvec3& pivot,
                     double seconds) {
  std::vector<glm::dvec3> points;
  sample(lines.vertices, points);
  sample(head.vertices, points);
  Bounds bounds;
  for (int k = 0; k <= kPosesPerSecond * seconds; ++k) {
    const RigidPose pose = head_pose(motion, pivot, k / kPosesPerSecond);
    for (const glm::dvec3& p : points) bounds.add(glm::vec3(pose.position + pose.rotation * (p - pivot)));
  }
  return bounds;
}

}  // namespace pelage::app
