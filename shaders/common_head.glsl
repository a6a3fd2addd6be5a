// How the head under the hair reflects. GPU twin of runtime/shading/head_lighting.h, which says why.

uniform vec3 head_colour;
uniform vec3 head_shape;  // ambient, sky, wrap

float head_direct(vec3 n, vec3 l) {
  float wrapped = max((dot(n, l) + head_shape.z) / (1.0 + head_shape.z), 0.0);
  return min(wrapped * wrapped, 1.0);
}

float head_ambient(vec3 n) { return head_shape.x * (1.0 + head_shape.y * n.y); }
