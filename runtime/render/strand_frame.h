// StrandFrame: hair rendered strand by strand, frame after frame, with the density map of [Bertails2005] or one of the
// methods it is compared with. Runs only the stages whose inputs changed; a camera move builds no shadow (Fig. 4
// there):
//   smooth, tangents, upload    geometry
//   fill, transmittance         a light's place, geometry, shadow settings; each light for itself
//   filter                      a shadow that was built: read at all vertices
//   head shadow                 the same for the head's vertices; a light of some size is built from several places
//   order                       view, where the order needs it (sorted, weighted)
//   draw, read                  every frame
//
// Orders, and their error against exact: RMSE of linear RGB over covered pixels, relative to their mean (grooms of
// 6,000 to 11,400 strands without a head, 300 x 300 pixels, 4 samples each), and time to draw on a software renderer.
//   exact      sorts fragments                                                   0             2.0-3.4 s
//   sorted     segments by the depth of their middles; wrong where they cross    1.0-1.8 %     1.2-1.9 s
//   weighted   knows no order but depth; where a head hides the far side         36-46 %       1.2-1.5 s
//              the error is a few percent                                        (thin lock: 4 %)
// tests/render/strand_order_test.cpp prints them for two locks.
//
// Strands that share a sample stop 1 - (1 - a)^n of the light, as if each lay anywhere in it: right on average, up to
// 10 % too opaque where a lock of 12 mm is seen in samples of 4 mm (tests/render/strand_coverage_test.cpp). Lines cover
// no more than one sample's width.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "pelage/data_schema/mesh.h"
#include "pelage/data_schema/stages.h"
#include "pelage/image/image.h"
#include "pelage/render/camera.h"
#include "pelage/render/picture_output.h"
#include "pelage/render/strand_renderer.h"

namespace pelage {

/// Everything that may change from frame to frame.
struct StrandFrameSettings {
  Camera camera;
  std::vector<Light> lights;  // at most kMaxLights
  HairMaterial material;
  Method method = Method::density_map;  // not satf, not truth
  StrandSettings strands;
  ShadowSettings shadow;
  PlanarPhong phong{};  // reflectance around a fibre, for strands.azimuth
};

/// The material as StrandLobes asks for it: Kajiya-Kay's has one highlight, unshifted [KajiyaKay1989].
HairMaterial material_of(const HairMaterial& material, StrandLobes lobes) noexcept;

class StrandFrame {
 public:
  /// Needs a current OpenGL context. @param strands  without a diameter they get default_diameter_m()
  /// @param opacity  of a fibre, [0, 1]    @param head  may be empty
  StrandFrame(Strands strands, float opacity, Mesh head);

  /// Other geometry of the same hair or another: moved, cut, more.
  void set_strands(Strands strands);
  /// The same with the head, moved.
  void set_geometry(Strands strands, Mesh head);

  /// A picture of any size; large ones are drawn in tiles. Linear, premultiplied, over transparent black.
  /// @throws UsageError for a method or settings that are not drawn here; what make_shadow() throws
  Image render(const StrandFrameSettings& frame, int width, int height, int supersampling,
               int tile_samples = kTileSamples, const TilesDone& told = {});
  /// Draws and shows it on the window's framebuffer of this size, one sample per pixel.
  void show(const StrandFrameSettings& frame, int width, int height, const Presentation& as);

  /// The next picture is made as if the geometry were new.
  void refresh() noexcept { moved_ = true; }

  const Bounds& bounds() const noexcept { return bounds_; }
  const StageLedger& ledger() const noexcept { return ledger_; }
  const Strands& strands() const noexcept { return strands_; }
  float opacity() const noexcept { return opacity_; }
  const Mesh& head() const noexcept { return head_; }

 private:
  struct LightShadow {
    Light light;
    std::unique_ptr<HairShadow> shadow;
  };

  const Strands& drawn() const noexcept { return smoothed_ ? *smoothed_ : strands_; }
  void update(const StrandFrameSettings& frame);
  void update_geometry(int pieces);
  void update_tints(float variation);
  bool update_shadows(const StrandFrameSettings& frame, bool other_method);
  void look_up_shadows(const StrandFrameSettings& frame);
  void look_up_at_fragments();
  void update_head_shadow(const StrandFrameSettings& frame);
  void update_order(const StrandFrameSettings& frame);
  StrandShape shape_for(const StrandFrameSettings& frame, float sample_slope) const;
  PictureOutput::Draw draw_of(const StrandFrameSettings& frame, const PictureSize& size);

  StageLedger ledger_;
  Strands strands_;
  std::optional<Strands> smoothed_;
  float opacity_;
  Mesh head_;
  Bounds bounds_, drawn_bounds_;
  std::vector<StrandSegment> segments_;
  std::vector<StrandSegment> sorted_;  // what the renderer has; empty: segments_
  std::vector<LightShadow> shadows_;
  float widest_m_ = 0;  // drawn diameter
  float nearest_m_ = 0;
  float variation_ = 0;                      // of the colours that the renderer has
  std::optional<StrandFrameSettings> last_;  // none: nothing is up to date
  bool moved_ = true;                        // nothing that depends on geometry is
  StrandRenderer renderer_;
  PictureOutput output_;
};

}  // namespace pelage
