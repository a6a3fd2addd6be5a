#include "pelage/render/strand_renderer.h"

#include <algorithm>
#include <array>
#include <glm/gtc/type_ptr.hpp>
#include <string>

#include "pelage/data_schema/errors.h"
#include "pelage/render/shader_inputs.h"
#include "pelage/render/weighted_blend.h"
#include "pelage/shading/azimuth_mean.h"

namespace pelage {
namespace {

constexpr const char* kRemedy = "use fewer strands or less smoothing";

/// As std430 has arrays of three floats: four each.
void upload_padded(Buffer& buffer, std::span<const glm::vec3> colours) {
  std::vector<glm::vec4> padded;
  padded.reserve(colours.size());
  for (const glm::vec3& c : colours) padded.emplace_back(c, 1.0F);
  buffer.upload(GL_SHADER_STORAGE_BUFFER, std::span<const glm::vec4>(padded), GL_STATIC_DRAW);
}

}  // namespace

struct StrandRenderer::Resources {
  explicit Resources(std::size_t most_list_bytes) : lists(most_list_bytes) {}

  VertexArray array;
  Buffer vertices, tangents, transmittance, segments, colours, tints;
  std::size_t segment_count = 0;
  bool own_colours = false, tinted = false;
  DepthMaps depth_maps;
  FragmentLists lists;
  WeightedBlend weighted;
  std::array<std::unique_ptr<Program>, 6> programs;  // [order][shadow at fragment], built when first used
};

StrandRenderer::StrandRenderer(std::size_t most_list_bytes) : gl_(std::make_unique<Resources>(most_list_bytes)) {
  check_opengl("building the shaders");
}
StrandRenderer::~StrandRenderer() = default;

void StrandRenderer::set_vertices(std::span<const glm::vec4> vertices, std::span<const glm::vec4> tangents,
                                  std::span<const glm::vec3> colours) {
  gl_->vertices.upload(GL_SHADER_STORAGE_BUFFER, vertices, GL_DYNAMIC_DRAW);
  gl_->tangents.upload(GL_SHADER_STORAGE_BUFFER, tangents, GL_DYNAMIC_DRAW);
  gl_->own_colours = !colours.empty();
  upload_padded(gl_->colours, colours);
}

void StrandRenderer::set_tints(std::span<const glm::vec3> tints) {
  gl_->tinted = !tints.empty();
  upload_padded(gl_->tints, tints);
}

void StrandRenderer::set_segments(std::span<const StrandSegment> segments) {
  gl_->segments.upload(GL_SHADER_STORAGE_BUFFER, segments, GL_DYNAMIC_DRAW);
  gl_->segment_count = segments.size();
}

void StrandRenderer::set_transmittance(std::span<const glm::vec4> transmittance) {
  gl_->transmittance.upload(GL_SHADER_STORAGE_BUFFER, transmittance, GL_DYNAMIC_DRAW);
}

void StrandRenderer::set_depth_maps(std::span<const DepthTexture> maps) {
  gl_->depth_maps.upload(maps);
}

const Program& StrandRenderer::program(const StrandSettings& settings, bool at_fragment) {
  auto& p = gl_->programs.at(2 * static_cast<std::size_t>(settings.order) + (at_fragment ? 1 : 0));
  if (!p) {
    std::string defines;
    if (settings.order == StrandOrder::exact) defines += FragmentLists::kDefine;
    if (settings.order == StrandOrder::weighted) defines += WeightedBlend::kDefine;
    if (at_fragment) defines += "\n#define PELAGE_SHADOW_AT_FRAGMENT";
    p = std::make_unique<Program>("strands.vert", "strands.frag", defines);
  }
  return *p;
}

void StrandRenderer::draw(const StrandDrawRequest& request, Framebuffer& target) {
  head_.begin_picture(request.world_to_clip, request.lights, target);
  const Program& p = program(request.settings, request.shadowed && request.settings.shadow_at == ShadowAt::fragment);
  const auto draw_all = [&] { draw_strands(request, p, target); };
  if (gl_->segment_count == 0) {
    // Nothing to blend.
  } else if (request.settings.order == StrandOrder::exact) {
    gl_->lists.blend(target, draw_all);
  } else if (request.settings.order == StrandOrder::weighted) {
    gl_->weighted.blend(target, draw_all);
  } else {
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    draw_all();
    glDisable(GL_BLEND);
  }
  glDepthMask(GL_TRUE);
  check_opengl("drawing strands");
}

void StrandRenderer::draw_strands(const StrandDrawRequest& request, const Program& p, const Framebuffer& target) {
  const StrandSettings& on = request.settings;
  glUseProgram(p.id());
  glUniformMatrix4fv(p.at("world_to_clip"), 1, GL_FALSE, glm::value_ptr(request.world_to_clip));
  glUniform3fv(p.at("eye"), 1, glm::value_ptr(request.eye));
  glUniform2f(p.at("samples_across"), 0.5F * static_cast<float>(target.width()),
              0.5F * static_cast<float>(target.height()));
  glUniform1f(p.at("sample_slope"), request.sample_slope);
  glUniform1f(p.at("opacity"), request.opacity);
  glUniform1i(p.at("ribbons"), on.shape != StrandShape::lines ? 1 : 0);
  glUniform1i(p.at("own_colours"), gl_->own_colours ? 1 : 0);
  glUniform1i(p.at("tinted"), gl_->tinted ? 1 : 0);
  glUniform1f(p.at("ambient"), request.material.ambient);
  const glm::vec2 azimuth = on.azimuth ? azimuth_coefficients(request.phong) : glm::vec2(0);
  glUniform2fv(p.at("azimuth"), 1, glm::value_ptr(azimuth));
  set_lights(p, request.lights);
  set_material(p, request.material, {on.diffuse, on.primary_highlight, on.secondary_highlight});
  if (on.order == StrandOrder::exact) gl_->lists.bind(p);
  if (on.order == StrandOrder::weighted) WeightedBlend::bind(p, request.nearest_m);
  if (request.shadowed && on.shadow_at == ShadowAt::fragment) gl_->depth_maps.bind(p);
  bind_storage(0, gl_->vertices, "the strands' vertices", kRemedy);
  bind_storage(1, gl_->tangents, "the strands' tangents", kRemedy);
  bind_storage(2, gl_->transmittance, "the strands' transmittances", kRemedy);
  bind_storage(5, gl_->segments, "the strands' segments", kRemedy);
  bind_storage(6, gl_->colours, "the strands' colours", kRemedy);
  bind_storage(7, gl_->tints, "the strands' tints", kRemedy);
  glBindVertexArray(gl_->array.id());
  const bool ribbons = on.shape != StrandShape::lines;
  glDrawArrays(ribbons ? GL_TRIANGLES : GL_LINES, 0, static_cast<GLsizei>((ribbons ? 6 : 2) * gl_->segment_count));
}

void DepthMaps::clear() {
  for (const Map& map : maps_) glDeleteTextures(1, &map.texture);
  maps_.clear();
}

void DepthMaps::upload(std::span<const DepthTexture> maps) {
  clear();
  GLint most = 0;
  glGetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &most);
  for (const DepthTexture& map : maps) {
    if (std::max({map.size.x, map.size.y, map.size.z}) > most) {
      throw GraphicsError("a density map of " + std::to_string(map.size.x) + " x " + std::to_string(map.size.y) +
                          " x " + std::to_string(map.size.z) + " cells is larger than this driver's " +
                          std::to_string(most) + ": lower its resolution, or look shadows up at vertices");
    }
    GLuint id = 0;
    glGenTextures(1, &id);
    maps_.push_back({id, map.world_to_cell, map.transmittance, map.tap_cells});
    glBindTexture(GL_TEXTURE_3D, id);
    glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTexStorage3D(GL_TEXTURE_3D, 1, GL_R32F, map.size.z, map.size.y, map.size.x);
    glTexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, 0, map.size.z, map.size.y, map.size.x, GL_RED, GL_FLOAT, map.values.data());
  }
  check_opengl("uploading density maps");
}

void DepthMaps::bind(const Program& p) const {
  for (std::size_t i = 0; i < maps_.size(); ++i) {
    const std::string index = "[" + std::to_string(i) + "]";
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(i));
    glBindTexture(GL_TEXTURE_3D, maps_[i].texture);
    glUniform1i(p.at(("depth_map" + index).c_str()), static_cast<GLint>(i));
    glUniformMatrix4fv(p.at(("world_to_cell" + index).c_str()), 1, GL_FALSE, glm::value_ptr(maps_[i].world_to_cell));
    glUniform1i(p.at(("map_is_transmittance" + index).c_str()), maps_[i].transmittance ? 1 : 0);
    glUniform1f(p.at(("tap_cells" + index).c_str()), maps_[i].tap_cells);
  }
  glActiveTexture(GL_TEXTURE0);
}

}  // namespace pelage
