#version 430 core
// Shading of a strand [KajiyaKay1989; Scheuermann2004] with shadow by vertex, or by fragment from a depth map
// (PELAGE_SHADOW_AT_FRAGMENT), and unshadowed ambient light [Bertails2005 section 3.3].

#include "common_lobes.glsl"
#include "common_lights.glsl"
#ifdef PELAGE_SHADOW_AT_FRAGMENT
#include "common_depth_map.glsl"
#endif
#include "common_output.glsl"

uniform vec3 eye;
uniform HairMaterial material;
uniform float ambient;  // share of the diffuse colour
uniform float opacity;  // of a fibre
uniform vec2 azimuth;   // of azimuth_mean()

in vec3 world;
in vec3 world_tangent;
in vec4 light_through;
in vec2 widths_m;
flat in vec4 fibre_colour;
flat in vec3 fibre_tint;

float shadow(int light) {
#ifdef PELAGE_SHADOW_AT_FRAGMENT
  return transmittance_at(light, world);
#else
  return light_through[light];
#endif
}

/// Unit; where there is no direction, any.
vec3 direction(vec3 d, vec3 otherwise) {
  float size = length(d);
  return size > 1e-6 ? d / size : otherwise;
}

void main() {
  if (!reserve_fragment()) return;
  HairMaterial m = material;
  if (fibre_colour.a > 0.0) {
    m.diffuse.rgb = fibre_colour.rgb;
    m.secondary.rgb = fibre_colour.rgb;
  }
  m.diffuse.rgb *= fibre_tint;
  m.secondary.rgb *= fibre_tint;
  vec3 t = direction(world_tangent, vec3(0.0, 1.0, 0.0));  // half-way between opposite tangents
  vec3 v = direction(eye - world, vec3(0.0, 0.0, 1.0));
  vec3 n = facing_normal(t, v);
  vec3 sum = vec3(0.0);
  for (int i = 0; i < light_count; ++i) {
    Arriving light = arriving(i, world);
    vec3 lit = azimuth_mean(azimuth, t, v, light.to_light) * hair_lighting(m, t, n, light.to_light, v);
    sum += (shadow(i) * lit + ambient * m.diffuse.rgb) * light.irradiance;
  }
  float alpha = widths_m.y > 0.0 ? opacity * clamp(widths_m.x / widths_m.y, 0.0, 1.0) : 0.0;
  put_fragment(alpha * vec4(sum, 1.0));
}
