// The head under the hair, and the beginning of every picture. Needs a current OpenGL context for its whole life.
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec4.hpp>
#include <span>

#include "pelage/data_schema/mesh.h"
#include "pelage/data_schema/scene.h"
#include "pelage/render/gl_objects.h"

namespace pelage {

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
