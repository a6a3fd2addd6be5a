#version 430 core
// The head under the hair: Lambert with wrap, shadowed by the hair.
const int kMaxLights = 4;
uniform int light_count;
uniform vec3 to_light[kMaxLights];
uniform vec3 light_colour[kMaxLights];
uniform vec3 skin;
uniform float ambient;

in vec3 world_normal;
in vec4 light_through;

layout(location = 0) out vec4 colour;

void main() {
  vec3 n = normalize(world_normal);
  vec3 sum = vec3(ambient);
  for (int i = 0; i < light_count; ++i) {
    float lambert = max((dot(n, to_light[i]) + 0.15) / 1.15, 0.0);
    sum += lambert * light_through[i] * light_colour[i];
  }
  colour = vec4(skin * sum, 1.0);
}
