#version 430 core
// To the window: exposure, background, sRGB curve; the same as runtime/image/tone.h does for files.
uniform sampler2D source;
uniform float exposure;
uniform vec3 background;  // linear
uniform bool gradient;    // a backdrop that is darker towards the corners
uniform vec2 size;        // of the window [pixels]
layout(location = 0) out vec4 colour;

/// Twin of backdrop_gain() there.
float backdrop_gain() {
  if (!gradient) return 1.0;
  vec2 at = vec2(gl_FragCoord.x, size.y - gl_FragCoord.y);  // rows from the top
  float off = length(at - vec2(0.5, 0.42) * size) / (0.5 * length(size));
  return mix(1.0, 0.45, smoothstep(0.0, 1.0, off));
}

void main() {
  vec4 c = texelFetch(source, ivec2(gl_FragCoord.xy), 0);
  vec3 linear = clamp(c.rgb * exposure + (1.0 - c.a) * backdrop_gain() * background, 0.0, 1.0);
  vec3 srgb = mix(1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055, 12.92 * linear, lessThanEqual(linear, vec3(0.0031308)));
  colour = vec4(srgb, 1.0);
}
