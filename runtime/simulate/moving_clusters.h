// Clusters that follow the simulation: their control polygons are simulated as hair is (centre lines, their detail),
// and the clusters are put where the polygons have come to. Cross-sections and density field stay, so that the SATF
// renders moving hair without a new database [Xu2006 Fig. 8; SatfFrame::move_hair].
#pragma once

#include <glm/ext/quaternion_double.hpp>
#include <glm/ext/quaternion_float.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "pelage/data_schema/hairstyle.h"
#include "pelage/data_schema/strands.h"

namespace pelage {

class MovingClusters {
 public:
  /// The hairstyle at rest. Instances of a cluster move each its own way: they become clusters without transforms
  /// (rotation, translation, uniform scale; the mean scale counts).
  explicit MovingClusters(Hairstyle style);

  /// Control polygons at rest, one for each cluster, root first: the hair to be simulated.
  const Strands& lines() const noexcept { return lines_; }
  /// Clusters on moved polygons. The frame at the root turns with the head and then as little as the polygon's first
  /// direction asks for.
  /// @param moved  laid out as lines()   @param turn  rotation of the head since rest
  void move(const Strands& moved, const glm::dquat& turn);
  /// The hairstyle as it is now.
  const Hairstyle& style() const noexcept { return style_; }

 private:
  Hairstyle style_;
  Strands lines_;
  std::vector<glm::quat> first_;            // [cluster] frame of the polygon's root at rest
  std::vector<glm::vec3> normal_in_frame_;  // [cluster]
};

}  // namespace pelage
