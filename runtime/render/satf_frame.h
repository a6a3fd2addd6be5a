// SatfFrame: a hairstyle rendered with the SATF, frame after frame. Runs only the stages whose inputs changed:
//   sectors, index             what is in the clusters (once)
//   surfaces                   where they are
//   shadow map, s-maps         where they are, or light; neither where no shadow is asked for
//   head shadow                the same; a light of some size has a map for each of several places
//   maps, upload               where they are, view or light
//   order                      where they are, or view
//   head, draw, read           every frame
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "pelage/data_schema/mesh.h"
#include "pelage/data_schema/stages.h"
#include "pelage/db/record_source.h"
#include "pelage/image/image.h"
#include "pelage/render/camera.h"
#include "pelage/render/picture_output.h"
#include "pelage/render/renderer.h"
#include "pelage/shadow/density_map.h"

namespace pelage {

/// Everything that may change from frame to frame.
struct FrameSettings {
  Camera camera;
  std::vector<Light> lights;
  HairMaterial material;
  SatfSettings satf;
};

class SatfFrame {
 public:
  /// Needs a current OpenGL context. @param head  may be empty
  SatfFrame(Hairstyle style, std::unique_ptr<RecordSource> source, const BakeSettings& bake, Mesh head);
  ~SatfFrame();

  /// The same clusters elsewhere: moving hair [Xu2006 Fig. 8]. Only centre lines, their first normals and transforms
  /// are taken: density field and records stay, nothing is searched. Seen from the next picture on, bounds() too.
  /// @throws InputError for clusters that are not those of the hairstyle, or a centre line that cannot be evaluated
  void move_hair(std::span<const Cluster> clusters);
  /// The same head elsewhere.
  void move_head(Mesh head);

  /// A picture of any size; large ones are drawn in tiles. Linear, premultiplied, over transparent black.
  Image render(const FrameSettings& frame, int width, int height, int supersampling, int tile_samples = kTileSamples,
               const TilesDone& told = {});
  /// Draws and shows it on the window's framebuffer of this size, one sample per pixel.
  void show(const FrameSettings& frame, int width, int height, const Presentation& as);

  /// The next picture is made as if the hair had moved.
  void refresh() noexcept { moved_ = true; }

  const Bounds& bounds() const noexcept { return bounds_; }
  const StageLedger& ledger() const noexcept { return ledger_; }
  const RecordSource& source() const noexcept { return *source_; }
  const SatfModel& model() const noexcept { return model_; }
  const Hairstyle& style() const noexcept { return style_; }
  const Mesh& head() const noexcept { return head_; }

 private:
  void update(const FrameSettings& frame);
  void update_surfaces();
  void update_shadows(const FrameSettings& frame);
  void update_head_shadow(const FrameSettings& frame, std::span<const std::optional<DensityMap>> maps);
  void update_maps(const FrameSettings& frame);
  void update_order(const FrameSettings& frame);
  PictureOutput::Draw draw_of(const FrameSettings& frame, float aspect);

  StageLedger ledger_;
  Hairstyle style_;
  std::unique_ptr<RecordSource> source_;
  Mesh head_;
  SatfModel model_;
  HairSurfaces surfaces_;
  Strands strands_;                                  // for the shadow map
  std::vector<std::vector<std::uint16_t>> shadows_;  // [light][texel]
  std::vector<Texel> texels_;                        // [light][texel]
  std::vector<std::uint32_t> indices_;
  Bounds bounds_;
  std::optional<FrameSettings> last_;
  bool moved_ = false;  // since the surfaces were made
  Renderer renderer_;
  PictureOutput output_{GL_RGBA16F};
};

}  // namespace pelage
