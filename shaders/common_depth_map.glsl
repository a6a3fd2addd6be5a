// Transmittance from depth maps in 3D textures, one for each light: GPU twin of DepthTexture in
// runtime/shadow/hair_shadow.h. To be included after common_lights.glsl. Eight fetches: the texture units of some GPUs
// interpolate with fractions of 8 bits, which would be seen in dense hair.

uniform sampler3D depth_map[kMaxLights];      // texel (z, y, x) is cell (x, y, z); x runs along the light
uniform mat4 world_to_cell[kMaxLights];
uniform bool map_is_transmittance[kMaxLights];  // not optical depth
uniform float tap_cells[kMaxLights];          // > 0: mean of four reads this far beside

/// One trilinear read at cell coordinates; outside the map the value at its border.
float transmittance_in_map(int light, vec3 at) {
  ivec3 size = textureSize(depth_map[light], 0).zyx;
  at = clamp(at, vec3(0.0), vec3(size - 1));
  ivec3 low = ivec3(at), next = min(low + 1, size - 1);  // at >= 0: truncation is floor
  vec3 f = at - vec3(low);
  float value = 0.0;
  for (int i = 0; i < 8; ++i) {
    bvec3 high = bvec3((i & 1) != 0, (i & 2) != 0, (i & 4) != 0);
    ivec3 cell = ivec3(high.x ? next.x : low.x, high.y ? next.y : low.y, high.z ? next.z : low.z);
    vec3 weight = mix(1.0 - f, f, high);
    value += weight.x * weight.y * weight.z * texelFetch(depth_map[light], cell.zyx, 0).r;
  }
  return map_is_transmittance[light] ? value : exp(-value);
}

float transmittance_at(int light, vec3 world) {
  vec3 at = (world_to_cell[light] * vec4(world, 1.0)).xyz;
  float tap = tap_cells[light];
  if (tap <= 0.0) return transmittance_in_map(light, at);
  float sum = 0.0;
  for (int i = 0; i < 4; ++i) {
    sum += transmittance_in_map(light, at + tap * vec3(0.0, (i & 1) != 0 ? 1.0 : -1.0, (i & 2) != 0 ? 1.0 : -1.0));
  }
  return 0.25 * sum;
}
