// What arrives from a light at a point without anything in between. GPU twin of runtime/shading/light.h.

const int kMaxLights = 4;
const float kNearestLight_m = 1e-3;
uniform int light_count;
uniform vec4 light_at[kMaxLights];      // w = 0: unit direction towards the light; w = 1: its position [m]
uniform vec3 light_colour[kMaxLights];  // irradiance; of a point light at 1 m

struct Arriving {
  vec3 to_light;    // unit
  vec3 irradiance;  // on a surface that faces the light
};

Arriving arriving(int light, vec3 at) {
  if (light_at[light].w == 0.0) return Arriving(light_at[light].xyz, light_colour[light]);
  vec3 towards = light_at[light].xyz - at;
  float distance = length(towards), bounded = max(distance, kNearestLight_m);
  return Arriving(distance > 0.0 ? towards / distance : vec3(0.0, 1.0, 0.0), light_colour[light] / (bounded * bounded));
}
