#include "pelage/hair/grow.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <string>

#include "pelage/data_schema/errors.h"
#include "pelage/hair/random.h"
#include "pelage/hair/resample.h"

namespace pelage::hair {
namespace {

using glm::vec3;
using Path = std::vector<vec3>;

// Lengths on a head of 0.24 m.
constexpr float kStep_m = 0.0025F;
constexpr float kClearance_m = 0.003F;  // of what lies on the skin: more than segments of 2 cm cut off a skull
constexpr float kBend_m = 0.022F;       // over which gravity turns a strand
constexpr float kComb_m = 0.10F;        // over which the comb leads
constexpr float kLengthSpread = 0.05F, kTilt = 0.12F;
constexpr int kPushes = 4;
constexpr std::uint32_t kGrowStream = 22;

class Grower {
 public:
  Grower(const Skull& skull, const DistanceField& field, const GrowSettings& settings)
      : skull_(skull), field_(field), settings_(settings), scale_(skull.height_m / 0.24F), random_(settings.seed) {}

  Path strand(const Root& root, std::uint32_t index) const {
    const std::array<float, 4> u = random_.uniform(kGrowStream, index);
    const float length_m = settings_.length_m * (1 + kLengthSpread * (2 * u[3] - 1));
    Path path = resample_polyline(walk(root, vec3(u[0], u[1], u[2]) - 0.5F, length_m), settings_.vertices);
    for (std::size_t k = 1; k < path.size(); ++k) path[k] = clear(path[k], clearance_m(length_m, k));
    return path;
  }

 private:
  /// Distance that vertex k of the resampled strand keeps: half of what the walk kept.
  float clearance_m(float length_m, std::size_t k) const {
    const float s = length_m * static_cast<float>(k) / static_cast<float>(settings_.vertices - 1);
    return 0.5F * kept_m(s);
  }
  float kept_m(float along_m) const {
    return scale_ * kClearance_m * smooth_step(0, 4 * scale_ * kClearance_m, along_m);
  }

  vec3 clear(vec3 p, float distance_m) const {
    for (int push = 0; push < kPushes; ++push) {
      const HeadField::Sample s = field_(p);
      if (s.distance_m >= distance_m) break;
      p += (distance_m - s.distance_m) * s.gradient;
    }
    return p;
  }

  /// Where hair is led: down, and near its root backwards and to its own side, away from the face.
  vec3 led(const Root& root, float along_m) const {
    const vec3 from = skull_.to_own_axes(root.position_m - skull_.centre_m) / (0.4F * skull_.height_m);
    // On the crown too, where hair that stands straight up would not know where to fall.
    const float front = std::max(smooth_step(-0.2F, 0.6F, from.z), smooth_step(0.6F, 0.9F, from.y));
    const float comb = 1 - smooth_step(0.3F, 1.0F, along_m / (scale_ * kComb_m));
    const vec3 left = glm::cross(vec3(0, 1, 0), skull_.face);
    const float side = from.x >= 0 ? 1.0F : -1.0F;
    return vec3(0, -1, 0) + comb * front * (0.9F * side * left - 1.6F * skull_.face);
  }

  Path walk(const Root& root, const vec3& tilt, float length_m) const {
    const float step_m = std::min(scale_ * kStep_m, length_m / 8);
    const int steps = static_cast<int>(std::ceil(length_m / step_m));
    const float even_m = length_m / static_cast<float>(steps);
    Path path{root.position_m};
    vec3 direction = glm::normalize(root.normal + kTilt * tilt);
    for (int k = 1; k <= steps; ++k) {
      const float along_m = static_cast<float>(k) * even_m;
      const vec3 towards = direction + even_m / (scale_ * kBend_m) * led(root, along_m);
      direction = glm::length(towards) > 1e-3F ? glm::normalize(towards) : direction;
      const vec3 next = clear(path.back() + even_m * direction, kept_m(along_m));
      const vec3 way = next - path.back();
      // The skin turns the strand; a push of more than the step would fold it.
      if (glm::length(way) > 0.2F * even_m) direction = glm::normalize(way);
      path.push_back(path.back() + even_m * direction);
    }
    return path;
  }

  const Skull& skull_;
  const DistanceField& field_;
  const GrowSettings& settings_;
  float scale_;
  CounterRandom random_;
};

void check(const GrowSettings& s) {
  if (!(s.length_m >= 0.005F && s.length_m <= 2))
    throw UsageError("length of " + std::to_string(s.length_m) + " m: give 0.005 to 2");
  if (s.vertices < 2 || s.vertices > 1000)
    throw UsageError("vertices " + std::to_string(s.vertices) + ": give 2 to 1000");
}

}  // namespace

Strands grow(const std::vector<Root>& roots, const Skull& skull, const DistanceField& field,
             const GrowSettings& settings) {
  check(settings);
  const Grower grower(skull, field, settings);
  std::vector<Path> paths(roots.size());
  tbb::parallel_for(std::size_t{0}, roots.size(),
                    [&](std::size_t k) { paths[k] = grower.strand(roots[k], static_cast<std::uint32_t>(k)); });
  Strands strands;
  for (const Path& path : paths) strands.append(path);
  return strands;
}

}  // namespace pelage::hair
