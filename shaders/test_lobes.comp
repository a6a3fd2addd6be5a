#version 430 core
// Evaluates the lobes for tests/render: the GPU twin against runtime/shading/lobes.h.
#include "common_lobes.glsl"

layout(local_size_x = 64) in;
struct Case { vec4 t, n, l, v; };
layout(std430, binding = 0) readonly buffer Cases { Case cases[]; };
layout(std430, binding = 1) writeonly buffer Results { vec4 results[]; };
uniform HairMaterial material;

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= uint(cases.length())) return;
  Case c = cases[i];
  results[i] = vec4(hair_lighting(material, c.t.xyz, c.n.xyz, c.l.xyz, c.v.xyz), 1.0);
}
