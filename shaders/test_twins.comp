#version 430 core
// Evaluates shared blocks for tests/render: the GPU twins against runtime/shading and DepthTexture.
#include "common_head.glsl"
#include "common_lobes.glsl"
#include "common_lights.glsl"
#include "common_depth_map.glsl"

layout(local_size_x = 64) in;
struct Case { vec4 t, n, l, v, at; };
struct Result { vec4 lighting, facing, to_light, irradiance; };  // facing.w: transmittance of the first map; lighting.w, irradiance.w: of the head
layout(std430, binding = 0) readonly buffer Cases { Case cases[]; };
layout(std430, binding = 1) writeonly buffer Results { Result results[]; };
uniform HairMaterial material;
uniform bool use_map;
uniform vec2 azimuth;

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= uint(cases.length())) return;
  Case c = cases[i];
  Arriving light = arriving(0, c.at.xyz);
  float through = use_map ? transmittance_at(0, c.at.xyz) : 1.0;
  results[i] = Result(vec4(hair_lighting(material, c.t.xyz, c.n.xyz, c.l.xyz, c.v.xyz), head_direct(c.n.xyz, c.l.xyz)),
                      vec4(facing_normal(c.t.xyz, c.v.xyz), through), vec4(light.to_light, azimuth_mean(azimuth, c.t.xyz, c.v.xyz, c.l.xyz)), vec4(light.irradiance, head_ambient(c.n.xyz)));
}
