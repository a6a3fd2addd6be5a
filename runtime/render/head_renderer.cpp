#include "pelage/render/head_renderer.h"

#include <glm/gtc/type_ptr.hpp>
#include <vector>

#include "pelage/data_schema/lighting.h"
#include "pelage/render/shader_inputs.h"

namespace pelage {
std::vector<float> head_shadow(const Light& light, std::size_t vertices, const ShadowFrom& from) {
  const std::vector<Light> parts = parts_of(light);
  std::vector<float> one(vertices), sum(vertices, 0.0F);
  for (const Light& part : parts) {
    from(part, one);
    for (std::size_t v = 0; v < vertices; ++v) sum[v] += one[v];
  }
  for (float& t : sum) t /= static_cast<float>(parts.size());
  return sum;
}

void HeadRenderer::set_head(const Mesh& head) {
  std::vector<glm::vec3> vertices;
  for (std::size_t i = 0; i < head.vertices.size(); ++i) {
    vertices.push_back(head.vertices[i]);
    vertices.push_back(head.normals[i]);
  }
  glBindVertexArray(array_.id());
  vertices_.upload(GL_ARRAY_BUFFER, std::span<const glm::vec3>(vertices), GL_STATIC_DRAW);
  vertex_attribute(0, 3, 2 * sizeof(glm::vec3), 0);
  vertex_attribute(1, 3, 2 * sizeof(glm::vec3), sizeof(glm::vec3));
  indices_.upload(GL_ELEMENT_ARRAY_BUFFER, std::span<const glm::uvec3>(head.triangles), GL_STATIC_DRAW);
  index_count_ = 3 * head.triangles.size();
  set_shadow(std::vector<glm::vec4>(head.vertices.size(), glm::vec4(1.0F)));
}

void HeadRenderer::set_shadow(std::span<const glm::vec4> transmittance) {
  glBindVertexArray(array_.id());
  shadow_.upload(GL_ARRAY_BUFFER, transmittance, GL_DYNAMIC_DRAW);
  vertex_attribute(2, 4, sizeof(glm::vec4), 0);
}

void HeadRenderer::begin_picture(const glm::mat4& world_to_clip, std::span<const Light> lights, Framebuffer& target) {
  target.bind();
  glClearColor(0, 0, 0, 0);
  glClearDepth(1.0);
  glDepthMask(GL_TRUE);
  glDisable(GL_CULL_FACE);
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  if (index_count_ > 0) {
    glUseProgram(program_.id());
    glUniformMatrix4fv(program_.at("world_to_clip"), 1, GL_FALSE, glm::value_ptr(world_to_clip));
    set_lights(program_, lights);
    set_head_material(program_);
    glBindVertexArray(array_.id());
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(index_count_), GL_UNSIGNED_INT, nullptr);
  }
  glDepthMask(GL_FALSE);
}

}  // namespace pelage
