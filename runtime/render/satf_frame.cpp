#include "pelage/render/satf_frame.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/lighting.h"
#include "pelage/satf/self_shadow.h"

namespace pelage {
namespace {

bool same_shadows(const FrameSettings& a, const FrameSettings& b) {
  const SatfSettings &s = a.satf, &t = b.satf;
  return a.lights == b.lights && s.self_shadow == t.self_shadow && s.global_shadow == t.global_shadow &&
         s.shadow_resolution == t.shadow_resolution && s.curvature == t.curvature;
}

bool same_maps(const FrameSettings& a, const FrameSettings& b) {
  const SatfSettings &s = a.satf, &t = b.satf;
  return same_shadows(a, b) && a.camera.eye == b.camera.eye && s.self_shadow_strength == t.self_shadow_strength;
}

bool same_order(const FrameSettings& a, const FrameSettings& b) {
  return a.camera.eye == b.camera.eye && a.satf.draw_order == b.satf.draw_order;
}

/// Alpha comes with the maps of a light: a scene without one gets a light that is off, so that hair is black, not gone.
FrameSettings with_light(FrameSettings frame) {
  if (frame.lights.empty()) frame.lights.emplace_back().intensity = 0.0F;
  return frame;
}

DensityMapSettings map_settings(const SatfSettings& satf) {
  DensityMapSettings settings;
  settings.resolution = satf.shadow_resolution;
  return settings;
}

/// Of no meaning for a point light.
glm::vec3 parallel_direction(const Light& light) {
  return light.position ? glm::vec3(0, 1, 0) : glm::normalize(light.direction);
}

}  // namespace

SatfFrame::SatfFrame(Hairstyle style, std::unique_ptr<RecordSource> source, const BakeSettings& bake, Mesh head)
    : style_(std::move(style)), source_(std::move(source)), head_(std::move(head)) {
  {
    auto stage = ledger_.run("sectors");
    model_ = make_model(style_, bake, source_->samples());
    stage.bytes(model_.sectors.crossings.size() * sizeof(glm::vec2));
  }
  {
    auto stage = ledger_.run("index");
    source_->attach(model_.sectors);
  }
  renderer_.set_hair(model_, style_.clusters);
  if (!head_.vertices.empty()) renderer_.head().set_head(head_);
  update_surfaces();
}

SatfFrame::~SatfFrame() = default;

void SatfFrame::move_hair(std::span<const Cluster> clusters) {
  if (clusters.size() != style_.clusters.size()) {
    throw InputError("moved clusters", std::to_string(clusters.size()) + " of them, the hairstyle has " +
                                           std::to_string(style_.clusters.size()));
  }
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    if (clusters[c].transforms.size() != style_.clusters[c].transforms.size())
      throw InputError("moved cluster " + std::to_string(c), "has another number of transforms than the hairstyle's");
    CentreLine(clusters[c].centre_line, clusters[c].first_normal);  // refused before anything has changed
  }
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    style_.clusters[c].centre_line = clusters[c].centre_line;
    style_.clusters[c].first_normal = clusters[c].first_normal;
    style_.clusters[c].transforms = clusters[c].transforms;
  }
  moved_ = true;
}

void SatfFrame::move_head(Mesh head) {
  head_ = std::move(head);
  if (!head_.vertices.empty()) renderer_.head().set_head(head_);
  moved_ = true;
}

void SatfFrame::update_surfaces() {
  auto stage = ledger_.run("surfaces");
  if (moved_) place_model(style_, model_);
  moved_ = false;
  surfaces_ = make_surfaces(model_);
  strands_ = hair_strands(style_, model_);
  stage.bytes(surfaces_.vertices.size() * sizeof(SurfaceVertex));
  renderer_.set_surfaces(surfaces_);
  bounds_ = {};
  for (const SurfaceVertex& v : surfaces_.vertices) bounds_.add(v.position);
  for (const glm::vec3& p : head_.vertices) bounds_.add(p);
}

void SatfFrame::update(const FrameSettings& frame) {
  check_light_count(frame.lights);
  if (moved_) {
    update_surfaces();
    last_.reset();
  }
  if (!last_ || !same_shadows(*last_, frame)) update_shadows(frame);
  if (!last_ || !same_maps(*last_, frame)) update_maps(frame);
  if (!last_ || !same_order(*last_, frame)) update_order(frame);
  last_ = frame;
}

void SatfFrame::update_shadows(const FrameSettings& frame) {
  std::vector<std::optional<DensityMap>> maps(frame.lights.size());
  shadows_.resize(frame.lights.size());
  for (std::size_t i = 0; i < frame.lights.size(); ++i) {
    std::optional<DensityMap>& map = maps[i];
    if (frame.satf.global_shadow) {
      auto stage = ledger_.run("shadow map");
      map.emplace(map_settings(frame.satf), strands_, style_.opacity, frame.lights[i]);
      stage.bytes(map->bytes());
    }
    if (!map && frame.satf.self_shadow != SelfShadow::light) {
      shadows_[i].clear();
      continue;
    }
    auto stage = ledger_.run("s-maps");
    shadows_[i].resize(model_.texels());
    const ShadowRequest request{parallel_direction(frame.lights[i]), frame.satf.self_shadow == SelfShadow::light,
                                frame.satf.curvature, map ? &*map : nullptr, frame.lights[i].position};
    build_shadows(model_, *source_, request, shadows_[i]);
    stage.bytes(shadows_[i].size() * sizeof(std::uint16_t));
  }
  update_head_shadow(frame, maps);
}

void SatfFrame::update_head_shadow(const FrameSettings& frame, std::span<const std::optional<DensityMap>> maps) {
  if (head_.vertices.empty()) return;
  std::vector<glm::vec4> all(head_.vertices.size(), glm::vec4(1.0F));
  if (frame.satf.global_shadow) {
    auto stage = ledger_.run("head shadow");
    DensityMap part(map_settings(frame.satf));  // built again for each place of a light that has a size
    for (std::size_t i = 0; i < maps.size(); ++i) {
      const auto through = head_shadow(frame.lights[i], head_.vertices.size(), [&](const Light& from, auto out) {
        if (!has_size(frame.lights[i])) return maps[i]->transmittance(head_.vertices, out);
        part.build(strands_, style_.opacity, from);
        part.transmittance(head_.vertices, out);
      });
      for (std::size_t v = 0; v < all.size(); ++v) all[v][static_cast<int>(i)] = through[v];
    }
    stage.bytes(all.size() * sizeof(glm::vec4));
  }
  renderer_.head().set_shadow(all);
}

void SatfFrame::update_maps(const FrameSettings& frame) {
  texels_.resize(model_.texels() * frame.lights.size());
  {
    auto stage = ledger_.run("maps");
    for (std::size_t i = 0; i < frame.lights.size(); ++i) {
      const MapRequest request{frame.camera.eye, parallel_direction(frame.lights[i]), frame.satf,
                               frame.lights[i].position};
      build_maps(model_, *source_, request, shadows_[i],
                 std::span(texels_).subspan(i * model_.texels(), model_.texels()));
    }
    stage.bytes(texels_.size() * sizeof(Texel));
  }
  auto stage = ledger_.run("upload");
  renderer_.set_texels(texels_);
  renderer_.set_views(plate_views(model_, frame.camera.eye));
  stage.bytes(texels_.size() * sizeof(Texel));
}

void SatfFrame::update_order(const FrameSettings& frame) {
  auto stage = ledger_.run("order");
  indices_ = ordered_indices(surfaces_, model_.division, frame.satf.draw_order, frame.camera.eye);
  renderer_.set_order(indices_);
  stage.bytes(indices_.size() * sizeof(std::uint32_t));
}

PictureOutput::Draw SatfFrame::draw_of(const FrameSettings& frame, float aspect) {
  const DrawRequest whole{world_to_clip(frame.camera, bounds_, aspect), frame.camera.eye, frame.lights, frame.material,
                          frame.satf};
  return [this, whole](const glm::mat4& part, Framebuffer& target) {
    DrawRequest request = whole;
    request.world_to_clip = part * whole.world_to_clip;
    renderer_.draw(request, target);
  };
}

void SatfFrame::show(const FrameSettings& settings, int width, int height, const Presentation& as) {
  const FrameSettings frame = with_light(settings);
  ledger_.begin_frame();
  update(frame);
  const PictureSize size{width, height};
  output_.show(size, as, ledger_, draw_of(frame, size.aspect()));
}

Image SatfFrame::render(const FrameSettings& settings, int width, int height, int supersampling, int tile_samples,
                        const TilesDone& told) {
  const FrameSettings frame = with_light(settings);
  if (last_) ledger_.begin_frame();
  update(frame);
  const PictureSize size{width, height, supersampling, tile_samples};
  return output_.render(size, ledger_, draw_of(frame, size.aspect()), told);
}

}  // namespace pelage
