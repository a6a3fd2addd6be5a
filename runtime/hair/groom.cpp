#include "pelage/hair/groom.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <string>

#include "pelage/data_schema/errors.h"
#include "pelage/hair/random.h"
#include "pelage/hair/resample.h"
#include "pelage/hair/scalp.h"

namespace pelage::hair {
namespace {

using glm::vec3;
using Path = std::vector<vec3>;  // [steps] metres, kStep_m apart as it grows

// All lengths are those of a head of 0.24 m; a groom is made on that head and scaled.
constexpr HeadParameters kModelHead{};
constexpr float kStep_m = 0.0025F;
constexpr float kClearance_m = 0.0006F;  // of a strand from the scalp once it has left its root
constexpr vec3 kDown{0, -1, 0};
constexpr float kFlyaways = 0.01F;  // share of the strands that no lock holds
constexpr std::uint32_t kStrandStream = 11, kDetailStream = 12, kLockStream = 13, kTailStream = 14, kEdgeStream = 15;

// A strand keeps its diameter over the first part of its length; the last narrows to a point.
constexpr float kTaperFrom = 0.6F, kTipShare = 0.25F;

// Baby hairs: short and fine, among the others along the hairline. Widths of the hairline as sines of an elevation.
constexpr float kBabyEdge = 0.09F, kBabyShare = 0.4F, kBabyDiameter = 0.6F;
constexpr float kShortest_m = 0.010F, kLongest_m = 0.034F;
constexpr float kFlatEdge = 0.40F;  // over which hair gains the volume that it has on top

/// What makes a style. Curves in metres of the model head.
struct Shape {
  float cut_m = -0.22F;        // height at which the hair is cut
  float cut_spread_m = 0.03F;  // variation of it
  float layers_m = 0.0F;       // by which hair from the crown ends above hair from the nape
  float frame_m = 0.0F;        // by which hair beside the face ends above hair from the nape
  float max_length_m = 0.42F;
  float parting_m = 0.0F;   // x of the parting
  float sweep_back = 0.5F;  // of the hair around the face
  float lift = 0.5F;        // of the root from the scalp
  float volume_m = 0.012F;  // thickness of the hair on the head
  float hug = 0.25F;        // pull towards the neck where hair hangs free
  std::uint32_t locks = 220;
  float gather = 0.55F;  // of a lock's strands towards its tip
  float wave_m = 0.0F, wavelength_m = 0.1F;
  float roundness = 0.0F;    // 0: waves in a plane, 1: helices
  float flat_on_top = 0.0F;  // share of the waves that the top of the head lacks, where they would stand up
  float turn_in = 0.0F;      // of the tips, bob
  bool fringe = false;
  float drape = 0.0F;            // of hair that falls before the shoulders: over the chest instead of in one strand
  bool waves_by_height = false;  // waves of neighbours lie side by side, instead of along each strand by itself
  float frizz_m = 0.0015F;
};

Shape shape_of(GroomStyle style) {
  Shape s;
  switch (style) {
    case GroomStyle::straight:
      s.cut_m = -0.245F;
      s.cut_spread_m = 0.02F;
      s.layers_m = 0.025F;
      s.frame_m = 0.03F;
      s.volume_m = 0.018F;
      s.hug = 0.10F;
      s.gather = 0.45F;
      s.drape = 1.0F;
      s.wave_m = 0.002F;
      break;
    case GroomStyle::wavy:
      s = {.cut_m = -0.235F,
           .cut_spread_m = 0.03F,
           .layers_m = 0.04F,
           .frame_m = 0.02F,
           .parting_m = 0.022F,
           .volume_m = 0.024F,
           .hug = 0.05F,
           .locks = 170,
           .gather = 0.70F,
           .wave_m = 0.0105F,
           .wavelength_m = 0.068F,
           .roundness = 0.3F,
           .flat_on_top = 0.6F,
           .drape = 1.0F,
           .waves_by_height = true,
           .frizz_m = 0.002F};
      break;
    case GroomStyle::curly:
      s = {.cut_m = -0.14F,
           .cut_spread_m = 0.04F,
           .layers_m = 0.04F,
           .frame_m = 0.02F,
           .max_length_m = 0.235F,
           .parting_m = 0.018F,
           .lift = 0.6F,
           .volume_m = 0.026F,
           .hug = 0.0F,
           .locks = 420,
           .gather = 0.82F,
           .wave_m = 0.0085F,
           .wavelength_m = 0.030F,
           .roundness = 1.0F,
           .flat_on_top = 0.25F,
           .frizz_m = 0.0025F};
      break;
    case GroomStyle::bob:
      s = {.cut_m = -0.076F,
           .cut_spread_m = 0.008F,
           .sweep_back = -1.0F,
           .volume_m = 0.014F,
           .hug = 0.1F,
           .locks = 200,
           .gather = 0.4F,
           .turn_in = 1.0F,
           .fringe = true,
           .frizz_m = 0.001F};
      break;
    case GroomStyle::ponytail:
      s = {.max_length_m = 0.30F,
           .volume_m = 0.005F,
           .locks = 60,
           .gather = 0.6F,
           .wave_m = 0.004F,
           .wavelength_m = 0.11F,
           .roundness = 0.4F,
           .frizz_m = 0.0012F};
      break;
  }
  return s;
}

vec3 without(vec3 v, vec3 unit) {
  return v - glm::dot(v, unit) * unit;
}

vec3 unit_or(vec3 v, vec3 otherwise) {
  const float length = glm::length(v);
  return length > 1e-6F ? v / length : otherwise;
}

/// Away from the line of the parting, which runs from before the forehead to the whorl at the crown; around the whorl
/// this is radial. Hair beside the face is combed back. Tangential to the scalp.
vec3 comb_direction(const Shape& shape, const Root& root) {
  constexpr float kFrontEnd_m = 0.14F, kWhorl_m = -0.045F;
  const float z = std::clamp(root.position_m.z, kWhorl_m, kFrontEnd_m);
  const float along = (z - kWhorl_m) / (kFrontEnd_m - kWhorl_m);
  const float x = shape.parting_m * (0.4F + 0.6F * smooth_step(0.0F, 0.5F, along));
  const vec3 away = unit_or({root.position_m.x - x, 0, root.position_m.z - z}, {1, 0, 0});
  const float front = smooth_step(-0.01F, 0.06F, root.position_m.z);
  const float down = 1.6F * (1.0F - smooth_step(0.0F, 1.0F, root.normal.y));  // where the scalp does not face up
  return unit_or(without(away + vec3(0, -down, -shape.sweep_back * front), root.normal), kDown);
}

/// The face, kept free: how deep p is inside of it, and the way out.
struct Contact {
  float depth_m;
  vec3 out;
};
Contact face_contact(vec3 p) {
  constexpr vec3 kCentre{0, -0.020F, 0.105F}, kRadii{0.052F, 0.105F, 0.075F};
  const vec3 q = (p - kCentre) / kRadii;
  const float k0 = glm::length(q), k1 = glm::length(q / kRadii);
  if (k0 >= 1.0F || k1 <= 0.0F) return {0, {0, 0, 0}};
  return {k0 * (1.0F - k0) / k1, unit_or({p.x, 0, 0.3F * (p.z - kCentre.z)}, {1, 0, 0})};
}

/// What tells one strand from another.
struct Individual {
  float layer;   // [0, 1] how far out it lies on the head
  float length;  // [-1, 1] against the others
};

struct StrandPlan {
  Root root;
  Individual self;
  bool fringe;
  vec3 comb;
  float cut_m, most_m;  // it ends below this height, or at this length
};

class Groomer {
 public:
  explicit Groomer(const GroomSettings& settings)
      : settings_(settings), shape_(shape_of(settings.style)), field_(kModelHead), random_(settings.seed) {
    constexpr float kCrown_m = 0.115F;
    shape_.cut_m = kCrown_m + settings.length_scale * (shape_.cut_m - kCrown_m);
    shape_.max_length_m *= settings.length_scale;
  }

  Strands run() {
    const std::vector<Root> roots = scalp_roots(kModelHead, field_, settings_.strands, settings_.seed);
    make_locks();
    const auto vertices = static_cast<std::uint32_t>(vertices_per_strand());
    Strands strands;
    strands.vertices.resize(std::size_t{vertices} * roots.size());
    strands.diameters_m.resize(strands.vertices.size());
    for (std::uint32_t i = 1; i <= roots.size(); ++i) strands.offsets.push_back(i * vertices);
    tbb::parallel_for(std::uint32_t{0}, settings_.strands, [&](std::uint32_t i) {
      Path path = resample_polyline(strand(roots[i], i), static_cast<int>(vertices));
      for (std::size_t k = 1; k < path.size(); ++k) path[k] = clear(path[k], 0.5F * kClearance_m);
      const float scale = settings_.head.height_m / kModelHead.height_m;
      const float diameter_m = default_diameter_m(settings_.strands) * (is_baby(roots[i], i) ? kBabyDiameter : 1.0F);
      for (std::uint32_t k = 0; k < vertices; ++k) {
        const float along = static_cast<float>(k) / static_cast<float>(vertices - 1);
        strands.vertices[std::size_t{i} * vertices + k] = scale * path[k];
        strands.diameters_m[std::size_t{i} * vertices + k] = diameter_m * taper(along);
      }
    });
    return strands;
  }

 private:
  static float taper(float along) { return 1.0F - (1.0F - kTipShare) * smooth_step(kTaperFrom, 1.0F, along); }

  int vertices_per_strand() const {
    if (settings_.vertices > 0) return settings_.vertices;
    return settings_.style == GroomStyle::curly ? 64 : 32;
  }

  void make_locks() {
    const std::vector<Root> roots = scalp_roots(kModelHead, field_, shape_.locks, settings_.seed ^ 0x9E3779B97F4A7C15U);
    const float phase_range = shape_.waves_by_height ? 0.4F : 1.0F;
    for (std::uint32_t i = 0; i < roots.size(); ++i) {
      const std::array<float, 4> u = random_.uniform(kLockStream, i);
      const float length = 2 * u[3] - 1;
      locks_.push_back({roots[i], {}, u[0] * phase_range, 1.0F + 0.3F * phase_range * (u[1] - 0.5F), u[2], length});
      if (settings_.style != GroomStyle::ponytail)
        locks_.back().path = grow(plan(roots[i], 0.5F, 0.5F * length - 0.4F));
    }
    if (settings_.style == GroomStyle::ponytail) tail_ = grow_tail();
  }

  // Where and how a strand is cut ---------------------------------------------------------------------------------

  /// How far inside the hairline a root lies, as the sine of an elevation.
  static float inside_hairline(const Root& root) {
    const vec3 d = glm::normalize(root.position_m - skull_centre_m(kModelHead));
    return d.y - hairline_sine(d);
  }

  bool is_baby(const Root& root, std::uint32_t i) const {
    const float at_edge = 1.0F - smooth_step(0.0F, kBabyEdge, inside_hairline(root));
    return random_.uniform(kEdgeStream, i)[0] < kBabyShare * at_edge;
  }

  bool in_fringe(const Root& root) const {
    return shape_.fringe && root.position_m.z > 0.026F && std::abs(root.position_m.x) < 0.050F;
  }

  StrandPlan plan(const Root& root, float layer, float length) const {
    const bool fringe = in_fringe(root);
    // Hair from higher up lies over hair from lower down, and hair at the hairline under both.
    const float height = smooth_step(-0.05F, 0.115F, root.position_m.y);
    const float flat = 0.4F + 0.6F * smooth_step(0.0F, kFlatEdge, inside_hairline(root));
    const Individual self{(fringe ? 0.35F : flat) * (0.45F * layer + 0.55F * height), length};
    StrandPlan plan{root, self, fringe, comb_direction(shape_, root), 0, shape_.max_length_m * (1.0F + 0.15F * length)};
    const vec3 forward = unit_or(without({10 * root.position_m.x, 0, 1}, root.normal), kDown);
    if (shape_.fringe && !fringe) {  // the curtain begins over the temple, where the fringe ends
      const float temple =
          smooth_step(0.010F, 0.030F, root.position_m.z) * smooth_step(0.034F, 0.050F, std::abs(root.position_m.x));
      plan.comb = unit_or(glm::mix(plan.comb, forward, temple), kDown);
    }
    if (fringe) {
      plan.comb = forward;
      plan.cut_m = 0.025F - 6.0F * root.position_m.x * root.position_m.x + 0.004F * length;
    } else {
      const float beside_face = smooth_step(0.0F, 0.06F, root.position_m.z);
      plan.cut_m =
          shape_.cut_m + shape_.cut_spread_m * length + shape_.layers_m * height + shape_.frame_m * beside_face;
    }
    return plan;
  }

  StrandPlan baby_plan(const Root& root, std::uint32_t i) const {
    const std::array<float, 4> u = random_.uniform(kEdgeStream, i);  // its first number made it one
    StrandPlan baby = plan(root, 0.3F * u[2], 0);
    baby.fringe = false;
    baby.cut_m = -1.0F;
    baby.most_m = kShortest_m + (kLongest_m - kShortest_m) * u[1];
    if (settings_.style == GroomStyle::ponytail)
      baby.comb = unit_or(without(tie_m() - root.position_m, root.normal), kDown);
    return baby;
  }

  // A strand on its own ---------------------------------------------------------------------------------------------

  Path grow(const StrandPlan& plan) const {
    Path path{plan.root.position_m};
    vec3 direction = glm::normalize(plan.comb + (plan.fringe ? 0.3F : shape_.lift) * plan.root.normal);
    for (float s = 0; s < plan.most_m; s += kStep_m) {
      const vec3 p = path.back();
      if (p.y < plan.cut_m && path.size() > 8) break;
      direction = turn(plan, p, direction, s);
      path.push_back(push_out(p + kStep_m * direction, plan, s));
    }
    return path;
  }

  /// Distance from the scalp that a strand keeps at arc length s.
  float shell_m(const Individual& self, float s) const {
    return kClearance_m * smooth_step(0.0F, 0.004F, s) +
           shape_.volume_m * self.layer * smooth_step(0.0F, 0.030F + 1.8F * shape_.volume_m, s);
  }

  /// Hair falls before or behind the shoulders, not outwards along them.
  vec3 off_shoulders(vec3 p) const {
    const float ridge_m = -0.036F - 0.012F * shape_.drape;  // z of the shoulders' ridge; more falls before it to drape
    const float near = smooth_step(-0.060F, -0.115F, p.y);
    const float away_m = p.z - ridge_m;
    const float ahead =
        std::clamp(away_m / 0.003F, -1.0F, 1.0F) * (1.0F - smooth_step(0.020F, 0.055F, std::abs(away_m)));
    const float side = std::clamp(p.x / 0.01F, -1.0F, 1.0F);
    const float x = std::abs(p.x), wide_m = 0.032F * shape_.drape;
    const float aside = side * smooth_step(0.060F + wide_m, 0.100F + wide_m, x);
    // Over the chest it spreads, little by little, from the middle of the curtain to both sides.
    const float apart = side * std::clamp((x - 0.070F) / 0.045F, -0.5F, 0.7F) * smooth_step(0.02F, 0.05F, x);
    const float spread = shape_.drape * smooth_step(-0.02F, 0.02F, away_m) * smooth_step(-0.03F, -0.09F, p.y);
    return near * vec3(-0.7F * aside, 0, 1.2F * ahead) + vec3(0.4F * spread * apart, 0, 0);
  }

  vec3 turn(const StrandPlan& plan, vec3 p, vec3 direction, float s) const {
    constexpr float kStiffness_m = 0.014F, kCombed_m = 0.085F, kReach_m = 0.018F;
    const HeadField::Sample at = field_.sample(p);
    const vec3 normal = unit_or(at.gradient, {0, 1, 0});
    const float above_m = at.distance_m - shell_m(plan.self, s);
    const float touch = 1.0F - smooth_step(0.0F, kReach_m, above_m);
    const vec3 inward = unit_or({-p.x, 0, -0.025F - p.z}, {0, 0, 0});
    vec3 pull =
        kDown + off_shoulders(p) + (1.0F - smooth_step(0.3F * kCombed_m, kCombed_m, s)) * without(plan.comb, normal);
    pull += shape_.hug * (1.0F - touch) * inward;
    pull += shape_.turn_in * smooth_step(plan.cut_m + 0.045F, plan.cut_m, p.y) * 1.3F * inward;
    pull -= touch * std::min(glm::dot(pull, normal), 0.0F) * normal;             // the head carries it
    pull -= std::clamp(above_m / 0.010F, -1.0F, 0.6F * touch) * touch * normal;  // and it lies on the layer below
    if (!plan.fringe) {
      const Contact face = face_contact(p);
      pull += std::min(face.depth_m / 0.004F, 2.0F) * face.out;
    }
    return glm::normalize(direction + (kStep_m / kStiffness_m) * pull);
  }

  vec3 push_out(vec3 p, const StrandPlan& plan, float s) const {
    const float least_m = 0.6F * shell_m(plan.self, s + kStep_m);
    return clear(p, std::max(least_m, kClearance_m * smooth_step(0.0F, 0.004F, s)));
  }

  /// p, moved out of the head to `least_m` above it.
  vec3 clear(vec3 p, float least_m) const {
    for (int i = 0; i < 8; ++i) {
      const HeadField::Sample at = field_.sample(p);
      if (at.distance_m >= least_m) break;
      p += (least_m - at.distance_m) * unit_or(at.gradient, {0, 1, 0});
    }
    return p;
  }

  // A strand in its lock --------------------------------------------------------------------------------------------

  struct Lock {
    Root root;
    Path path;
    float phase, wave_scale, plane, length;
  };

  /// The nearest lock on the same side of the parting.
  const Lock& lock_of(const Root& root) const {
    const auto distance = [&](const Lock& lock) {
      const bool same_side = (lock.root.position_m.x < shape_.parting_m) == (root.position_m.x < shape_.parting_m);
      const vec3 d = lock.root.position_m - root.position_m;
      return glm::dot(d, d) + (in_fringe(lock.root) == in_fringe(root) ? 0.0F : 1.0F) +
             (same_side || shape_.fringe || root.position_m.y < 0.06F ? 0.0F : 1.0F);
    };
    return *std::min_element(locks_.begin(), locks_.end(),
                             [&](const Lock& a, const Lock& b) { return distance(a) < distance(b); });
  }

  Path strand(const Root& root, std::uint32_t i) const {
    const std::array<float, 4> u = random_.uniform(kStrandStream, i);
    const Lock& lock = lock_of(root);
    Path path;
    if (is_baby(root, i)) {
      path = grow(baby_plan(root, i));
    } else if (settings_.style == GroomStyle::ponytail) {
      path = comb_to_tie(root, lock, u, i);
    } else {
      path = grow(plan(root, flies_away(u[3]) ? 1.3F : u[0], length_in(lock, u)));
      gather(path, lock, u[3]);
    }
    style(path, lock, i, u[3]);
    return path;
  }

  static bool flies_away(float u) { return u < kFlyaways; }

  /// Locks differ in length, and within one a few strands end early, so that it thins out towards its tip.
  static float length_in(const Lock& lock, const std::array<float, 4>& u) {
    return 0.5F * lock.length + 1.6F * u[1] * u[1] * u[2] - 0.4F;
  }

  void gather(Path& path, const Lock& lock, float u) const {
    if (flies_away(u)) return;
    const std::size_t shared = std::min(path.size(), lock.path.size());
    const float strength = shape_.gather * (0.75F + 0.5F * u);
    vec3 shift(0.0F);
    for (std::size_t k = 0; k < path.size(); ++k) {
      const float along = static_cast<float>(k) / static_cast<float>(path.size());
      if (k < shared) shift = lock.path[k] - path[k];
      const float apart_m = glm::length(shift);  // strands that took another way stay on it
      path[k] += std::min(strength, 0.95F) * smooth_step(0.05F, 1.0F, along) *
                 (1.0F - smooth_step(0.020F, 0.040F, apart_m)) * shift;
    }
  }

  /// Away from the axis of the head, and from what the hair lies on; across `tangent`.
  vec3 outwards(vec3 p, vec3 tangent) const {
    const HeadField::Sample at = field_.sample(p);
    const vec3 radial = unit_or(without(p - vec3(0, 0, -0.012F), {0, 1, 0}), {0, 0, 1});
    const float lies = smooth_step(-0.09F, -0.15F, p.y) * (1.0F - smooth_step(0.01F, 0.04F, at.distance_m));
    return unit_or(without(radial + vec3(0, 0.3F, 0) + 2.0F * lies * at.gradient, tangent), {0, 0, 1});
  }

  /// Waves or curls of the lock and the strand's own irregularity; then everything is outside of the head again.
  void style(Path& path, const Lock& lock, std::uint32_t i, float u) const {
    const std::array<float, 4> w = random_.uniform(kDetailStream, i);
    const float frizz_m = shape_.frizz_m * (flies_away(u) ? 4.0F : 1.0F);
    const float wavelength_m = shape_.wavelength_m * lock.wave_scale;
    const Path centre = path;
    const float length_m = kStep_m * static_cast<float>(path.size());
    for (std::size_t k = 1; k < path.size(); ++k) {
      const float s = kStep_m * static_cast<float>(k);
      const vec3 tangent = unit_or(centre[std::min(k + 1, path.size() - 1)] - centre[k - 1], kDown);
      const vec3 out = outwards(centre[k], tangent);
      const vec3 side = glm::cross(tangent, out);
      const float on_top = smooth_step(0.050F, 0.105F, centre[k].y);
      const float grown =
          smooth_step(0.010F, 0.080F, s) * (0.65F + 0.35F * s / length_m) * (1.0F - shape_.flat_on_top * on_top);
      const float travelled_m = shape_.waves_by_height ? 0.1F - centre[k].y : s;
      const float phase = travelled_m / wavelength_m + lock.phase + 0.07F * (w[0] - 0.5F);
      const float flat = shape_.wave_m * grown * sin_turns(phase), round = shape_.wave_m * grown * cos_turns(phase);
      const float tilt = 0.06F + 0.12F * lock.plane;
      vec3 p = path[k] + flat * (cos_turns(tilt) * side + sin_turns(tilt) * out) +
               shape_.roundness * round * (cos_turns(tilt) * out - sin_turns(tilt) * side);
      const float stray = frizz_m * s / length_m;
      p += stray * (sin_turns(s / 0.09F + w[1]) * side + sin_turns(s / 0.07F + w[2]) * out);
      p += 0.25F * shape_.frizz_m * (s / length_m) * sin_turns(s / 0.031F + w[3]) * side;
      path[k] = clear(p, kClearance_m * smooth_step(0.0F, 0.004F, s));
    }
  }

  // Ponytail --------------------------------------------------------------------------------------------------------

  static constexpr vec3 kTieDirection{0, 0.42F, -0.9075F};
  static constexpr float kTieRadius_m = 0.008F, kTieHeight_m = 0.014F;

  float skull_radius_m(vec3 direction, float above_m) const {
    float r = 0.15F;
    const vec3 centre = skull_centre_m(kModelHead);
    for (int i = 0; i < 12; ++i) r -= 0.9F * (field_.sample(centre + r * direction).distance_m - above_m);
    return r;
  }

  vec3 tie_m() const {
    return skull_centre_m(kModelHead) + skull_radius_m(kTieDirection, kTieHeight_m) * kTieDirection;
  }

  /// Centre of the tail: up and away from the tie, then hanging.
  Path grow_tail() const {
    Path path{tie_m()};
    vec3 direction = glm::normalize(vec3(0, 0.30F, -1));
    for (float s = 0; s < 1.2F * shape_.max_length_m; s += kStep_m) {
      direction =
          glm::normalize(direction + (kStep_m / 0.024F) * (kDown + vec3(0, 0, 0.06F * smooth_step(0.03F, 0.1F, s))));
      path.push_back(clear(path.back() + kStep_m * direction, 0.018F * smooth_step(0.0F, 0.05F, s)));
    }
    return path;
  }

  /// Along the skull's great circle to the tie, then the strand's own way down the tail.
  Path comb_to_tie(const Root& root, const Lock& lock, const std::array<float, 4>& u, std::uint32_t i) const {
    const vec3 centre = skull_centre_m(kModelHead);
    const vec3 from = glm::normalize(root.position_m - centre);
    const glm::vec2 place = place_in_tail(lock, i);
    const vec3 tie = tie_m() + tail_offset(0, place, 0);
    const float arc_m = glm::distance(root.position_m, tie);
    const auto steps = std::max(4, static_cast<int>(1.2F * arc_m / kStep_m));
    Path path{root.position_m};
    for (int k = 1; k < steps; ++k) {
      const float t = static_cast<float>(k) / static_cast<float>(steps);
      const float s = t * arc_m;
      const float over_ear = 0.5F * std::abs(from.x) * t * (1.0F - t);
      const vec3 d = glm::normalize(glm::mix(from, kTieDirection, t) + vec3(0, over_ear, 0));
      const float above_m = shell_m({u[0], 0}, s);
      const vec3 combed = centre + skull_radius_m(d, above_m) * d;
      path.push_back(glm::mix(combed, tie, smooth_step(0.70F, 1.0F, t)));
    }
    const auto tail_steps =
        static_cast<std::size_t>(shape_.max_length_m * (0.95F + 0.10F * u[1] - 0.30F * u[2] * u[2] * u[2]) / kStep_m);
    for (std::size_t k = 0; k < std::min(tail_steps, tail_.size()); ++k) {
      const float along = static_cast<float>(k) / static_cast<float>(tail_steps);
      path.push_back(tail_[k] + tail_offset(k, place, along));
    }
    return path;
  }

  /// Disk coordinates within the tail: near those of the lock.
  glm::vec2 place_in_tail(const Lock& lock, std::uint32_t i) const {
    const std::array<float, 4> v = random_.uniform(kTailStream, i);
    const auto disk = [](float r, float turn) { return std::sqrt(r) * glm::vec2(cos_turns(turn), sin_turns(turn)); };
    return 0.8F * disk(lock.phase, lock.plane) + 0.38F * disk(v[0], v[1]);
  }

  vec3 tail_offset(std::size_t k, glm::vec2 place, float along) const {
    const vec3 tangent = unit_or(tail_[std::min(k + 1, tail_.size() - 1)] - tail_[k], kDown);
    const vec3 side{1, 0, 0}, up = glm::cross(tangent, side);
    const float spread = 1.0F + 2.0F * smooth_step(0.0F, 0.45F, along) - 1.7F * smooth_step(0.5F, 1.0F, along);
    return kTieRadius_m * spread * (place.x * side + place.y * up);
  }

  const GroomSettings& settings_;
  Shape shape_;
  HeadField field_;
  CounterRandom random_;
  std::vector<Lock> locks_;
  Path tail_;
};

void check(const GroomSettings& s) {
  const auto refuse = [](const std::string& what, const std::string& range) {
    throw UsageError(what + ": give " + range);
  };
  if (s.strands < 1 || s.strands > 1'000'000) refuse("strands " + std::to_string(s.strands), "1 to 1000000");
  if (s.vertices != 0 && (s.vertices < 4 || s.vertices > 1000))
    refuse("vertices " + std::to_string(s.vertices), "4 to 1000");
  if (!(s.length_scale >= 0.2F && s.length_scale <= 3))
    refuse("length scale " + std::to_string(s.length_scale), "0.2 to 3");
  if (!(s.head.height_m > 0 && s.head.height_m <= 100))
    refuse("head height " + std::to_string(s.head.height_m), "up to 100 m");
}

}  // namespace

GroomStyle parse_groom_style(std::string_view name) {
  if (name == "straight") return GroomStyle::straight;
  if (name == "wavy") return GroomStyle::wavy;
  if (name == "curly") return GroomStyle::curly;
  if (name == "bob") return GroomStyle::bob;
  if (name == "ponytail") return GroomStyle::ponytail;
  throw UsageError("style \"" + std::string(name) + "\": give straight, wavy, curly, bob or ponytail");
}

Strands groom(const GroomSettings& settings) {
  check(settings);
  return Groomer(settings).run();
}

}  // namespace pelage::hair
