#version 430 core
// Exact order: blends the fragments of each pixel front to back [Xu2006 eq. 14], the nearest kBatch at a time, until the
// list ends or hardly anything shines through. Lists may be of any length.

// A list's links are slots plus one, 0 ends it: helper invocations, which read 0, must not loop for ever.
struct Fragment { uint rg, ba; float depth; uint next; };
layout(std430, binding = 3) readonly buffer Fragments { uint fragment_count; uint pad0, pad1, pad2; Fragment fragments[]; };
layout(std430, binding = 4) readonly buffer Heads { uint heads[]; };
uniform uint heads_width;

layout(location = 0) out vec4 colour;

const int kBatch = 16;
const float kOpaque = 1.0 / 4096.0;  // half of what the half floats of a colour resolve

uint batch[kBatch];         // nearest first
float batch_depth[kBatch];  // theirs

/// Is fragment a, of this depth, nearer than b? A total order that does not depend on the order of drawing, but for
/// fragments that are the same anyway.
bool nearer(uint a, float depth_a, uint b, float depth_b) {
  if (depth_a != depth_b) return depth_a < depth_b;
  Fragment f = fragments[a - 1u], g = fragments[b - 1u];
  if (f.ba != g.ba) return f.ba < g.ba;
  if (f.rg != g.rg) return f.rg < g.rg;
  return a < b;
}

void main() {
  uint head = heads[uint(gl_FragCoord.y) * heads_width + uint(gl_FragCoord.x)];
  if (head == 0u) discard;
  uint last = 0u;  // the farthest that was blended
  float last_depth = 0.0;
  int count = kBatch;
  vec3 sum = vec3(0.0);
  float through = 1.0;
  while (count == kBatch && through > kOpaque) {
    count = 0;
    uint at = head;
    while (at != 0u) {
      float depth = fragments[at - 1u].depth;
      bool behind = last == 0u || nearer(last, last_depth, at, depth);
      if (behind && (count < kBatch || nearer(at, depth, batch[kBatch - 1], batch_depth[kBatch - 1]))) {
        count = min(count + 1, kBatch);
        int i = count - 1;
        while (i > 0) {
          // Not part of the loop's condition: Mesa 22.3 then reads batch[-1] and sorts wrongly.
          if (!nearer(at, depth, batch[i - 1], batch_depth[i - 1])) break;
          batch[i] = batch[i - 1];
          batch_depth[i] = batch_depth[i - 1];
          --i;
        }
        batch[i] = at;
        batch_depth[i] = depth;
      }
      at = fragments[at - 1u].next;
    }
    for (int i = 0; i < count; ++i) {
      Fragment f = fragments[batch[i] - 1u];
      vec2 ba = unpackHalf2x16(f.ba);
      sum += through * vec3(unpackHalf2x16(f.rg), ba.x);
      through *= 1.0 - ba.y;
    }
    if (count > 0) {
      last = batch[count - 1];
      last_depth = batch_depth[count - 1];
    }
  }
  colour = vec4(sum, 1.0 - through);
}
