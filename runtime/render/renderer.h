// All drawing of a frame: head, layers of hair, blending [Xu2006 eq. 14]. Holds GPU resources only; what to draw comes
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
#include "pelage/image/image.h"
#include "pelage/render/hair_surfaces.h"
#include "pelage/satf/maps.h"

namespace pelage {

class Framebuffer;

/// Most lights of a frame.
inline constexpr std::size_t kMaxLights = 4;

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

  void set_head(const Mesh& head);
  /// Transmittance of the hair at the head's vertices, one component per light.
  void set_head_shadow(std::span<const glm::vec4> transmittance);
  void set_hair(const HairSurfaces& surfaces, const SatfModel& model, std::span<const Cluster> clusters);
  /// [light][texel]
  void set_texels(std::span<const Texel> texels);
  /// plate_views() of the viewer that the texels were built for.
  void set_views(std::span<const glm::vec3> views);
  void set_order(std::span<const std::uint32_t> indices);

  /// Draws head and hair, premultiplied, over transparent black. The target keeps its content elsewhere.
  /// @throws GraphicsError when OpenGL reports an error (out of memory, context lost)
  void draw(const DrawRequest& request, Framebuffer& target);

  /// Mean of supersampling x supersampling samples into `out` at (x0, y0), as far as `out` reaches.
  void read(Framebuffer& target, int supersampling, Image& out, int x0, int y0);

  /// Shows `target`, exposed and over a background, on the window's own framebuffer of the same size.
  void present(Framebuffer& target, float exposure, const glm::vec3& background);

  /// hair_lighting() evaluated on the GPU, for the test of the twins. Inputs [n] each.
  std::vector<glm::vec4> lobes_on_gpu(const HairMaterial& material, std::span<const glm::vec4> t_n_l_v);

 private:
  void draw_head(const DrawRequest& request);
  void draw_hair(const DrawRequest& request, bool lists);
  void draw_exact(const DrawRequest& request, Framebuffer& target);
  struct Resources;
  std::unique_ptr<Resources> gl_;
};

}  // namespace pelage
