// Drawing of a SATF frame: head, layers of hair, blending [Xu2006 eq. 14]. Holds GPU resources only; what to draw comes
// with each call. Needs a current OpenGL 4.3 context for its whole life.
#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <span>
#include <vector>

#include "pelage/data_schema/mesh.h"
#include "pelage/data_schema/scene.h"
#include "pelage/render/hair_surfaces.h"
#include "pelage/render/head_renderer.h"
#include "pelage/render/shader_inputs.h"
#include "pelage/satf/maps.h"

namespace pelage {

struct DrawRequest {
  glm::mat4 world_to_clip{1.0F};
  glm::vec3 eye{0.0F};
  std::span<const Light> lights;  // at most kMaxLights
  HairMaterial material;
  SatfSettings settings;
};

class Renderer {
 public:
  Renderer();
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  HeadRenderer& head() noexcept { return head_; }
  void set_hair(const SatfModel& model, std::span<const Cluster> clusters);
  /// Where the hair's layers are: again when clusters have moved.
  void set_surfaces(const HairSurfaces& surfaces);
  /// [light][texel]
  void set_texels(std::span<const Texel> texels);
  /// plate_views() of the viewer that the texels were built for.
  void set_views(std::span<const glm::vec3> views);
  void set_order(std::span<const std::uint32_t> indices);

  /// Draws head and hair, premultiplied, over transparent black. The target keeps its content elsewhere.
  /// @throws GraphicsError when OpenGL reports an error (out of memory, context lost)
  void draw(const DrawRequest& request, Framebuffer& target);

 private:
  void draw_hair(const DrawRequest& request, bool lists);
  struct Resources;
  HeadRenderer head_;
  std::unique_ptr<Resources> gl_;
};

}  // namespace pelage
