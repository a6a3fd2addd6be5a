#include "pelage/app/framing.h"

#include <algorithm>
#include <cmath>

#include "pelage/app/prepare.h"
#include "pelage/render/camera.h"
#include "pelage/simulate/head_motion.h"

namespace pelage::app {
namespace {

constexpr std::size_t kPoints = 8000;  // of hair and head: enough to frame by
constexpr double kPosesPerSecond = 20;

/// By the golden ratio: a stride would meet the strands' number of vertices, and take roots alone.
std::vector<glm::vec3> sample(std::vector<glm::vec3> points) {
  if (points.size() <= kPoints) return points;
  std::vector<glm::vec3> some(kPoints);
  for (std::size_t i = 0; i < kPoints; ++i) {
    const double turns = static_cast<double>(i) * 0.6180339887498949;
    some[i] = points[static_cast<std::size_t>((turns - std::floor(turns)) * static_cast<double>(points.size()))];
  }
  return some;
}

}  // namespace

float aspect_of(const ImageSettings& image) noexcept {
  return static_cast<float>(image.width) / static_cast<float>(image.height);
}

Camera camera_of(const Scene& scene, const Strands& hair, const Mesh& head) {
  return scene.camera ? *scene.camera : framed_camera(framed_points(hair, head), aspect_of(scene.image));
}

Camera camera_of(const Scene& scene, const Drawing& drawing) {
  if (scene.camera) return *scene.camera;
  const bool strands = scene.method != Method::satf;
  return camera_of(scene, strands ? drawing.lines() : prepare_strands(scene).strands, drawing.head());
}

std::vector<glm::vec3> carried_points(const Strands& hair, const Mesh& head, const MotionSettings& motion,
                                      const glm::dvec3& pivot, double seconds) {
  const std::vector<glm::vec3> points = sample(framed_points(hair, head));
  std::vector<glm::vec3> carried;
  const double last_s = std::min(seconds, motion_length_s(motion));  // then it begins again, or stands still
  for (int k = 0; k <= kPosesPerSecond * last_s; ++k) {
    const RigidPose pose = head_pose(motion, pivot, k / kPosesPerSecond);
    for (const glm::vec3& p : points) carried.emplace_back(pose.position + pose.rotation * (glm::dvec3(p) - pivot));
  }
  return carried;
}

}  // namespace pelage::app
