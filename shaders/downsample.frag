#version 430 core
// Mean of the samples of a pixel (box filter), in linear light.
uniform sampler2D source;
uniform int supersampling;
layout(location = 0) out vec4 colour;

void main() {
  ivec2 base = ivec2(gl_FragCoord.xy) * supersampling;
  vec4 sum = vec4(0.0);
  for (int y = 0; y < supersampling; ++y) {
    for (int x = 0; x < supersampling; ++x) sum += texelFetch(source, base + ivec2(x, y), 0);
  }
  colour = sum / float(supersampling * supersampling);
}
