// Hair lighting [KajiyaKay1989; Xu2006 eqs. 8-11; Scheuermann2004]. GPU twin of runtime/shading/lobes.h, which explains
// the deviations from the papers; tests/render compares the two.

struct HairMaterial {
  vec4 diffuse;    // rgb colour, a coefficient
  vec4 primary;    // rgb colour, a coefficient
  vec4 secondary;  // rgb colour, a coefficient
  vec4 shape;      // primary exponent, secondary exponent, primary shift, secondary shift
};

float sine_between(vec3 a, vec3 b) { return min(length(cross(a, b)), 1.0); }

/// The normal of a lone strand: across t, towards the viewer; where the viewer looks along it, any across it.
vec3 facing_normal(vec3 t, vec3 v) {
  vec3 across = v - dot(v, t) * t;
  float length_across = length(across);
  if (length_across > 1e-4) return across / length_across;
  vec3 axis = abs(t.x) < 0.6 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0);
  return normalize(axis - dot(axis, t) * t);
}

float diffuse_lobe(vec3 t, vec3 l) { return sine_between(t, l); }

float specular_lobe(vec3 t, vec3 l, vec3 v, float exponent) {
  float base = sine_between(t, l) * sine_between(t, v) - dot(t, l) * dot(t, v);
  // pow(0, e) is defined for e > 0; exponents are >= 1.
  return pow(clamp(base, 0.0, 1.0), exponent);
}

vec3 hair_lighting(HairMaterial m, vec3 t, vec3 n, vec3 l, vec3 v) {
  vec3 sum = m.diffuse.a * diffuse_lobe(t, l) * m.diffuse.rgb;
  sum += m.primary.a * specular_lobe(normalize(t + m.shape.z * n), l, v, m.shape.x) * m.primary.rgb;
  sum += m.secondary.a * specular_lobe(normalize(t - m.shape.w * n), l, v, m.shape.y) * m.secondary.rgb;
  return sum;
}

/// Mean over a fibre's width of the reflectance around it; 1 where c is 0. Twin of runtime/shading/azimuth_mean.h.
float azimuth_mean(vec2 c, vec3 t, vec3 v, vec3 l) {
  const float pi = 3.14159265, along = 0.02;
  vec3 across_v = v - dot(v, t) * t, across_l = l - dot(l, t) * t;
  float known = length(across_v) * length(across_l);
  if (known < 1e-6 || c == vec2(0.0)) return 1.0;
  float x = clamp(dot(across_v, across_l) / known, -1.0, 1.0);
  float diffuse = (pi - acos(x)) * x + sqrt(1.0 - x * x);
  float specular = sqrt(0.5 * (1.0 + x));
  float share = known * known / (known * known + along * along);
  return share * (c.x * diffuse + c.y * specular) + (1.0 - share);
}
