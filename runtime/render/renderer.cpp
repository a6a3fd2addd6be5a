#include "pelage/render/renderer.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <glm/gtc/type_ptr.hpp>

#include "pelage/data_schema/errors.h"
#include "pelage/render/gl_objects.h"

namespace pelage {
namespace {

constexpr glm::vec3 kSkin{0.62F, 0.45F, 0.36F};
constexpr float kHeadAmbient = 0.22F;
/// Bytes of one fragment in the per-pixel lists, and of their counter.
constexpr std::size_t kFragmentBytes = 16, kListHeader = 16;
/// Fragments that the lists hold at first; they grow to what a frame needs, up to the driver's limit.
constexpr std::size_t kFirstCapacity = 2'000'000;

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

void set_material(const Program& p, const HairMaterial& m, const SatfSettings& on) {
  const auto set = [&](const char* name, const glm::vec3& colour, float coefficient) {
    glUniform4f(p.at(name), colour.r, colour.g, colour.b, coefficient);
  };
  set("material.diffuse", m.diffuse_colour, on.diffuse ? m.diffuse : 0.0F);
  set("material.primary", m.primary_colour, on.primary_highlight ? m.primary : 0.0F);
  set("material.secondary", m.secondary_colour, on.secondary_highlight ? m.secondary : 0.0F);
  glUniform4f(p.at("material.shape"), m.primary_exponent, m.secondary_exponent, m.primary_shift, m.secondary_shift);
}

void set_lights(const Program& p, std::span<const Light> lights) {
  const std::size_t n = std::min(lights.size(), kMaxLights);
  glUniform1i(p.at("light_count"), static_cast<GLint>(n));
  for (std::size_t i = 0; i < n; ++i) {
    const std::string index = "[" + std::to_string(i) + "]";
    const glm::vec3 to_light = glm::normalize(lights[i].direction);
    const glm::vec3 colour = lights[i].intensity * lights[i].colour;
    glUniform3fv(p.at(("to_light" + index).c_str()), 1, glm::value_ptr(to_light));
    glUniform3fv(p.at(("light_colour" + index).c_str()), 1, glm::value_ptr(colour));
  }
}

glm::vec3 light_sum(std::span<const Light> lights) {
  glm::vec3 sum{0.0F};
  for (const Light& l : lights) sum += l.intensity * l.colour;
  return sum;
}

void attribute(GLuint location, GLint components, std::size_t stride, std::size_t offset) {
  glEnableVertexAttribArray(location);
  glVertexAttribPointer(location, components, GL_FLOAT, GL_FALSE, static_cast<GLsizei>(stride),
                        reinterpret_cast<const void*>(offset));
}

}  // namespace

struct Renderer::Resources {
  Program hair{"hair_surface.vert", "hair_surface.frag"};
  Program hair_lists{"hair_surface.vert", "hair_surface.frag", "#define PELAGE_PER_PIXEL_LISTS"};
  Program list_resolve{"screen.vert", "hair_list_resolve.frag"};
  Program head{"head.vert", "head.frag"};
  Program downsample{"screen.vert", "downsample.frag"};
  Program present{"screen.vert", "present.frag"};

  VertexArray hair_array, head_array, screen_array;
  Buffer hair_vertices, hair_indices, texels, maps, drift, views;
  Buffer head_vertices, head_indices, head_shadow;
  Buffer fragments, heads;

  std::size_t hair_index_count = 0, head_index_count = 0;
  std::size_t texels_per_light = 0, fragment_capacity = 0;
  int rows = 2, samples = 4, layers = 1, target_width = 0;
  float max_path = 4;
};

Renderer::Renderer() : gl_(std::make_unique<Resources>()) {
  check_opengl("building the shaders");
}
Renderer::~Renderer() = default;

void Renderer::set_head(const Mesh& head) {
  std::vector<glm::vec3> vertices;
  for (std::size_t i = 0; i < head.vertices.size(); ++i) {
    vertices.push_back(head.vertices[i]);
    vertices.push_back(head.normals[i]);
  }
  glBindVertexArray(gl_->head_array.id());
  gl_->head_vertices.upload(GL_ARRAY_BUFFER, std::span<const glm::vec3>(vertices), GL_STATIC_DRAW);
  attribute(0, 3, 2 * sizeof(glm::vec3), 0);
  attribute(1, 3, 2 * sizeof(glm::vec3), sizeof(glm::vec3));
  gl_->head_indices.upload(GL_ELEMENT_ARRAY_BUFFER, std::span<const glm::uvec3>(head.triangles), GL_STATIC_DRAW);
  gl_->head_index_count = 3 * head.triangles.size();
  set_head_shadow(std::vector<glm::vec4>(head.vertices.size(), glm::vec4(1.0F)));
}

void Renderer::set_head_shadow(std::span<const glm::vec4> transmittance) {
  glBindVertexArray(gl_->head_array.id());
  gl_->head_shadow.upload(GL_ARRAY_BUFFER, transmittance, GL_DYNAMIC_DRAW);
  attribute(2, 4, sizeof(glm::vec4), 0);
}

void Renderer::set_hair(const HairSurfaces& surfaces, const SatfModel& model, std::span<const Cluster> clusters) {
  glBindVertexArray(gl_->hair_array.id());
  gl_->hair_vertices.upload(GL_ARRAY_BUFFER, std::span<const SurfaceVertex>(surfaces.vertices), GL_STATIC_DRAW);
  attribute(0, 3, sizeof(SurfaceVertex), offsetof(SurfaceVertex, position));
  attribute(1, 3, sizeof(SurfaceVertex), offsetof(SurfaceVertex, tangent));
  attribute(2, 3, sizeof(SurfaceVertex), offsetof(SurfaceVertex, normal));
  attribute(3, 2, sizeof(SurfaceVertex), offsetof(SurfaceVertex, map_at));
  glEnableVertexAttribArray(4);
  glVertexAttribIPointer(4, 1, GL_UNSIGNED_INT, sizeof(SurfaceVertex),
                         reinterpret_cast<const void*>(offsetof(SurfaceVertex, map_id)));
  attribute(5, 2, sizeof(SurfaceVertex), offsetof(SurfaceVertex, azimuth));
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
  GLint most = 0;
  glGetIntegerv(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &most);
  if (texels.size_bytes() > static_cast<std::size_t>(most)) {
    throw GraphicsError("the maps take " + std::to_string(texels.size_bytes() >> 20) + " MiB, this driver allows " +
                        std::to_string(most >> 20) + ": use fewer clusters, layers, sectors, plates or lights");
  }
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
  target.bind();
  gl_->target_width = target.width();
  glClearColor(0, 0, 0, 0);
  glClearDepth(1.0);
  glDepthMask(GL_TRUE);
  glDisable(GL_CULL_FACE);
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  draw_head(request);
  glDepthMask(GL_FALSE);
  if (request.settings.draw_order == DrawOrder::exact) {
    draw_exact(request, target);
  } else {
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    draw_hair(request, false);
  }
  glDepthMask(GL_TRUE);
  check_opengl("drawing");
}

void Renderer::draw_head(const DrawRequest& request) {
  if (gl_->head_index_count == 0) return;
  glUseProgram(gl_->head.id());
  glUniformMatrix4fv(gl_->head.at("world_to_clip"), 1, GL_FALSE, glm::value_ptr(request.world_to_clip));
  set_lights(gl_->head, request.lights);
  const glm::vec3 skin = kSkin;
  glUniform3fv(gl_->head.at("skin"), 1, glm::value_ptr(skin));
  glUniform1f(gl_->head.at("ambient"), kHeadAmbient * light_sum(request.lights).g);
  glBindVertexArray(gl_->head_array.id());
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(gl_->head_index_count), GL_UNSIGNED_INT, nullptr);
}

void Renderer::draw_hair(const DrawRequest& request, bool lists) {
  if (gl_->hair_index_count == 0) return;
  const Program& p = lists ? gl_->hair_lists : gl_->hair;
  glUseProgram(p.id());
  glUniformMatrix4fv(p.at("world_to_clip"), 1, GL_FALSE, glm::value_ptr(request.world_to_clip));
  set_lights(p, request.lights);
  set_material(p, request.material, request.settings);
  const glm::vec3 ambient =
      request.settings.diffuse ? request.material.ambient * light_sum(request.lights) : glm::vec3(0.0F);
  glUniform3fv(p.at("ambient"), 1, glm::value_ptr(ambient));
  glUniform3fv(p.at("eye"), 1, glm::value_ptr(request.eye));
  glUniform1ui(p.at("texels_per_light"), static_cast<GLuint>(gl_->texels_per_light));
  glUniform1i(p.at("rows"), gl_->rows);
  glUniform1i(p.at("samples"), gl_->samples);
  glUniform1i(p.at("use_drift"), request.settings.drift ? 1 : 0);
  glUniform1i(p.at("use_curvature"), request.settings.curvature ? 1 : 0);
  glUniform1f(p.at("max_path"), gl_->max_path);
  glUniform1ui(p.at("layers"), static_cast<GLuint>(gl_->layers));
  glUniform1ui(p.at("plates_per_instance"), static_cast<GLuint>(gl_->rows));
  glUniform1i(p.at("fade_ends"), request.settings.fade_ends ? 1 : 0);
  if (lists) {
    glUniform1ui(p.at("fragment_capacity"), static_cast<GLuint>(gl_->fragment_capacity));
    glUniform1ui(p.at("heads_width"), static_cast<GLuint>(gl_->target_width));
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, gl_->fragments.id());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 4, gl_->heads.id());
  }
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, gl_->texels.id());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, gl_->maps.id());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, gl_->drift.id());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 5, gl_->views.id());
  glBindVertexArray(gl_->hair_array.id());
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(gl_->hair_index_count), GL_UNSIGNED_INT, nullptr);
}

void Renderer::draw_exact(const DrawRequest& request, Framebuffer& target) {
  GLint most = 0;
  glGetIntegerv(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &most);
  const std::size_t limit = (static_cast<std::size_t>(most) - kListHeader) / kFragmentBytes;
  if (gl_->fragment_capacity == 0) gl_->fragment_capacity = std::min(kFirstCapacity, limit);
  const std::vector<std::uint32_t> ends(
      static_cast<std::size_t>(target.width()) * static_cast<std::size_t>(target.height()), 0xffffffffU);
  for (;;) {
    gl_->fragments.allocate(GL_SHADER_STORAGE_BUFFER, kListHeader + gl_->fragment_capacity * kFragmentBytes,
                            GL_STREAM_COPY);
    const std::uint32_t zero = 0;
    glBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, sizeof zero, &zero);
    gl_->heads.upload(GL_SHADER_STORAGE_BUFFER, std::span<const std::uint32_t>(ends), GL_STREAM_COPY);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    draw_hair(request, true);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
    std::uint32_t used = 0;
    glBindBuffer(GL_SHADER_STORAGE_BUFFER, gl_->fragments.id());
    glGetBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, sizeof used, &used);
    if (used <= gl_->fragment_capacity) break;
    if (used > limit) {
      throw GraphicsError("exact order needs " + std::to_string(used) + " fragments, this driver holds " +
                          std::to_string(limit) + ": use a smaller --size or another --order");
    }
    gl_->fragment_capacity = std::min(limit, static_cast<std::size_t>(used) + used / 4);
  }
  glUseProgram(gl_->list_resolve.id());
  glUniform1ui(gl_->list_resolve.at("heads_width"), static_cast<GLuint>(target.width()));
  glDisable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glBindVertexArray(gl_->screen_array.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glEnable(GL_DEPTH_TEST);
}

void Renderer::read(Framebuffer& target, int supersampling, Image& out, int x0, int y0) {
  const int w = std::min(target.width() / supersampling, out.width - x0);
  const int h = std::min(target.height() / supersampling, out.height - y0);
  Framebuffer mean(target.width() / supersampling, target.height() / supersampling, GL_RGBA32F, false);
  mean.bind();
  glDisable(GL_BLEND);
  glDisable(GL_DEPTH_TEST);
  glUseProgram(gl_->downsample.id());
  glUniform1i(gl_->downsample.at("supersampling"), supersampling);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, target.colour());
  glBindVertexArray(gl_->screen_array.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  std::vector<float> rows(4U * static_cast<std::size_t>(mean.width()) * static_cast<std::size_t>(mean.height()));
  glReadPixels(0, 0, mean.width(), mean.height(), GL_RGBA, GL_FLOAT, rows.data());
  check_opengl("reading the picture");
  for (int y = 0; y < h; ++y) {
    // OpenGL's rows start at the bottom of the tile.
    const float* const from =
        rows.data() + 4U * static_cast<std::size_t>(mean.height() - 1 - y) * static_cast<std::size_t>(mean.width());
    std::copy_n(from, 4 * w, out.pixel(x0, y0 + y));
  }
}

void Renderer::present(Framebuffer& target, float exposure, const glm::vec3& background) {
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, 0, target.width(), target.height());
  glDisable(GL_BLEND);
  glDisable(GL_DEPTH_TEST);
  glUseProgram(gl_->present.id());
  glUniform1f(gl_->present.at("exposure"), exposure);
  glUniform3fv(gl_->present.at("background"), 1, glm::value_ptr(background));
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, target.colour());
  glBindVertexArray(gl_->screen_array.id());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  check_opengl("showing the picture");
}

std::vector<glm::vec4> Renderer::lobes_on_gpu(const HairMaterial& material, std::span<const glm::vec4> t_n_l_v) {
  const Program p("test_lobes.comp");
  const std::size_t n = t_n_l_v.size() / 4;
  Buffer in, out;
  in.upload(GL_SHADER_STORAGE_BUFFER, t_n_l_v, GL_STATIC_DRAW);
  out.allocate(GL_SHADER_STORAGE_BUFFER, n * sizeof(glm::vec4), GL_STREAM_READ);
  glUseProgram(p.id());
  set_material(p, material, SatfSettings{});
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, in.id());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, out.id());
  glDispatchCompute(static_cast<GLuint>((n + 63) / 64), 1, 1);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  std::vector<glm::vec4> results(n);
  glBindBuffer(GL_SHADER_STORAGE_BUFFER, out.id());
  glGetBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, static_cast<GLsizeiptr>(n * sizeof(glm::vec4)), results.data());
  check_opengl("the lobe test");
  return results;
}

}  // namespace pelage
