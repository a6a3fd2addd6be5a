// Transmittance from depth maps in 3D textures, one for each light: GPU twin of DepthTexture in
// runtime/shadow/hair_shadow.h. To be included after common_lights.glsl. Eight fetches: the texture units of some GPUs
// interpolate with fractions of 8 bits, which would be seen in dense hair.

uniform sampler3D depth_map[kMaxLights];  // texel (z, y, x) is cell (x, y, z); x runs along the light
uniform mat4 world_to_cell[kMaxLights];

/// Optical depth of a cell that lies within the map along the light; 0 beside it.
float depth_of_cell(int light, ivec3 cell, ivec3 size) {
  bool beside = any(lessThan(cell.yz, ivec2(0))) || any(greaterThanEqual(cell.yz, size.yz));
  return beside ? 0.0 : texelFetch(depth_map[light], cell.zyx, 0).r;
}

float transmittance_at(int light, vec3 world) {
  ivec3 size = textureSize(depth_map[light], 0).zyx;
  vec3 at = (world_to_cell[light] * vec4(world, 1.0)).xyz;
  at.x = clamp(at.x, 0.0, float(size.x - 1));
  // Far beside the map all is 0; the bounds keep whole numbers from overflowing.
  at.yz = clamp(at.yz, vec2(-2.0), vec2(size.yz) + 1.0);
  ivec3 low = ivec3(floor(at));
  vec3 f = at - vec3(low);
  int next = min(low.x + 1, size.x - 1);
  float depth = 0.0;
  for (int i = 0; i < 4; ++i) {
    ivec2 yz = low.yz + ivec2(i & 1, i >> 1);
    float weight = ((i & 1) == 1 ? f.y : 1.0 - f.y) * (i >= 2 ? f.z : 1.0 - f.z);
    depth += weight * mix(depth_of_cell(light, ivec3(low.x, yz), size), depth_of_cell(light, ivec3(next, yz), size), f.x);
  }
  return exp(-depth);
}
