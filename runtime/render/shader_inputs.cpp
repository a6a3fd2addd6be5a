#include "pelage/render/shader_inputs.h"

#include <algorithm>
#include <glm/gtc/type_ptr.hpp>
#include <string>

#include "pelage/data_schema/errors.h"
#include "pelage/shading/head_lighting.h"

namespace pelage {

void check_light_count(std::span<const Light> lights) {
  if (lights.size() <= kMaxLights) return;
  throw UsageError("the scene has " + std::to_string(lights.size()) + " lights; at most " + std::to_string(kMaxLights) +
                   " are drawn");
}

void set_lights(const Program& p, std::span<const Light> lights) {
  const std::size_t n = std::min(lights.size(), kMaxLights);
  glUniform1i(p.at("light_count"), static_cast<GLint>(n));
  for (std::size_t i = 0; i < n; ++i) {
    const Light& light = lights[i];
    const std::string index = "[" + std::to_string(i) + "]";
    const glm::vec4 at =
        light.position ? glm::vec4(*light.position, 1.0F) : glm::vec4(glm::normalize(light.direction), 0.0F);
    const glm::vec3 colour = light.intensity * light.colour;
    glUniform4fv(p.at(("light_at" + index).c_str()), 1, glm::value_ptr(at));
    glUniform3fv(p.at(("light_colour" + index).c_str()), 1, glm::value_ptr(colour));
  }
}

void set_material(const Program& p, const HairMaterial& m, const LobeSwitches& on) {
  const auto set = [&](const char* name, const glm::vec3& colour, float coefficient) {
    glUniform4f(p.at(name), colour.r, colour.g, colour.b, coefficient);
  };
  set("material.diffuse", m.diffuse_colour, on.diffuse ? m.diffuse : 0.0F);
  set("material.primary", m.primary_colour, on.primary ? m.primary : 0.0F);
  set("material.secondary", m.secondary_colour, on.secondary ? m.secondary : 0.0F);
  glUniform4f(p.at("material.shape"), m.primary_exponent, m.secondary_exponent, m.primary_shift, m.secondary_shift);
}

void set_head_material(const Program& p) {
  glUniform3f(p.at("head_colour"), kHeadColour.r, kHeadColour.g, kHeadColour.b);
  glUniform3f(p.at("head_shape"), kHeadAmbient, kHeadSky, kHeadWrap);
}

void vertex_attribute(GLuint location, GLint components, std::size_t stride, std::size_t offset) {
  glEnableVertexAttribArray(location);
  glVertexAttribPointer(location, components, GL_FLOAT, GL_FALSE, static_cast<GLsizei>(stride),
                        reinterpret_cast<const void*>(offset));
}

void bind_storage(GLuint binding, const Buffer& buffer, const char* what, const char* remedy) {
  GLint most = 0;
  glGetIntegerv(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &most);
  if (buffer.bytes() > static_cast<std::size_t>(most)) {
    throw GraphicsError(std::string(what) + " take " + std::to_string(buffer.bytes() >> 20) +
                        " MiB, this driver allows " + std::to_string(most >> 20) + ": " + remedy);
  }
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, buffer.id());
}

}  // namespace pelage
