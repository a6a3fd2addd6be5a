#include "pelage/render/renderer.h"

#include <cstddef>
#include <glm/gtc/type_ptr.hpp>

#include "pelage/render/fragment_lists.h"

namespace pelage {
namespace {

/// Mirrors MapInfo of hair_surface.frag (std430).
struct MapInfo {
  std::uint32_t first_texel, width, first_drift, sectors;
  glm::vec4 colour, ring;
};

std::vector<MapInfo> map_infos(const SatfModel& model, std::span<const Cluster> clusters) {
  std::vector<MapInfo> infos;
  for (std::size_t i = 0; i < model.instances.size(); ++i) {
    const glm::vec3 colour = clusters[model.instances[i].cluster].colour;
    for (int j = 0; j < model.division.layers; ++j) {
      const RingShape ring = ring_shape(model.division, j);
      infos.push_back({static_cast<std::uint32_t>(model.layout.texel(i, j, 0)),
                       static_cast<std::uint32_t>(model.layout.widths[static_cast<std::size_t>(j)]),
                       static_cast<std::uint32_t>(model.track(i, j, 0)),
                       static_cast<std::uint32_t>(sectors_in_layer(model.division, j)),
                       colour.r >= 0.0F ? glm::vec4(colour, 1.0F) : glm::vec4(0.0F),
                       glm::vec4(ring.inner, ring.outer, ring.width, ring.height)});
    }
  }
  return infos;
}

}  // namespace

struct Renderer::Resources {
  Program hair{"hair_surface.vert", "hair_surface.frag"};
  Program hair_lists{"hair_surface.vert", "hair_surface.frag", FragmentLists::kDefine};
  FragmentLists lists;

  VertexArray hair_array;
  Buffer hair_vertices, hair_indices, texels, maps, drift, views;

  std::size_t hair_index_count = 0, texels_per_light = 0;
  int rows = 2, samples = 4, layers = 1;
  float max_path = 4;
};

Renderer::Renderer() : gl_(std::make_unique<Resources>()) {
  check_opengl("building the shaders");
}
Renderer::~Renderer() = default;

void Renderer::set_surfaces(const HairSurfaces& surfaces) {
  glBindVertexArray(gl_->hair_array.id());
  gl_->hair_vertices.upload(GL_ARRAY_BUFFER, std::span<const SurfaceVertex>(surfaces.vertices), GL_DYNAMIC_DRAW);
  vertex_attribute(0, 3, sizeof(SurfaceVertex), offsetof(SurfaceVertex, position));
  vertex_attribute(1, 3, sizeof(SurfaceVertex), offsetof(SurfaceVertex, tangent));
  vertex_attribute(2, 3, sizeof(SurfaceVertex), offsetof(SurfaceVertex, normal));
  vertex_attribute(3, 2, sizeof(SurfaceVertex), offsetof(SurfaceVertex, map_at));
  glEnableVertexAttribArray(4);
  glVertexAttribIPointer(4, 1, GL_UNSIGNED_INT, sizeof(SurfaceVertex),
                         reinterpret_cast<const void*>(offsetof(SurfaceVertex, map_id)));
  vertex_attribute(5, 2, sizeof(SurfaceVertex), offsetof(SurfaceVertex, azimuth));
}

void Renderer::set_hair(const SatfModel& model, std::span<const Cluster> clusters) {
  const std::vector<MapInfo> infos = map_infos(model, clusters);
  gl_->maps.upload(GL_SHADER_STORAGE_BUFFER, std::span<const MapInfo>(infos), GL_STATIC_DRAW);
  gl_->drift.upload(GL_SHADER_STORAGE_BUFFER, std::span<const float>(model.sectors.drift), GL_STATIC_DRAW);
  gl_->texels_per_light = model.texels();
  gl_->rows = model.layout.rows;
  gl_->samples = model.samples;
  gl_->layers = model.division.layers;
  gl_->max_path = model.max_path;
}

void Renderer::set_texels(std::span<const Texel> texels) {
  gl_->texels.upload(GL_SHADER_STORAGE_BUFFER, texels, GL_STREAM_DRAW);
}

void Renderer::set_views(std::span<const glm::vec3> views) {
  gl_->views.upload(GL_SHADER_STORAGE_BUFFER, views, GL_STREAM_DRAW);
}

void Renderer::set_order(std::span<const std::uint32_t> indices) {
  glBindVertexArray(gl_->hair_array.id());
  gl_->hair_indices.upload(GL_ELEMENT_ARRAY_BUFFER, indices, GL_STREAM_DRAW);
  gl_->hair_index_count = indices.size();
}

void Renderer::draw(const DrawRequest& request, Framebuffer& target) {
  head_.begin_picture(request.world_to_clip, request.lights, target);
  if (request.settings.draw_order == DrawOrder::exact) {
    gl_->lists.blend(target, [&] { draw_hair(request, true); });
  } else {
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    draw_hair(request, false);
  }
  glDepthMask(GL_TRUE);
  check_opengl("drawing");
}

void Renderer::draw_hair(const DrawRequest& request, bool lists) {
  if (gl_->hair_index_count == 0) return;
  const Program& p = lists ? gl_->hair_lists : gl_->hair;
  glUseProgram(p.id());
  glUniformMatrix4fv(p.at("world_to_clip"), 1, GL_FALSE, glm::value_ptr(request.world_to_clip));
  set_lights(p, request.lights);
  const SatfSettings& on = request.settings;
  set_material(p, request.material, {on.diffuse, on.primary_highlight, on.secondary_highlight});
  glUniform1f(p.at("ambient"), request.material.ambient);
  glUniform3fv(p.at("eye"), 1, glm::value_ptr(request.eye));
  glUniform1ui(p.at("texels_per_light"), static_cast<GLuint>(gl_->texels_per_light));
  glUniform1i(p.at("rows"), gl_->rows);
  glUniform1i(p.at("samples"), gl_->samples);
  glUniform1i(p.at("use_drift"), on.drift ? 1 : 0);
  glUniform1i(p.at("use_curvature"), on.curvature ? 1 : 0);
  glUniform1f(p.at("max_path"), gl_->max_path);
  glUniform1ui(p.at("layers"), static_cast<GLuint>(gl_->layers));
  glUniform1ui(p.at("plates_per_instance"), static_cast<GLuint>(gl_->rows));
  glUniform1i(p.at("fade_ends"), on.fade_ends ? 1 : 0);
  if (lists) gl_->lists.bind(p);
  bind_storage(0, gl_->texels, "the maps", "use fewer clusters, layers, sectors, plates or lights");
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, gl_->maps.id());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, gl_->drift.id());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 5, gl_->views.id());
  glBindVertexArray(gl_->hair_array.id());
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(gl_->hair_index_count), GL_UNSIGNED_INT, nullptr);
}

}  // namespace pelage
