#version 430 core
// Strands as camera-facing ribbons or as lines, pulled from buffers without vertex attributes: 6 vertices (two
// triangles) of a ribbon's segment, 2 of a line's.
//
// Corners where segments meet are mitred: both segments compute the same ones, so that there is neither gap nor
// overlap. Beyond a turn of 120 degrees in the picture each segment ends square instead; at a turn of 180 degrees, where
// a curl is seen from its side, the two ends coincide again.
//
// Coverage: where a strand is thinner than a sample it is drawn one sample wide, and its opacity fades by as much. Both
// widths are interpolated, not their quotient: a strand may taper from wider than a sample to nothing.

layout(std430, binding = 0) readonly buffer Vertices { vec4 vertices[]; };             // metres; w: drawn diameter [m]
layout(std430, binding = 1) readonly buffer Tangents { vec4 tangents[]; };             // unit, towards the tip
layout(std430, binding = 2) readonly buffer Transmittances { vec4 transmittances[]; }; // a component for each light
layout(std430, binding = 5) readonly buffer Segments { uvec2 segments[]; };            // in drawing order, see below
layout(std430, binding = 6) readonly buffer Colours { vec4 colours[]; };               // [strand]
layout(std430, binding = 7) readonly buffer Tints { vec4 tints[]; };                   // [strand]

// Of a segment: x: its first vertex and these flags; y: its strand.
const uint kFirst = 0x80000000u, kLast = 0x40000000u, kVertex = 0x3fffffffu;

uniform mat4 world_to_clip;
uniform vec3 eye;
uniform vec2 samples_across;   // half the size of the target in samples
uniform float sample_slope;    // width of a sample at 1 m depth [m]
uniform bool ribbons;
uniform bool own_colours;
uniform bool tinted;           // colours vary from strand to strand

out vec3 world;                // on the centre line
out vec3 world_tangent;
out vec4 light_through;
out vec2 widths_m;             // of the strand, and as drawn
flat out vec4 fibre_colour;    // a = 0: the material's
flat out vec3 fibre_tint;      // factor on either

/// Unit vector across a segment as seen along v; 0 where it is seen end on or has no length.
vec3 across(vec3 segment, vec3 v) {
  vec3 c = cross(segment, v);
  float most = length(segment) * length(v), sine = length(c);
  return sine > 1e-5 * most ? c / sine : vec3(0.0);
}

/// Across the ribbon at an end of a segment that has `own`, where the next one, if it is `joined` to one, has `other`.
vec3 corner(vec3 own, vec3 other, bool joined) {
  if (!joined) return own;
  float turn = dot(own, other);                    // cosine
  return turn > -0.5 ? (own + other) / (1.0 + turn) : own;  // as long as 1 / cos(half the turn)
}

/// Samples that a line of one sample's width would cover over those that the rasteriser gives it.
float line_stretch(vec4 a, vec4 b) {
  if (a.w <= 0.0 || b.w <= 0.0) return 1.0;
  vec2 d = abs((b.xy / b.w - a.xy / a.w) * samples_across);
  float major = max(d.x, d.y);
  return major > 0.0 ? length(d) / major : 1.0;
}

void main() {
  const int kCorners[6] = int[6](0, 1, 2, 2, 1, 3);  // bit 1: the segment's far end, bit 0: the side
  int count = ribbons ? 6 : 2;
  uvec2 segment = segments[gl_VertexID / count];
  int place = ribbons ? kCorners[gl_VertexID % 6] : 2 * (gl_VertexID % 2);
  bool far_end = place >= 2;
  uint first = segment.x & kVertex, at = far_end ? first + 1u : first;

  world = vertices[at].xyz;
  world_tangent = tangents[at].xyz;
  light_through = transmittances[at];
  fibre_colour = own_colours ? vec4(colours[segment.y].rgb, 1.0) : vec4(0.0);
  fibre_tint = tinted ? tints[segment.y].rgb : vec3(1.0);
  vec4 clip = world_to_clip * vec4(world, 1.0);
  float diameter_m = vertices[at].w, sample_m = sample_slope * clip.w;
  if (!ribbons) {
    float stretch = line_stretch(world_to_clip * vec4(vertices[first].xyz, 1.0),
                                 world_to_clip * vec4(vertices[first + 1u].xyz, 1.0));
    widths_m = vec2(min(diameter_m * stretch, sample_m), sample_m);
    gl_Position = clip;
    return;
  }
  float width_m = max(diameter_m, sample_m);
  widths_m = vec2(diameter_m, width_m);
  vec3 v = eye - world;
  vec3 own = across(vertices[first + 1u].xyz - vertices[first].xyz, v);
  bool joined = (segment.x & (far_end ? kLast : kFirst)) == 0u;
  vec3 other = vec3(0.0);
  if (joined) other = across(vertices[far_end ? at + 1u : at].xyz - vertices[far_end ? at : at - 1u].xyz, v);
  vec3 side = corner(own, other, joined);
  float half_width = ((place & 1) == 0 ? -0.5 : 0.5) * width_m;
  gl_Position = world_to_clip * vec4(world + half_width * side, 1.0);
}
