#include "pelage/simulate/wisps.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <string>

#include "pelage/data_schema/errors.h"
#include "pelage/simulate/for_strands.h"
#include "pelage/simulate/moving_line.h"
#include "pelage/simulate/strand_groups.h"

namespace pelage {
namespace {

using glm::vec3;

constexpr std::size_t kGuides = 3;

void check(const Strands& lines, int wisps) {
  if (wisps < 1) throw UsageError("wisps: " + std::to_string(wisps) + ", at least 1 is needed");
  for (std::size_t s = 0; s < lines.count(); ++s) {
    for (const vec3& p : lines.strand(s))
      if (!std::isfinite(p.x + p.y + p.z)) throw InputError("line " + std::to_string(s), "a vertex is not finite");
  }
}

/// Members of each group that has any, ascending.
std::vector<std::vector<std::uint32_t>> members_of(const StrandGroups& groups) {
  std::vector<std::vector<std::uint32_t>> members(groups.centres.size());
  for (std::size_t i = 0; i < groups.label.size(); ++i)
    members[groups.label[i]].push_back(static_cast<std::uint32_t>(i));
  std::erase_if(members, [](const auto& m) { return m.empty(); });
  return members;
}

/// Rows of a group that guide it: nearest to the centres of its three parts, no row twice.
std::vector<std::uint32_t> guides_of(std::span<const StrandFeature> rows, std::span<const std::uint32_t> members) {
  std::vector<std::uint32_t> guides;
  if (members.size() <= kGuides) return {members.begin(), members.end()};
  std::vector<StrandFeature> own;
  for (const std::uint32_t i : members) own.push_back(rows[i]);
  std::vector<StrandFeature> centres = group_strands(own, static_cast<int>(kGuides)).centres;
  centres.resize(kGuides, centres[0]);  // equal strands have fewer parts
  for (const StrandFeature& centre : centres) {
    float least = std::numeric_limits<float>::max();
    std::uint32_t best = members[0];
    for (const std::uint32_t i : members) {
      const float d = distance2(rows[i], centre);
      if (d < least && std::find(guides.begin(), guides.end(), i) == guides.end()) least = d, best = i;
    }
    guides.push_back(best);
  }
  return guides;
}

/// Weights by inverse squared distance of root, middle and tip.
Guidance guidance_of(const StrandFeature& row, std::span<const StrandFeature> guides, std::uint32_t first) noexcept {
  Guidance g;
  g.guide.fill(first);
  for (std::size_t k = 0; k < guides.size(); ++k) {
    g.guide[k] = first + static_cast<std::uint32_t>(k);
    const float d = distance2(row, guides[k]);
    if (!(d > 1e-12F)) {  // a micrometre: the guide itself, or its double
      g.weight = {};
      g.weight[k] = 1;
      return g;
    }
    g.weight[k] = 1 / d;
  }
  const float sum = g.weight[0] + g.weight[1] + g.weight[2];
  for (float& w : g.weight) w /= sum;
  return g;
}

/// Point at a share of the way along a line, by its vertices.
vec3 point_at(std::span<const vec3> line, float share) noexcept {
  const float at = share * static_cast<float>(line.size() - 1);
  const std::size_t k = std::min(static_cast<std::size_t>(at), line.size() - 1),
                    next = std::min(k + 1, line.size() - 1);
  return line[k] + (at - static_cast<float>(k)) * (line[next] - line[k]);
}

/// Segments get their lengths back, from the root on, each in its direction; one without a direction takes that of the
/// segment before.
void restore_lengths(std::span<vec3> line, const float* segment_m) noexcept {
  vec3 direction(0), last = line[0];
  for (std::size_t i = 1; i < line.size(); ++i) {
    const vec3 d = line[i] - last;
    const float dd = glm::dot(d, d);
    if (dd > 1e-18F) direction = d / std::sqrt(dd);
    last = line[i];
    line[i] = line[i - 1] + segment_m[i] * direction;
  }
}

}  // namespace

Wisps::Wisps(const Strands& lines, int wisps)
    : guidance_(lines.count()),
      riders_(lines.offsets, lines),
      to_root_(lines.count()),
      segment_m_(lines.vertices.size()) {
  check(lines, wisps);
  std::vector<std::uint32_t> strand_of;  // [row]
  std::vector<StrandFeature> rows;
  for (std::size_t s = 0; s < lines.count(); ++s) {
    if (lines.strand(s).empty()) continue;
    strand_of.push_back(static_cast<std::uint32_t>(s));
    rows.push_back(strand_feature(lines.strand(s)));
  }
  guides_.diameter_m = lines.diameter_m;
  for (const std::vector<std::uint32_t>& members : members_of(group_strands(rows, wisps))) {
    const std::vector<std::uint32_t> chosen = guides_of(rows, members);
    const auto first = static_cast<std::uint32_t>(guides_.count());
    std::vector<StrandFeature> features;
    for (const std::uint32_t row : chosen) {
      guides_.append(lines.strand(strand_of[row]));
      features.push_back(rows[row]);
    }
    for (const std::uint32_t row : members) guidance_[strand_of[row]] = guidance_of(rows[row], features, first);
  }
  for_strands(lines.count(), [&](std::size_t begin, std::size_t end) {
    MovingLine moving;
    std::vector<vec3> mean;
    for (std::size_t s = begin; s < end; ++s) {
      const std::span<const vec3> line = lines.strand(s);
      if (line.empty()) continue;
      mean.resize(line.size());
      carrier(guides_, s, vec3(0), mean);
      to_root_[s] = line[0] - mean[0];
      for (vec3& p : mean) p += to_root_[s];
      riders_.first[s] = first_frame(mean);
      moving.set(mean, riders_.first[s]);
      const std::size_t last = std::max<std::size_t>(line.size(), 2) - 2;  // segment
      for (std::size_t i = 0; i < line.size(); ++i) {
        Riders::Place& place = riders_.strand(s)[i];
        place.segment = static_cast<std::uint32_t>(std::min(i, last));
        place.fraction = i > last ? 1.0F : 0.0F;
        place.offset = moving.offset_of(line[i], place.segment, place.fraction);
        if (i > 0) segment_m_[lines.offsets[s] + i] = glm::distance(line[i - 1], line[i]);
      }
      riders_.strand(s)[0].offset = vec3(0);
    }
  });
}

void Wisps::carrier(const Strands& guides, std::size_t strand, const vec3& to_root, std::span<vec3> line) const {
  const Guidance& g = guidance_[strand];
  std::fill(line.begin(), line.end(), to_root);
  for (std::size_t k = 0; k < kGuides; ++k) {
    if (!(g.weight[k] > 0)) continue;
    const std::span<const vec3> guide = guides.strand(g.guide[k]);
    if (guide.size() == line.size()) {
      for (std::size_t i = 0; i < line.size(); ++i) line[i] += g.weight[k] * guide[i];
    } else {
      const float step = 1.0F / static_cast<float>(std::max<std::size_t>(line.size() - 1, 1));
      for (std::size_t i = 0; i < line.size(); ++i)
        line[i] += g.weight[k] * point_at(guide, std::min(step * static_cast<float>(i), 1.0F));
    }
  }
}

void Wisps::interpolate(const Strands& guides, const glm::dquat& turn, Strands& out) const {
  PELAGE_ASSERT(guides.offsets == guides_.offsets && out.offsets == riders_.offsets);
  const glm::quat turn_f(turn);
  for_strands(guidance_.size(), [&](std::size_t begin, std::size_t end) {
    MovingLines moving;
    std::vector<vec3> carriers;
    std::array<std::span<const vec3>, kFrameLanes> group;
    std::array<glm::quat, kFrameLanes> frames;
    for (std::size_t s = begin; s < end; s += kFrameLanes) {
      const std::size_t n = std::min(kFrameLanes, end - s), first = riders_.offsets[s];
      carriers.resize(riders_.offsets[s + n] - first);
      for (std::size_t l = 0; l < n; ++l) {
        const std::size_t vertices = riders_.offsets[s + l + 1] - riders_.offsets[s + l];
        const std::span<vec3> line = std::span(carriers).subspan(riders_.offsets[s + l] - first, vertices);
        if (!line.empty()) carrier(guides, s + l, turned(turn_f, to_root_[s + l]), line);
        group[l] = line, frames[l] = turn_f * riders_.first[s + l];
      }
      moving.set(std::span(group).first(n), frames);
      for (std::size_t l = 0; l < n; ++l) {
        const std::span<vec3> strand = std::span(out.vertices).subspan(riders_.offsets[s + l], group[l].size());
        riders_.ride(s + l, moving[l], strand);
        if (!strand.empty()) restore_lengths(strand, segment_m_.data() + riders_.offsets[s + l]);
      }
    }
  });
}

}  // namespace pelage
