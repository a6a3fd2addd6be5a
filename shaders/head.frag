#version 430 core
// The head under the hair: Lambert with wrap, shadowed by the hair.

#include "common_lights.glsl"

uniform vec3 skin;
uniform float ambient;  // unshadowed share

in vec3 world;
in vec3 world_normal;
in vec4 light_through;

layout(location = 0) out vec4 colour;

void main() {
  vec3 n = normalize(world_normal);
  vec3 sum = vec3(0.0);
  for (int i = 0; i < light_count; ++i) {
    Arriving light = arriving(i, world);
    float lambert = max((dot(n, light.to_light) + 0.15) / 1.15, 0.0);
    sum += (lambert * light_through[i] + ambient) * light.irradiance;
  }
  colour = vec4(skin * sum, 1.0);
}
