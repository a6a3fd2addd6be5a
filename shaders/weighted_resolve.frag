#version 430 core
// Weighted mean of a pixel's fragments, with the opacity that they have in any order [McGuireBavoil2013 eq. 7].
uniform sampler2D weighted_colour;
uniform sampler2D weighted_alpha;
layout(location = 0) out vec4 colour;

void main() {
  vec4 sum = texelFetch(weighted_colour, ivec2(gl_FragCoord.xy), 0);
  float weights = texelFetch(weighted_alpha, ivec2(gl_FragCoord.xy), 0).r;
  if (weights <= 0.0) discard;
  float alpha = 1.0 - sum.a;
  colour = vec4(alpha / weights * sum.rgb, alpha);
}
