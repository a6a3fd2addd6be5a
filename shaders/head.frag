#version 430 core
// The head under the hair, shadowed by the hair.

#include "common_head.glsl"
#include "common_lights.glsl"

in vec3 world;
in vec3 world_normal;
in vec4 light_through;

layout(location = 0) out vec4 colour;

void main() {
  vec3 n = normalize(world_normal);
  vec3 sum = vec3(0.0);
  for (int i = 0; i < light_count; ++i) {
    Arriving light = arriving(i, world);
    sum += (head_direct(n, light.to_light) * light_through[i] + head_ambient(n)) * light.irradiance;
  }
  colour = vec4(head_colour * sum, 1.0);
}
