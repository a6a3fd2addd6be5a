// [Xu2006 Figs. 4, 5]: hair rendered by Scheuermann's algorithm and by SATF, with effects left out.
// Scheuermann's algorithm as section 7 there tells it apart: both highlights, the second one shifted, but neither
// reflectance that changes with where hair, eye and light are, nor shadow. Here: strands with Scheuermann's lobes, lit
// as if alone. The paper shows no truth and measures nothing; these do.
#include "pelage/app/figures_of_methods.h"
#include "pelage/app/framing.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "pelage/app/compared_truth.h"
#include "pelage/app/drawing.h"
#include "pelage/app/figure_sheet.h"
#include "pelage/hair/groom.h"
#include "pelage/hair/hair_file.h"
#include "pelage/hair/mesh_obj.h"
#include "pelage/image/picture_error.h"

namespace pelage::app {
namespace {

struct Variant {
  const char* title;
  void (*change)(Scene&);
};

constexpr Variant kScheuermann{"Scheuermann's shading", [](Scene& s) {
                                 s.method = Method::unshadowed;
                                 s.strands.lobes = StrandLobes::scheuermann;
                               }};
constexpr Variant kNoSecond{"SATF, no secondary", [](Scene& s) { s.satf.secondary_highlight = false; }};
constexpr Variant kNoShadow{"SATF, no self-shadow", [](Scene& s) {
                              s.satf.self_shadow = SelfShadow::none;
                              s.satf.global_shadow = false;
                            }};
constexpr Variant kAll{"SATF, all effects", [](Scene&) {}};

/// Where the scene names no hair, a groom and its head as files in the cache, so that what is fitted and baked is kept.
void use_groom(Scene& scene) {
  if (!scene.hair.empty()) return;
  const Subject groom = subject_of(scene, hair::GroomStyle::wavy, 10'000);
  scene.hair = (cache_folder() / "figure-wavy.hair").string();
  scene.head = (cache_folder() / "figure-head.obj").string();
  hair::write_hair(groom.hair.strands, scene.hair);
  hair::write_obj(groom.head, scene.head);
}

Image sheet_of(Scene scene, const std::vector<Variant>& variants) {
  scene.method = Method::truth;
  if (!scene.image.background) scene.image.background = glm::vec3(0.85F);
  scene.truth.samples = std::max(scene.truth.samples / 2, 1);  // of one half
  const auto traced = make_drawing(scene);
  scene.camera = camera_of(scene, *traced);
  const ComparedTruth truth = draw_truth(*traced, scene, *scene.camera, {});
  const TruthFrame& frame = truth.frames.front();
  Sheet sheet({static_cast<int>(variants.size()) + 1, 1}, size_of(scene));
  for (std::size_t i = 0; i < variants.size(); ++i) {
    Scene changed = scene;
    changed.method = Method::satf;
    variants[i].change(changed);
    const Image picture = picture_of(*make_drawing(changed), changed);
    const PictureError error = picture_error(picture, frame.picture, frame.alpha);
    sheet.put({static_cast<int>(i), 0}, picture, fmt::format("({}) {}", static_cast<char>('a' + i), variants[i].title),
              fmt::format("RMSE {:.4f}, FLIP {:.3f}", error.rmse, error.flip));
  }
  sheet.put({static_cast<int>(variants.size()), 0}, frame.picture, "ray-traced truth",
            fmt::format("its own noise {:.4f}", truth.noise.rmse));
  return sheet.image();
}

}  // namespace

Image ablations_figure(Scene scene) {
  use_groom(scene);
  scene.head.clear();
  return sheet_of(scene, {kScheuermann, kNoSecond, kNoShadow, kAll});
}

Image head_figure(Scene scene) {
  use_groom(scene);
  return sheet_of(scene, {kScheuermann, kAll});
}

}  // namespace pelage::app
