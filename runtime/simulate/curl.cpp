#include "pelage/simulate/curl.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "pelage/data_schema/errors.h"
#include "pelage/simulate/for_strands.h"

namespace pelage {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;
constexpr double kLock_m = 0.025;  // cells of the noise that phases vary by over the scalp

/// In [0, 1), of any three numbers [Wellons2018, lowbias32].
double hashed(std::uint32_t a, std::uint32_t b, std::uint32_t c) noexcept {
  std::uint32_t h = a * 0x9E3779B1U + b * 0x85EBCA77U + c * 0xC2B2AE3DU;
  h ^= h >> 16, h *= 0x7FEB352DU, h ^= h >> 15, h *= 0x846CA68BU, h ^= h >> 16;
  return h * 0x1p-32;
}

double smooth_step(double x) noexcept {
  const double t = std::clamp(x, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

/// Value noise of cells of kLock_m, in [0, 1).
double lock_noise(const glm::vec3& root) noexcept {
  const glm::dvec3 at = glm::clamp(glm::dvec3(root) / kLock_m, -1e8, 1e8), cell = glm::floor(at);
  const auto corner = [&](int axis, int side) {
    return static_cast<std::uint32_t>(static_cast<std::int64_t>(cell[axis]) + side);
  };
  double sum = 0;
  for (int k = 0; k < 8; ++k) {
    const std::array side{k & 1, (k >> 1) & 1, k >> 2};
    double weight = 1;
    for (int a = 0; a < 3; ++a) {
      const double t = smooth_step(at[a] - cell[a]);
      weight *= side[static_cast<std::size_t>(a)] != 0 ? t : 1 - t;
    }
    sum += weight * hashed(corner(0, side[0]), corner(1, side[1]), corner(2, side[2]));
  }
  return sum;
}

double phase_of(const glm::vec3& root, std::size_t strand, const CurlSettings& settings) noexcept {
  const double scatter = hashed(static_cast<std::uint32_t>(strand), 1, 2) - 0.5;
  return lock_noise(root) + static_cast<double>(settings.phase_spread) * scatter;
}

/// The helix of one line.
class Helix {
 public:
  Helix(const CurlSettings& settings, std::span<const glm::vec3> line, std::size_t strand)
      : radius_(static_cast<double>(settings.radius_m)),
        growth_(static_cast<double>(settings.frequency_growth)),
        start_(static_cast<double>(settings.start)),
        phase_(phase_of(line[0], strand, settings)),
        arc_(line.size(), 0.0) {
    for (std::size_t i = 1; i < line.size(); ++i)
      arc_[i] = arc_[i - 1] + glm::distance(glm::dvec3(line[i - 1]), glm::dvec3(line[i]));
    turns_at_root_ = arc_.back() / static_cast<double>(settings.pitch_m);
  }

  glm::vec3 offset(std::size_t segment, float fraction) const noexcept {
    const double u = share(segment, static_cast<double>(fraction));
    const double turns = phase_ + turns_at_root_ * (u + 0.5 * growth_ * u * u);
    const double angle = kTwoPi * (turns - std::floor(turns));
    const double rho = u > 0 ? radius_ * (u < start_ ? smooth_step(u / start_) : 1.0) : 0.0;
    return {static_cast<float>(rho * std::cos(angle)), static_cast<float>(rho * std::sin(angle)), 0.0F};
  }

 private:
  /// Of the line's length, from the root.
  double share(std::size_t segment, double fraction) const noexcept {
    if (!(arc_.back() > 0)) return 0;
    return (arc_[segment] + fraction * (arc_[segment + 1] - arc_[segment])) / arc_.back();
  }

  double radius_, growth_, start_, phase_, turns_at_root_;
  std::vector<double> arc_;  // [vertex] from the root [m]
};

void check(const CurlSettings& c) {
  if (!(c.radius_m >= 0) || !(c.pitch_m > 0) || !(c.frequency_growth >= 0) || !(c.start >= 0) ||
      !(c.phase_spread >= 0) || c.subdivision < 1 || !std::isfinite(c.radius_m + c.frequency_growth)) {
    throw UsageError("curl: radius, growth, start and phase spread must be >= 0, pitch > 0, subdivision >= 1");
  }
}

/// Layout of the drawn strands. A line of fewer than two vertices stays as it is.
std::vector<std::uint32_t> drawn_offsets(const Strands& lines, int subdivision) {
  std::vector<std::uint32_t> offsets{0};
  std::uint64_t sum = 0;
  for (std::size_t s = 0; s < lines.count(); ++s) {
    const std::size_t n = lines.strand(s).size();
    sum += n > 1 ? (n - 1) * static_cast<std::size_t>(subdivision) + 1 : n;
    offsets.push_back(static_cast<std::uint32_t>(sum));
  }
  if (sum > std::numeric_limits<std::uint32_t>::max())
    throw UsageError("curls of " + std::to_string(sum) + " vertices: lower the subdivision, at most 2^32 - 1 fit");
  return offsets;
}

}  // namespace

Curls::Curls(const Strands& lines, const CurlSettings& settings) {
  check(settings);
  riders_ = Riders(drawn_offsets(lines, settings.subdivision), lines);
  const auto k = static_cast<std::size_t>(settings.subdivision);
  rest_.offsets = riders_.offsets;
  rest_.vertices.resize(riders_.places.size());
  rest_.colours = lines.colours;
  rest_.diameter_m = lines.diameter_m;
  if (!lines.diameters_m.empty()) rest_.diameters_m.resize(rest_.vertices.size());
  for_strands(lines.count(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const std::span<Riders::Place> places = riders_.strand(s);
      if (places.empty()) continue;
      const Helix helix(settings, lines.strand(s), s);
      const std::size_t last = std::max<std::size_t>(places.size() / k, 1) - 1;  // segment
      for (std::size_t i = 0; i < places.size(); ++i) {
        const std::size_t segment = std::min(i / k, last);
        const float fraction = static_cast<float>(i - segment * k) / static_cast<float>(k);
        places[i] = {helix.offset(segment, fraction), fraction, static_cast<std::uint32_t>(segment)};
        if (rest_.diameters_m.empty()) continue;
        const float* d = lines.diameters_m.data() + lines.offsets[s] + segment;
        rest_.diameters_m[rest_.offsets[s] + i] = fraction > 0 ? d[0] + fraction * (d[1] - d[0]) : d[0];
      }
    }
  });
  apply(lines, glm::dquat(1, 0, 0, 0), rest_);
}

void Curls::apply(const Strands& lines, const glm::dquat& turn, Strands& out) const {
  riders_.ride(lines, turn, out.vertices);
}

Strands curled(const Strands& lines, const CurlSettings& settings) {
  return settings.radius_m > 0 ? Curls(lines, settings).rest() : lines;
}

}  // namespace pelage
