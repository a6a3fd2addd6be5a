#version 430 core
// Shading of a layer from its re-, alpha- and s-maps [Xu2006 eqs. 7, 8, 13]. Premultiplied output for eq. 14.
//
// Eq. 7 interpolates the two plates of an HSV. Here both rows are first moved by the HSV's mean drift, so that a strand
// that crosses the sector moves instead of fading (DESIGN section 5), and averaged over the pixel's footprint around.

#include "common_lobes.glsl"
#include "common_lights.glsl"
#include "common_output.glsl"

struct MapInfo {
  uint first_texel;  // of row 0
  uint width;        // texels around
  uint first_drift;  // of the layer's first track
  uint sectors;      // around
  vec4 colour;       // of the cluster; a = 0: the material's
  vec4 ring;         // inner and outer radius v, width and height of a sector, in disk coordinates
};

layout(std430, binding = 0) readonly buffer Texels { uint texels[]; };       // [light][texel], see satf/maps.h
layout(std430, binding = 1) readonly buffer Maps { MapInfo maps[]; };        // [instance * layers + layer]
layout(std430, binding = 2) readonly buffer Drift { float drift[]; };        // [sector] change of s to the next plate

uniform uint texels_per_light;
uniform int rows;                     // plates + 1
uniform int samples;                  // of a record along s
uniform bool use_drift;
uniform bool fade_ends;
uniform bool use_curvature;
uniform float max_path;               // longest march of a record, in heights of a sector
uniform vec3 eye;
uniform HairMaterial material;
uniform float ambient;                // unshadowed share of the diffuse colour [Bertails2005 section 3.3]

in vec3 world;
in vec3 world_tangent;
in vec3 world_normal;
in vec2 at;
in vec3 view_in_disk;
flat in uint map_of;
flat in uint inner_surface;

/// Premultiplied: (alpha, alpha * re, alpha * transmittance * re) of one texel.
vec3 texel(MapInfo map, uint light, int row, int x) {
  int width = int(map.width);
  x = x % width;
  if (x < 0) x += width;
  uint t = texels[light * texels_per_light + map.first_texel + uint(row) * map.width + uint(x)];
  float alpha = float(t & 1023u) / 1023.0;
  float re = float((t >> 10) & 4095u) * (8.0 / 4095.0);
  float transmittance = float(t >> 22) / 1023.0;
  return vec3(alpha, alpha * re, alpha * re * transmittance);
}

/// Mean over [x - footprint / 2, x + footprint / 2] of a row that is linear between texel centres.
vec3 row_mean(MapInfo map, uint light, int row, float x, float footprint) {
  int taps = clamp(int(ceil(footprint)), 1, 16);
  vec3 sum = vec3(0.0);
  for (int i = 0; i < taps; ++i) {
    float p = x - 0.5 + footprint * ((float(i) + 0.5) / float(taps) - 0.5);
    float base = floor(p);
    sum += mix(texel(map, light, row, int(base)), texel(map, light, row, int(base) + 1), p - base);
  }
  return sum / float(taps);
}

/// Open cluster ends fade, or they would show as cut tubes: the tip over one HSV, the root, which sits in the scalp, over
/// a quarter of one.
float end_fade(float plate) {
  return fade_ends ? clamp(4.0 * plate, 0.0, 1.0) * clamp(float(rows - 1) - plate, 0.0, 1.0) : 1.0;
}

/// Mean drift of the HSV at this azimuth, in texels.
float drift_at(MapInfo map, int row) {
  float k = at.x / float(map.width) * float(map.sectors) - 0.5;
  int n = int(map.sectors);
  int k0 = (int(floor(k)) + n) % n, k1 = (k0 + 1) % n;
  float d0 = drift[map.first_drift + uint(k0 * rows + row)];
  float d1 = drift[map.first_drift + uint(k1 * rows + row)];
  return mix(d0, d1, fract(k)) * float(samples);
}

/// Chord of the curved ring over the path in a flat slab; twin of satf/plate_direction.cpp. On the outer surface the near
/// side's, on the inner one the far side's, also where a polygon's silhouette is not quite the circle's.
float chord_ratio(vec4 ring, float cos_t) {
  float inner = ring.x, outer = ring.y;
  float abs_cos = abs(cos_t), sin2 = max(0.0, 1.0 - cos_t * cos_t);
  float metric = sqrt(sin2 / (ring.z * ring.z) + (abs_cos * abs_cos) / (ring.w * ring.w));
  float to_inner = inner * inner - outer * outer * sin2;
  float hits_inner = clamp(0.5 + 0.5 * to_inner / 0.03, 0.0, 1.0);  // kTangentBlend
  float front = (2.0 - hits_inner) * outer * abs_cos - sqrt(max(to_inner, 0.0));
  float back = sqrt(max(outer * outer - inner * inner * sin2, 0.0)) - inner * abs_cos;
  float slab = min(ring.w / max(abs_cos, 1e-6), max_path / metric);
  return (inner_surface == 0u ? front : back) / slab;
}

void main() {
  MapInfo map = maps[map_of];
  int row = clamp(int(floor(at.y)), 0, rows - 2);
  float along = clamp(at.y - float(row), 0.0, 1.0);
  float footprint = clamp(fwidth(at.x), 0.0, 16.0);
  float moved = use_drift ? drift_at(map, row) : 0.0;

  vec3 t = normalize(world_tangent);
  vec3 n = normalize(world_normal);
  vec3 v = normalize(eye - world);
  HairMaterial m = material;
  if (map.colour.a > 0.0) {
    m.diffuse.rgb = map.colour.rgb;
    m.secondary.rgb = map.colour.rgb;
  }

  float alpha = 0.0;
  vec3 premultiplied = vec3(0.0);
  for (int i = 0; i < light_count; ++i) {
    vec3 here = row_mean(map, uint(i), row, at.x - moved * along, footprint);
    vec3 next = row_mean(map, uint(i), row + 1, at.x + moved * (1.0 - along), footprint);
    vec3 mean = end_fade(at.y) * mix(here, next, along);
    alpha = mean.x;
    Arriving light = arriving(i, world);
    vec3 lit = mean.z * hair_lighting(m, t, n, light.to_light, v) + alpha * ambient * m.diffuse.rgb;
    premultiplied += lit * light.irradiance;
  }
  if (alpha < 1.0 / 2048.0) discard;
  if (use_curvature) {
    float cos_t = view_in_disk.x / max(length(view_in_disk.xy), 1e-6);
    cos_t = inner_surface == 0u ? max(cos_t, 0.0) : min(cos_t, 0.0);
    float curved = 1.0 - pow(max(1.0 - alpha, 0.0), 1.0 + view_in_disk.z * (chord_ratio(map.ring, cos_t) - 1.0));
    premultiplied *= curved / alpha;
    alpha = curved;
  }
  if (reserve_fragment()) put_fragment(vec4(premultiplied, alpha));
}
