#include "pelage/simulate/moving_clusters.h"

#include <algorithm>
#include <cmath>
#include <glm/ext/quaternion_common.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <utility>

#include "pelage/data_schema/errors.h"
#include "pelage/simulate/rotation_frames.h"

namespace pelage {
namespace {

/// One instance as a cluster of its own.
Cluster placed(const Cluster& cluster, const glm::mat4& m) {
  const glm::mat3 linear{m};
  const float scale = std::cbrt(std::abs(glm::determinant(linear)));
  Cluster out = cluster;
  out.transforms.clear();
  for (glm::vec3& p : out.centre_line) p = glm::vec3(m * glm::vec4(p, 1.0F));
  for (CrossSection& s : out.cross_sections) s = {s.xx * scale, s.xy * scale, s.yy * scale};
  out.first_normal = linear * cluster.first_normal;
  return out;
}

std::vector<Cluster> separated(std::vector<Cluster> clusters) {
  std::vector<Cluster> out;
  for (Cluster& c : clusters) {
    for (const glm::mat4& m : c.transforms) out.push_back(placed(c, m));
    if (c.transforms.empty()) out.push_back(std::move(c));
  }
  return out;
}

}  // namespace

MovingClusters::MovingClusters(Hairstyle style) : style_(std::move(style)) {
  style_.clusters = separated(std::move(style_.clusters));
  lines_.diameter_m = style_.diameter_m;
  for (const Cluster& c : style_.clusters) {
    lines_.append(c.centre_line);
    first_.push_back(first_frame(c.centre_line));
    normal_in_frame_.push_back(turned(glm::conjugate(first_.back()), c.first_normal));
  }
}

void MovingClusters::move(const Strands& moved, const glm::dquat& turn) {
  PELAGE_ASSERT(moved.offsets == lines_.offsets);
  const glm::quat turn_f(turn);
  for (std::size_t c = 0; c < first_.size(); ++c) {
    const std::span<const glm::vec3> line = moved.strand(c);
    const glm::quat rest = turn_f * first_[c];
    const glm::quat now = carried_to(rest, first_direction(line, frame_tangent(rest)));
    std::copy(line.begin(), line.end(), style_.clusters[c].centre_line.begin());
    style_.clusters[c].first_normal = turned(now, normal_in_frame_[c]);
  }
}

}  // namespace pelage
