// Where pictures go: to memory, in tiles that bound the memory of a frame whatever its size, or to a window.
#pragma once

#include <functional>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <memory>

#include "pelage/data_schema/scene.h"
#include "pelage/data_schema/stages.h"
#include "pelage/image/image.h"
#include "pelage/render/gl_objects.h"

namespace pelage {

/// Side of a tile in samples.
inline constexpr int kTileSamples = 2048;

/// Told how many tiles of a picture are drawn.
using TilesDone = std::function<void(int done, int total)>;

struct PictureSize {
  int width, height;  // pixels
  int supersampling = 1;
  int tile_samples = kTileSamples;

  float aspect() const noexcept { return static_cast<float>(width) / static_cast<float>(height); }
};

/// How a window shows what was drawn; files: image/tone.h.
struct Presentation {
  float exposure = 1.0F;
  glm::vec3 background{0.0F};  // linear RGB
  Backdrop backdrop = Backdrop::plain;
};

class PictureOutput {
 public:
  /// Draws the part of the picture that `part` maps to the whole of clip space.
  using Draw = std::function<void(const glm::mat4& part, Framebuffer& target)>;

  /// @param format  of the targets: GL_RGBA16F or GL_RGBA32F
  explicit PictureOutput(GLenum format) : format_(format) {}

  /// Stages "draw" and "read", once for each tile. Linear, premultiplied.
  /// @param told  before the first tile and after each; may throw to interrupt
  Image render(const PictureSize& size, StageLedger& ledger, const Draw& draw, const TilesDone& told = {});
  /// Stage "draw"; exposed and over a background on the window's own framebuffer of this size.
  void show(const PictureSize& size, const Presentation& as, StageLedger& ledger, const Draw& draw);

  /// Mean of supersampling x supersampling samples into `out` at (x0, y0), as far as `out` reaches.
  void read(Framebuffer& target, int supersampling, Image& out, int x0, int y0);

 private:
  void present(Framebuffer& target, const Presentation& as);

  GLenum format_;
  Program downsample_{"screen.vert", "downsample.frag"};
  Program present_{"screen.vert", "present.frag"};
  VertexArray array_;
  std::unique_ptr<Framebuffer> window_target_;
};

}  // namespace pelage
