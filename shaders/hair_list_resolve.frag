#version 430 core
// Exact order: sorts the fragments of each pixel by depth and blends them over the target, back to front (eq. 14).

struct Fragment { uint rg, ba; float depth; uint next; };
layout(std430, binding = 3) readonly buffer Fragments { uint fragment_count; uint pad0, pad1, pad2; Fragment fragments[]; };
layout(std430, binding = 4) readonly buffer Heads { uint heads[]; };
uniform uint heads_width;

layout(location = 0) out vec4 colour;

const int kMost = 256;  // of a pixel; older fragments of a longer list are left out
const uint kEnd = 0xffffffffu;

void main() {
  uint order[kMost];
  int count = 0;
  uint at = heads[uint(gl_FragCoord.y) * heads_width + uint(gl_FragCoord.x)];
  while (at != kEnd && count < kMost) {
    float depth = fragments[at].depth;
    int i = count++;
    // Fragments of equal depth keep the order of the list.
    while (i > 0 && fragments[order[i - 1]].depth < depth) {
      order[i] = order[i - 1];
      --i;
    }
    order[i] = at;
    at = fragments[at].next;
  }
  vec4 sum = vec4(0.0);
  for (int i = 0; i < count; ++i) {  // farthest first
    Fragment f = fragments[order[i]];
    vec2 ba = unpackHalf2x16(f.ba);
    vec4 c = vec4(unpackHalf2x16(f.rg), ba);
    sum = c + (1.0 - c.a) * sum;
  }
  colour = sum;
}
