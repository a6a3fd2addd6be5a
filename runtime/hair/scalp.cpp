#include "pelage/hair/scalp.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include "pelage/hair/random.h"

namespace pelage::hair {
namespace {

using glm::vec3;

constexpr vec3 kSkullCentre_m{0, 0.020F, -0.012F};  // of the head of 0.24 m
constexpr float kOutside_m = 0.16F;                 // farther from the centre than the skull anywhere
constexpr float kJitter = 0.33F;                    // of the lattice's spacing
constexpr float kSoftEdge = 0.11F;                  // over which hair gains its density, as the sine of an elevation
constexpr float kLowDensity = 0.62F;                // of the lower back and sides, against the top and the front
constexpr float kGoldenTurns = 0.38196601F;
constexpr std::uint32_t kJitterStream = 1, kDensityStream = 2;

/// The hairline: sine of the elevation above which hair grows, against the azimuth (0 front, 1 side, 2 back; |x| and z
/// in diamond measure).
struct HairlinePoint {
  float azimuth, sine;
};
constexpr HairlinePoint kHairline[] = {{0.00F, 0.55F},  {0.26F, 0.56F},  {0.44F, 0.51F},  {0.57F, 0.34F},
                                       {0.65F, 0.12F},  {0.70F, -0.10F}, {0.74F, -0.12F}, {0.79F, 0.05F},
                                       {0.85F, 0.14F},  {1.00F, 0.17F},  {1.12F, 0.10F},  {1.25F, -0.06F},
                                       {1.35F, -0.26F}, {1.50F, -0.45F}, {1.75F, -0.60F}, {2.00F, -0.64F}};

/// Share of the lattice that grows hair. It rises as a square root inside of the hairline, and is lower where hair from
/// above covers the scalp.
bool grows(vec3 d, const std::array<float, 4>& u) {
  const float edge = (d.y - hairline_sine(d)) / kSoftEdge;
  const float top = smooth_step(0.1F, 0.6F, d.y + 0.4F * d.z);
  return u[0] * u[0] < edge + 0.15F && u[1] < kLowDensity + (1.0F - kLowDensity) * top;
}

/// Directions of a lattice of `total` points over the sphere that lie inside the hairline.
std::vector<vec3> directions_inside(std::uint32_t total, const CounterRandom& random) {
  const float spacing = std::sqrt(12.566371F / static_cast<float>(total));
  const float first_turn = random.uniform(kJitterStream, ~0U)[0];
  std::vector<vec3> inside;
  for (std::uint32_t k = 0; k < total; ++k) {
    const auto y = static_cast<float>(1.0 - (2.0 * k + 1.0) / total);
    const double turns = static_cast<double>(k) * static_cast<double>(kGoldenTurns);
    const float turn = first_turn + static_cast<float>(turns - std::floor(turns));
    const float ring = std::sqrt(1.0F - y * y);
    const std::array<float, 4> u = random.uniform(kJitterStream, k);
    const vec3 shift = vec3(u[0], u[1], u[2]) - 0.5F;
    const vec3 d =
        glm::normalize(vec3(ring * cos_turns(turn), y, ring * sin_turns(turn)) + 2 * kJitter * spacing * shift);
    if (grows(d, random.uniform(kDensityStream, k))) inside.push_back(d);
  }
  return inside;
}

/// Drops the excess, evenly over the list.
std::vector<vec3> thin_out(const std::vector<vec3>& all, std::uint32_t count) {
  std::vector<vec3> kept;
  for (std::uint64_t k = 0; k < count; ++k) kept.push_back(all[k * all.size() / count]);
  return kept;
}

std::vector<vec3> directions(std::uint32_t count, const CounterRandom& random) {
  std::uint32_t total = 2 * count + 8;
  for (bool grew = false;;) {
    std::vector<vec3> inside = directions_inside(total, random);
    const auto found = static_cast<std::uint32_t>(inside.size());

    const double wanted = found > 0 ? 1.008 * total * count / found : 2.0 * total;
    const auto next = static_cast<std::uint32_t>(wanted) + 2;
    const bool close = found >= count && found - count <= count / 64 + 2;
    if (close || (found >= count && (grew || next >= total))) return thin_out(inside, count);
    grew =
        grew || found < count;  // then the first lattice that has enough is taken: a small count may never come close
    total = found < count ? std::max(next, total + 1) : next;
  }
}

/// Where the ray from the centre leaves the head.
vec3 project(const HeadField& field, vec3 centre, vec3 direction, float from_m) {
  float r = from_m;
  for (int i = 0; i < 24; ++i) r -= 0.9F * field.sample(centre + r * direction).distance_m;
  return centre + r * direction;
}

}  // namespace

float hairline_sine(vec3 d) noexcept {
  const float side = std::abs(d.x), sum = side + std::abs(d.z);
  const float share = sum > 0 ? side / sum : 0.0F;
  const float azimuth = d.z >= 0 ? share : 2.0F - share;
  std::size_t k = 1;
  while (k + 1 < std::size(kHairline) && kHairline[k].azimuth < azimuth) ++k;
  const HairlinePoint &a = kHairline[k - 1], &b = kHairline[k];
  return a.sine + (b.sine - a.sine) * smooth_step(a.azimuth, b.azimuth, azimuth);
}

vec3 skull_centre_m(const HeadParameters& head) noexcept {
  return head.height_m / 0.24F * kSkullCentre_m;
}

std::vector<Root> scalp_roots(const HeadParameters& head, const HeadField& field, std::uint32_t count,
                              std::uint64_t seed) {
  const vec3 centre = skull_centre_m(head);
  const float outside = head.height_m / 0.24F * kOutside_m;
  std::vector<Root> roots;
  for (const vec3& d : directions(count, CounterRandom(seed))) {
    const vec3 p = project(field, centre, d, outside);
    roots.push_back({p, glm::normalize(field.sample(p).gradient)});
  }
  return roots;
}

}  // namespace pelage::hair
