#version 430 core
// Surfaces of the cluster layers: positions come ready from the CPU (runtime/render/hair_surfaces.h).

layout(location = 0) in vec3 position;  // metres
layout(location = 1) in vec3 tangent;   // along the strands, towards the tip
layout(location = 2) in vec3 normal;    // of the layer, outward
layout(location = 3) in vec2 map_at;    // texel around (unwrapped), plate (fractional)
layout(location = 4) in uint map_id;    // instance * layers + layer

uniform mat4 world_to_clip;

out vec3 world;
out vec3 world_tangent;
out vec3 world_normal;
out vec2 at;
flat out uint map_of;

void main() {
  world = position;
  world_tangent = tangent;
  world_normal = normal;
  at = map_at;
  map_of = map_id;
  gl_Position = world_to_clip * vec4(position, 1.0);
}
