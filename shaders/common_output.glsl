// Where a transparent fragment goes: if (reserve_fragment()) put_fragment(premultiplied colour and alpha), so that what
// does not fit is counted but not shaded. By define: into its pixel's list
// (PELAGE_PER_PIXEL_LISTS, runtime/render/fragment_lists.h), into weighted sums (PELAGE_WEIGHTED,
// runtime/render/weighted_blend.h), or into the target, where it is blended in the order of drawing.

#if defined(PELAGE_PER_PIXEL_LISTS)
layout(early_fragment_tests) in;
struct Fragment { uint rg, ba; float depth; uint next; };
layout(std430, binding = 3) buffer Fragments { uint fragment_count; uint pad0, pad1, pad2; Fragment fragments[]; };
layout(std430, binding = 4) buffer Heads { uint heads[]; };
uniform uint fragment_capacity;
uniform uint heads_width;

uint fragment_slot;
bool reserve_fragment() {
  fragment_slot = atomicAdd(fragment_count, 1u);
  return fragment_slot < fragment_capacity;
}

void put_fragment(vec4 premultiplied) {
  uint pixel = uint(gl_FragCoord.y) * heads_width + uint(gl_FragCoord.x);
  uint next = atomicExchange(heads[pixel], fragment_slot + 1u);  // links are slots plus one, 0 ends a list
  fragments[fragment_slot] = Fragment(packHalf2x16(premultiplied.rg), packHalf2x16(premultiplied.ba), gl_FragCoord.z, next);
}
#elif defined(PELAGE_WEIGHTED)
layout(location = 0) out vec4 weighted_colour;  // rgb: sum; a: product of what shines through
layout(location = 1) out vec4 weighted_alpha;   // r: sum
uniform float nearest_m;                        // depth of the nearest hair
uniform float weight_depth_m;                   // over which the weight falls to 1 / e

bool reserve_fragment() { return true; }

void put_fragment(vec4 premultiplied) {
  float depth_m = 1.0 / gl_FragCoord.w;
  // Up to 60: float sums of the weights neither vanish nor overflow.
  float weight = exp(-clamp((depth_m - nearest_m) / weight_depth_m, 0.0, 60.0));
  weighted_colour = vec4(weight * premultiplied.rgb, premultiplied.a);
  weighted_alpha = vec4(weight * premultiplied.a, 0.0, 0.0, 0.0);
}
#else
layout(location = 0) out vec4 colour;

bool reserve_fragment() { return true; }
void put_fragment(vec4 premultiplied) { colour = premultiplied; }
#endif
