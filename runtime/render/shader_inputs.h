// What every shader of this renderer is given the same way: lights, material, vertex attributes.
#pragma once

#include <cstddef>
#include <span>

#include "pelage/data_schema/scene.h"
#include "pelage/render/gl_objects.h"
#include "pelage/shading/lobes.h"

namespace pelage {

/// Most lights of a frame.
inline constexpr std::size_t kMaxLights = 4;

/// @throws UsageError for more than kMaxLights
void check_light_count(std::span<const Light> lights);

/// Uniforms of common_lights.glsl.
void set_lights(const Program& p, std::span<const Light> lights);
/// Uniform `material` of common_lobes.glsl; what is off has coefficient 0.
void set_material(const Program& p, const HairMaterial& material, const LobeSwitches& on);

/// Uniforms of common_head.glsl.
void set_head_material(const Program& p);

/// Floats of the buffer bound to GL_ARRAY_BUFFER.
void vertex_attribute(GLuint location, GLint components, std::size_t stride, std::size_t offset);

/// Binds a buffer to a shader's storage block. @throws GraphicsError naming `what` and `remedy` when the driver's
/// blocks are smaller
void bind_storage(GLuint binding, const Buffer& buffer, const char* what, const char* remedy);

}  // namespace pelage
