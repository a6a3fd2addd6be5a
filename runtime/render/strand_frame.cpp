#include "pelage/render/strand_frame.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <limits>
#include <string>

#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/lighting.h"
#include "pelage/data_schema/strand_tint.h"
#include "pelage/hair/catmull_rom.h"
#include "pelage/render/shader_inputs.h"

namespace pelage {
namespace {

/// A line's samples over those of its length: shaders/strands.vert, line_stretch().
constexpr float kLineStretch = 1.4142136F;

/// Do both lights come from the same place? Colour and intensity are no matter of shadows.
bool same_place(const Light& a, const Light& b) {
  return a.position == b.position && (a.position || (a.direction == b.direction && a.size_deg == b.size_deg));
}

void check_settings(const StrandFrameSettings& frame) {
  check_light_count(frame.lights);
  if (frame.method == Method::satf || frame.method == Method::truth) {
    throw UsageError(
        "method satf and method truth are not drawn strand by strand; use density-map, deep-opacity, "
        "opacity-shadow or unshadowed");
  }
  if (frame.strands.smoothing < 1 || frame.strands.smoothing > 32) {
    throw UsageError("smoothing: " + std::to_string(frame.strands.smoothing) + " is outside [1, 32]");
  }
}

bool same_order(const StrandFrameSettings& a, const StrandFrameSettings& b) {
  const bool fixed = b.strands.order == StrandOrder::exact;
  return a.strands.order == b.strands.order &&
         (fixed || (a.camera.eye == b.camera.eye && a.camera.target == b.camera.target));
}

bool at_fragments(const StrandFrameSettings& frame) {
  return frame.strands.shadow_at == ShadowAt::fragment && frame.method != Method::unshadowed;
}

}  // namespace

HairMaterial material_of(const HairMaterial& material, StrandLobes lobes) noexcept {
  HairMaterial m = material;
  if (lobes == StrandLobes::kajiya_kay) m.primary_shift = m.secondary = 0.0F;
  return m;
}

// Half floats would lose faint fragments: 2^-11 of what is there already vanishes, and thin strands are fainter.
StrandFrame::StrandFrame(Strands strands, float opacity, Mesh head) : opacity_(opacity), output_(GL_RGBA32F) {
  if (!(opacity >= 0.0F && opacity <= 1.0F)) {
    throw InputError("opacity", std::to_string(opacity) + " is outside [0, 1]");
  }
  set_geometry(std::move(strands), std::move(head));
}

void StrandFrame::set_geometry(Strands strands, Mesh head) {
  head_ = std::move(head);
  if (!head_.vertices.empty()) renderer_.head().set_head(head_);
  set_strands(std::move(strands));
}

void StrandFrame::set_strands(Strands strands) {
  strands_ = std::move(strands);
  if (strands_.diameters_m.empty() && !(strands_.diameter_m > 0.0F)) {
    strands_.diameter_m = default_diameter_m(strands_.count());
  }
  bounds_ = {};
  for (const glm::vec3& p : head_.vertices) bounds_.add(p);
  for (const glm::vec3& p : strands_.vertices) bounds_.add(p);
  moved_ = true;
}

void StrandFrame::update(const StrandFrameSettings& frame) {
  check_settings(frame);
  moved_ = moved_ || !last_ || last_->strands.smoothing != frame.strands.smoothing;
  const bool moved = moved_;
  const bool reordered = moved || !same_order(*last_, frame);
  const bool other_method = !last_ || last_->method != frame.method || last_->shadow != frame.shadow;
  const bool elsewhere = moved || at_fragments(*last_) != at_fragments(frame);
  last_.reset();  // so that a stage that throws is run again
  if (moved) update_geometry(frame.strands.smoothing);
  if (moved || frame.material.variation != variation_) update_tints(frame.material.variation);
  if (update_shadows(frame, other_method) || elsewhere) look_up_shadows(frame);
  if (reordered) update_order(frame);
  moved_ = false;
  last_ = frame;
}

void StrandFrame::update_geometry(int pieces) {
  smoothed_.reset();
  if (pieces > 1) {
    auto stage = ledger_.run("smooth");
    smoothed_ = hair::smooth(strands_, pieces);
    stage.bytes(smoothed_->vertices.size() * sizeof(glm::vec3));
  }
  drawn_bounds_ = bounds_;
  for (const glm::vec3& p : drawn().vertices) drawn_bounds_.add(p);
  const std::vector<float>& diameters_m = drawn().diameters_m;
  widest_m_ = diameters_m.empty() ? drawn().diameter_m : *std::max_element(diameters_m.begin(), diameters_m.end());
  std::vector<glm::vec4> tangents;
  {
    auto stage = ledger_.run("tangents");
    tangents = strand_tangents(drawn());
    segments_ = strand_segments(drawn());
    stage.bytes(tangents.size() * sizeof(glm::vec4));
  }
  auto stage = ledger_.run("upload");
  renderer_.set_vertices(strand_vertices(drawn()), tangents, drawn().colours);
  renderer_.set_segments(segments_);
  sorted_.clear();
  stage.bytes(2 * tangents.size() * sizeof(glm::vec4) + segments_.size() * sizeof(StrandSegment));
}

void StrandFrame::update_tints(float variation) {
  renderer_.set_tints(variation > 0 ? strand_tints(drawn().count(), variation) : std::vector<glm::vec3>{});
  variation_ = variation;
}

/// Builds the shadows of those lights that need it. @return whether any was built, or a light is gone
bool StrandFrame::update_shadows(const StrandFrameSettings& frame, bool other_method) {
  if (frame.method == Method::unshadowed) {
    shadows_.clear();
    return other_method;
  }
  bool changed = shadows_.size() != frame.lights.size();
  shadows_.resize(frame.lights.size());
  for (std::size_t i = 0; i < shadows_.size(); ++i) {
    LightShadow& s = shadows_[i];
    if (!other_method && !moved_ && s.shadow && same_place(s.light, frame.lights[i])) continue;
    auto shadow = std::move(s.shadow);  // gone, should building throw
    if (shadow && !other_method) {
      shadow->build(drawn(), opacity_, frame.lights[i]);
    } else {
      shadow.reset();
      shadow = make_shadow(frame.method, frame.shadow, drawn(), opacity_, frame.lights[i]);
    }
    ledger_.add({"fill", shadow->times().fill_ms, shadow->bytes(), 1});
    ledger_.add({"transmittance", shadow->times().transmittance_ms, shadow->bytes(), 1});
    s = {frame.lights[i], std::move(shadow)};
    changed = true;
  }
  return changed;
}

void StrandFrame::look_up_shadows(const StrandFrameSettings& frame) {
  update_head_shadow(frame);
  if (frame.method == Method::unshadowed) {
    renderer_.set_transmittance(std::vector<glm::vec4>(drawn().vertices.size(), glm::vec4(1)));
    return;
  }
  auto stage = ledger_.run("filter");
  std::vector<float> through;
  const auto at = [&](std::span<const glm::vec3> points) {
    std::vector<glm::vec4> all(points.size(), glm::vec4(1.0F));
    through.resize(points.size());
    for (std::size_t i = 0; i < shadows_.size(); ++i) {
      shadows_[i].shadow->transmittance(points, through);
      for (std::size_t v = 0; v < points.size(); ++v) all[v][static_cast<int>(i)] = through[v];
    }
    stage.bytes(all.size() * sizeof(glm::vec4));
    return all;
  };
  if (at_fragments(frame)) {
    look_up_at_fragments();
    renderer_.set_transmittance(std::vector<glm::vec4>(drawn().vertices.size(), glm::vec4(1.0F)));
  } else {
    renderer_.set_transmittance(at(drawn().vertices));
  }
}

void StrandFrame::update_head_shadow(const StrandFrameSettings& frame) {
  if (head_.vertices.empty()) return;
  std::vector<glm::vec4> all(head_.vertices.size(), glm::vec4(1.0F));
  if (frame.method != Method::unshadowed) {
    auto stage = ledger_.run("head shadow");
    for (std::size_t i = 0; i < shadows_.size(); ++i) {
      std::unique_ptr<HairShadow> part;  // built again for each place of a light that has a size
      const auto through = head_shadow(frame.lights[i], head_.vertices.size(), [&](const Light& from, auto out) {
        if (!has_size(frame.lights[i])) return shadows_[i].shadow->transmittance(head_.vertices, out);
        if (part)
          part->build(drawn(), opacity_, from);
        else
          part = make_shadow(frame.method, frame.shadow, drawn(), opacity_, from);
        part->transmittance(head_.vertices, out);
      });
      for (std::size_t v = 0; v < all.size(); ++v) all[v][static_cast<int>(i)] = through[v];
    }
    stage.bytes(all.size() * sizeof(glm::vec4));
  }
  renderer_.head().set_shadow(all);
}

void StrandFrame::look_up_at_fragments() {
  std::vector<DepthTexture> maps;
  for (const LightShadow& s : shadows_) {
    auto map = s.shadow->depth_texture();
    if (!map) {
      throw UsageError(
          "shadows at fragments need method density-map, directional lights, even slices and the filter; look "
          "them up at vertices");
    }
    maps.push_back(std::move(*map));
  }
  renderer_.set_depth_maps(maps);
}

void StrandFrame::update_order(const StrandFrameSettings& frame) {
  if (frame.strands.order != StrandOrder::sorted && !sorted_.empty()) {
    // Sums of floats depend on their order: no picture does on the frame before.
    renderer_.set_segments(segments_);
    sorted_.clear();
  }
  if (frame.strands.order == StrandOrder::exact) return;
  auto stage = ledger_.run("order");
  const glm::vec3 forward = glm::normalize(frame.camera.target - frame.camera.eye);
  const std::vector<glm::vec3>& vertices = drawn().vertices;
  if (frame.strands.order == StrandOrder::weighted) {
    nearest_m_ = std::numeric_limits<float>::max();
    for (const glm::vec3& p : vertices) {
      nearest_m_ = std::min(nearest_m_, std::max(glm::dot(p - frame.camera.eye, forward), 0.0F));
    }
    return;
  }
  sorted_.resize(segments_.size());
  sort_by_depth(segments_, vertices, frame.camera.eye, forward, sorted_);
  renderer_.set_segments(sorted_);
  stage.bytes(sorted_.size() * sizeof(StrandSegment));
}

/// Ribbons, unless every fibre is so thin that a line of one sample, which covers up to sqrt(2) of it, can fade by what
/// it covers too much: the same picture for less.
StrandShape StrandFrame::shape_for(const StrandFrameSettings& frame, float sample_slope) const {
  if (frame.strands.shape != StrandShape::automatic) return frame.strands.shape;
  const glm::vec3 forward = glm::normalize(frame.camera.target - frame.camera.eye);
  float nearest_m = std::numeric_limits<float>::max();
  for (const glm::vec3& p : drawn().vertices) nearest_m = std::min(nearest_m, glm::dot(p - frame.camera.eye, forward));
  return nearest_m > 0 && kLineStretch * widest_m_ <= sample_slope * nearest_m ? StrandShape::lines
                                                                               : StrandShape::ribbons;
}

PictureOutput::Draw StrandFrame::draw_of(const StrandFrameSettings& frame, const PictureSize& size) {
  StrandDrawRequest whole;
  whole.world_to_clip = world_to_clip(frame.camera, drawn_bounds_, size.aspect());
  whole.eye = frame.camera.eye;
  whole.sample_slope =
      2.0F * std::tan(glm::radians(0.5F * frame.camera.fov_deg)) / static_cast<float>(size.height * size.supersampling);
  whole.nearest_m = nearest_m_;
  whole.lights = frame.lights;
  whole.material = material_of(frame.material, frame.strands.lobes);
  whole.settings = frame.strands;
  whole.settings.shape = shape_for(frame, whole.sample_slope);
  whole.phong = frame.phong;
  whole.opacity = opacity_;
  whole.shadowed = frame.method != Method::unshadowed;
  return [this, whole](const glm::mat4& part, Framebuffer& target) {
    StrandDrawRequest request = whole;
    request.world_to_clip = part * whole.world_to_clip;
    renderer_.draw(request, target);
  };
}

void StrandFrame::show(const StrandFrameSettings& frame, int width, int height, const Presentation& as) {
  ledger_.begin_frame();
  update(frame);
  const PictureSize size{width, height};
  output_.show(size, as, ledger_, draw_of(frame, size));
}

Image StrandFrame::render(const StrandFrameSettings& frame, int width, int height, int supersampling, int tile_samples,
                          const TilesDone& told) {
  ledger_.begin_frame();
  update(frame);
  const PictureSize size{width, height, supersampling, tile_samples};
  return output_.render(size, ledger_, draw_of(frame, size), told);
}

}  // namespace pelage
