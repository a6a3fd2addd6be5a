// The head under the hair, and the beginning of every picture. Needs a current OpenGL context for its whole life.
#pragma once

#include <functional>
#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "pelage/data_schema/mesh.h"
#include "pelage/data_schema/scene.h"
#include "pelage/render/gl_objects.h"

namespace pelage {

/// Transmittance of the hair from a light of no size to the head's vertices.
using ShadowFrom = std::function<void(const Light& light, std::span<float> out)>;

/// The same from a light of any size: the mean over places of its disc. [vertices]
std::vector<float> head_shadow(const Light& light, std::size_t vertices, const ShadowFrom& from);

class HeadRenderer {
 public:
  void set_head(const Mesh& head);
  /// Transmittance of the hair at the head's vertices, one component per light.
  void set_shadow(std::span<const glm::vec4> transmittance);

  /// Clears the target to transparent black and draws the head. Leaves the target bound, the depth test on, depth
  /// writes and blending off: hair is to follow.
  void begin_picture(const glm::mat4& world_to_clip, std::span<const Light> lights, Framebuffer& target);

 private:
  Program program_{"head.vert", "head.frag"};
  VertexArray array_;
  Buffer vertices_, indices_, shadow_;
  std::size_t index_count_ = 0;
};

}  // namespace pelage
