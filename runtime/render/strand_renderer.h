// Drawing of strands one by one: head, then ribbons or lines in one of three orders. Holds GPU resources only; what to
// draw comes with each call. Needs a current OpenGL 4.3 context for its whole life.
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <span>

#include "pelage/data_schema/scene.h"
#include "pelage/render/fragment_lists.h"
#include "pelage/render/head_renderer.h"
#include "pelage/render/strand_geometry.h"
#include "pelage/shadow/hair_shadow.h"

namespace pelage {

struct StrandDrawRequest {
  glm::mat4 world_to_clip{1.0F};
  glm::vec3 eye{0.0F};
  float sample_slope = 0;  // width of a sample at 1 m depth [m]
  float nearest_m = 0;     // depth of the nearest hair, for StrandOrder::weighted
  std::span<const Light> lights;
  HairMaterial material;
  StrandSettings settings;  // shape: lines, or else ribbons
  float opacity = kDefaultOpacity;
  PlanarPhong phong;     // for settings.azimuth
  bool shadowed = true;  // off: set_depth_maps() is not looked at either
};

class StrandRenderer {
 public:
  /// @param most_list_bytes  of the exact order's lists; tests make it small
  explicit StrandRenderer(std::size_t most_list_bytes = FragmentLists::kMostListBytes);
  ~StrandRenderer();
  StrandRenderer(const StrandRenderer&) = delete;
  StrandRenderer& operator=(const StrandRenderer&) = delete;

  HeadRenderer& head() noexcept { return head_; }
  /// As strand_vertices() and strand_tangents() give them; `colours` [strands] or empty.
  void set_vertices(std::span<const glm::vec4> vertices, std::span<const glm::vec4> tangents,
                    std::span<const glm::vec3> colours);
  /// Factors on the strands' colours, [strands]; empty: 1.
  void set_tints(std::span<const glm::vec3> tints);
  /// In drawing order.
  void set_segments(std::span<const StrandSegment> segments);
  /// At the vertices, one component per light.
  void set_transmittance(std::span<const glm::vec4> transmittance);
  /// For ShadowAt::fragment, one for each light. @throws GraphicsError when the driver's 3D textures are smaller
  void set_depth_maps(std::span<const DepthTexture> maps);

  /// Draws head and hair, premultiplied, over transparent black.
  /// @throws GraphicsError when OpenGL reports an error, or the exact order does not fit
  void draw(const StrandDrawRequest& request, Framebuffer& target);

 private:
  struct Resources;
  const Program& program(const StrandSettings& settings, bool at_fragment);
  void draw_strands(const StrandDrawRequest& request, const Program& p, const Framebuffer& target);

  HeadRenderer head_;
  std::unique_ptr<Resources> gl_;
};

/// Depth maps as 3D textures for common_depth_map.glsl.
class DepthMaps {
 public:
  DepthMaps() = default;
  ~DepthMaps() { clear(); }
  DepthMaps(const DepthMaps&) = delete;
  DepthMaps& operator=(const DepthMaps&) = delete;

  void upload(std::span<const DepthTexture> maps);
  void bind(const Program& p) const;
  void clear();

 private:
  struct Map {
    GLuint texture;
    glm::mat4 world_to_cell;
    bool transmittance;
    float tap_cells;
  };
  std::vector<Map> maps_;
};

}  // namespace pelage
