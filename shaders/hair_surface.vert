#version 430 core
// Surfaces of the cluster layers: positions come ready from the CPU (runtime/render/hair_surfaces.h).

layout(location = 0) in vec3 position;  // metres
layout(location = 1) in vec3 tangent;   // along the strands, towards the tip
layout(location = 2) in vec3 normal;    // of the layer, outward
layout(location = 3) in vec2 map_at;    // texel around (unwrapped), plate (fractional)
layout(location = 4) in uint map_id;    // instance * layers + layer, + the highest bit on inner surfaces
layout(location = 5) in vec2 azimuth;   // cos and sin of u

layout(std430, binding = 5) readonly buffer Views { float views[]; };  // [instance][plate] cos phi, sin phi, trust

uniform mat4 world_to_clip;
uniform uint layers;
uniform uint plates_per_instance;

out vec3 world;
out vec3 world_tangent;
out vec3 world_normal;
out vec2 at;
out vec3 view_in_disk;  // cos and sin of the angle from outward to the viewer, and how far to trust it
flat out uint map_of;
flat out uint inner_surface;

void main() {
  world = position;
  world_tangent = tangent;
  world_normal = normal;
  at = map_at;
  map_of = map_id & 0x7fffffffu;
  inner_surface = map_id >> 31;
  uint view = 3u * (map_of / layers * plates_per_instance + uint(map_at.y));
  float cos_phi = views[view], sin_phi = views[view + 1u];
  view_in_disk = vec3(cos_phi * azimuth.x + sin_phi * azimuth.y, sin_phi * azimuth.x - cos_phi * azimuth.y, views[view + 2u]);
  gl_Position = world_to_clip * vec4(position, 1.0);
}
