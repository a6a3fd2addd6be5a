#include "pelage/hair/head.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <string>

#include "pelage/data_schema/errors.h"
#include "pelage/hair/surface_nets.h"

namespace pelage::hair {
namespace {

using glm::vec3;

constexpr float kModelHeight_m = 0.24F;  // of the head as it is described below
constexpr vec3 kBoxMin_m{-0.210F, -0.355F, -0.145F}, kBoxMax_m{0.210F, 0.130F, 0.125F};
constexpr float kMeshCell_m = 0.006F;  // at which surface nets give a manifold (some others pinch behind the ears)
constexpr float kFieldCell_m = 0.004F;
constexpr int kProjections = 4;  // Newton steps from the surface nets onto the surface

/// Distance to an ellipsoid to first order: f |p/r| (|p/r| - 1) / |p/r^2|, exact on the surface.
float ellipsoid(vec3 p, vec3 centre, vec3 radii) {
  const vec3 q = (p - centre) / radii;
  const float k0 = glm::length(q), k1 = glm::length(q / radii);
  return k1 > 0 ? k0 * (k0 - 1.0F) / k1 : -std::min({radii.x, radii.y, radii.z});
}

/// Capsule whose radius goes from ra at a to rb at b.
float round_cone(vec3 p, vec3 a, float ra, vec3 b, float rb) {
  const vec3 ab = b - a;
  const float h = std::clamp(glm::dot(p - a, ab) / glm::dot(ab, ab), 0.0F, 1.0F);
  return glm::distance(p, a + h * ab) - (ra + h * (rb - ra));
}

/// Union with a fillet of width k; the negatives give intersection and difference.
float join(float a, float b, float k) {
  const float h = std::max(k - std::abs(a - b), 0.0F) / k;
  return std::min(a, b) - 0.25F * h * h * k;
}
float carve(float a, float b, float k) {
  return -join(-a, b, k);
}

/// |x| with the crease between the halves rounded over about a.
vec3 mirrored(vec3 p, float a) {
  return {std::sqrt(p.x * p.x + a * a), p.y, p.z};
}

/// Cranium and forehead, a face that narrows to the chin.
float skull(vec3 p) {
  const vec3 q = mirrored(p, 0.012F);
  float d = ellipsoid(p, {0, 0.032F, -0.014F}, {0.0735F, 0.084F, 0.091F});
  d = join(d, ellipsoid(p, {0, 0.036F, 0.026F}, {0.058F, 0.056F, 0.055F}), 0.03F);                          // forehead
  d = join(d, ellipsoid(p, {0, -0.021F, 0.022F}, {0.054F, 0.072F, 0.054F}), 0.05F);                         // face
  d = join(d, round_cone(q, {0.036F, -0.034F, 0.002F}, 0.017F, {0.009F, -0.078F, 0.050F}, 0.014F), 0.05F);  // jaw
  return join(d, ellipsoid(p, {0, -0.081F, 0.057F}, {0.014F, 0.012F, 0.015F}), 0.03F);                      // chin
}

/// Wide fillets only: planes that catch the light where a face would be, and no eyes, nostrils or lips.
float hinted_face(float d, vec3 p) {
  const vec3 q = mirrored(p, 0.010F);
  d = join(d, ellipsoid(q, {0.027F, -0.020F, 0.046F}, {0.023F, 0.030F, 0.027F}), 0.03F);             // cheeks
  d = carve(d, ellipsoid(p, {0.030F, 0.006F, 0.1105F}, {0.029F, 0.015F, 0.028F}), 0.035F);           // under the brow
  d = join(d, round_cone(p, {0, 0.024F, 0.070F}, 0.0075F, {0, -0.015F, 0.0895F}, 0.0085F), 0.020F);  // nose
  return join(d, ellipsoid(p, {0, -0.048F, 0.0665F}, {0.017F, 0.011F, 0.0105F}), 0.025F);            // mouth
}

float ear(vec3 p) {
  const vec3 q = p - vec3(0.0740F, -0.002F, -0.010F);
  const vec3 t{q.x - 0.10F * (q.y - 0.3F * q.z) + 0.25F * q.z, q.y + 0.25F * q.z,
               q.z - 0.25F * q.y};  // leans back and out
  const float shell = ellipsoid(t, {0, 0, 0}, {0.0065F, 0.0270F, 0.0160F});
  return carve(shell, ellipsoid(t, {0.0080F, 0.003F, 0.002F}, {0.0055F, 0.018F, 0.0100F}), 0.006F);
}

float neck(vec3 p) {
  const float column = round_cone(p, {0, -0.045F, -0.020F}, 0.040F, {0, -0.190F, -0.038F}, 0.044F);
  const vec3 q = mirrored(p, 0.012F);
  return join(column, round_cone(q, {0.016F, -0.040F, -0.048F}, 0.022F, {0.024F, -0.190F, -0.056F}, 0.026F), 0.03F);
}

/// Shoulders and chest without arms, down to where the bust is cut.
float torso(vec3 p) {
  const vec3 q = mirrored(p, 0.02F);
  float d = ellipsoid(p, {0, -0.315F, -0.034F}, {0.155F, 0.150F, 0.082F});  // chest
  d = join(d, round_cone(q, {0.030F, -0.205F, -0.036F}, 0.036F, {0.155F, -0.229F, -0.038F}, 0.041F),
           0.06F);  // shoulder
  return join(d, round_cone(q, {0.022F, -0.135F, -0.048F}, 0.022F, {0.120F, -0.204F, -0.044F}, 0.030F),
              0.05F);  // its slope
}

/// Seen from the front, a bust ends in half an ellipse below the shoulders.
float outside_of_bust(vec3 p) {
  constexpr vec3 kCentre{0, -0.155F, 0}, kRadii{0.197F, 0.185F, 1.0F};
  return p.y < kCentre.y ? ellipsoid({p.x, p.y, 0}, kCentre, kRadii) : p.x - kRadii.x;
}

/// The head as it is, mirrored about x = 0.
float model_distance_m(vec3 p) {
  p = mirrored(p, 1e-4F);
  float d = join(hinted_face(skull(p), p), neck(p), 0.022F);
  d = join(d, ear(p), 0.006F);
  d = join(d, torso(p), 0.04F);
  return carve(d, -outside_of_bust(p), 0.012F);
}

float scale_of(const HeadParameters& head) {
  return head.height_m / kModelHeight_m;
}

void check(const HeadParameters& head) {
  if (!(head.height_m > 0 && head.height_m <= 100)) {
    throw UsageError("head height " + std::to_string(head.height_m) + " m: give one above 0, at most 100");
  }
}

Grid grid_of(const HeadParameters& head, float cell_m) {
  const float scale = scale_of(head);
  return {scale * kBoxMin_m, scale * cell_m, glm::ivec3(glm::ceil((kBoxMax_m - kBoxMin_m) / cell_m)) + 1};
}

}  // namespace

float head_distance_m(const HeadParameters& head, vec3 p) noexcept {
  const float scale = scale_of(head);
  return scale * model_distance_m(p / scale);
}

vec3 head_normal(const HeadParameters& head, vec3 p) noexcept {
  const float h = 2e-4F * scale_of(head);
  const auto slope = [&](vec3 step) { return head_distance_m(head, p + step) - head_distance_m(head, p - step); };
  const vec3 g{slope({h, 0, 0}), slope({0, h, 0}), slope({0, 0, h})};
  const float length = glm::length(g);
  return length > 0 ? g / length : vec3(0, 1, 0);
}

Mesh parametric_head(const HeadParameters& head) {
  check(head);
  const auto distance = [&](vec3 p) { return head_distance_m(head, p); };
  Mesh mesh = surface_nets(grid_of(head, kMeshCell_m), distance);
  for (vec3& p : mesh.vertices) {
    for (int i = 0; i < kProjections; ++i) p -= 0.8F * distance(p) * head_normal(head, p);
    mesh.normals.push_back(head_normal(head, p));
  }
  return mesh;
}

HeadField::HeadField(const HeadParameters& head) {
  check(head);
  const Grid grid = grid_of(head, kFieldCell_m);
  origin_m_ = grid.origin_m;
  cell_m_ = grid.cell_m;
  size_ = grid.size;
  const auto layer = static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y);
  distances_m_.resize(layer * static_cast<std::size_t>(size_.z));
  tbb::parallel_for(0, size_.z, [&](int z) {
    float* out = distances_m_.data() + layer * static_cast<std::size_t>(z);
    for (int y = 0; y < size_.y; ++y) {
      for (int x = 0; x < size_.x; ++x) *out++ = head_distance_m(head, grid.point({x, y, z}));
    }
  });
}

float HeadField::at(int x, int y, int z) const noexcept {
  return distances_m_[static_cast<std::size_t>((z * size_.y + y) * size_.x + x)];
}

HeadField::Sample HeadField::sample(vec3 p) const noexcept {
  const vec3 q = (p - origin_m_) / cell_m_;
  const vec3 inside = glm::clamp(q, vec3(0.0F), vec3(size_ - 1) - 1e-3F);
  const glm::ivec3 i(inside);
  const vec3 f = inside - vec3(i);
  const auto mix = [](float a, float b, float t) { return a + t * (b - a); };
  float x0[4], x1[4];  // values at both x, for the four (y, z)
  for (int k = 0; k < 4; ++k) {
    x0[k] = at(i.x, i.y + (k & 1), i.z + (k >> 1));
    x1[k] = at(i.x + 1, i.y + (k & 1), i.z + (k >> 1));
  }
  float along_x[4];
  for (int k = 0; k < 4; ++k) along_x[k] = mix(x0[k], x1[k], f.x);
  const float y0 = mix(along_x[0], along_x[1], f.y), y1 = mix(along_x[2], along_x[3], f.y);
  const vec3 slope{mix(mix(x1[0] - x0[0], x1[1] - x0[1], f.y), mix(x1[2] - x0[2], x1[3] - x0[3], f.y), f.z),
                   mix(along_x[1] - along_x[0], along_x[3] - along_x[2], f.z), y1 - y0};
  return {mix(y0, y1, f.z) + cell_m_ * glm::distance(q, inside), slope / cell_m_};
}

}  // namespace pelage::hair
