#version 430 core
// To the window: exposure, background, sRGB curve; the same as runtime/image/tone.h does for files.
uniform sampler2D source;
uniform float exposure;
uniform vec3 background;  // linear
layout(location = 0) out vec4 colour;

void main() {
  vec4 c = texelFetch(source, ivec2(gl_FragCoord.xy), 0);
  vec3 linear = clamp(c.rgb * exposure + (1.0 - c.a) * background, 0.0, 1.0);
  vec3 srgb = mix(1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055, 12.92 * linear, lessThanEqual(linear, vec3(0.0031308)));
  colour = vec4(srgb, 1.0);
}
