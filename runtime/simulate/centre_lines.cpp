#include "pelage/simulate/centre_lines.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <span>
#include <string>

#include "pelage/data_schema/errors.h"
#include "pelage/simulate/for_strands.h"
#include "pelage/simulate/moving_line.h"
#include "pelage/simulate/smooth_strand.h"

namespace pelage {
namespace {

using glm::dvec3;
using glm::vec3;

constexpr double kHalfWidth = 2;          // of the hat, in segments
constexpr int kSamples = 8;               // of the smooth strand per segment
constexpr double kChordTolerance = 1e-8;  // of a chord
constexpr int kRounds = 200;

void check(const Strands& hair, int vertices) {
  if (vertices < 2)
    throw UsageError("centre lines of " + std::to_string(vertices) + " vertices: at least 2 are needed");
  for (std::size_t s = 0; s < hair.count(); ++s) {
    for (const vec3& p : hair.strand(s))
      if (!std::isfinite(p.x + p.y + p.z)) throw InputError("strand " + std::to_string(s), "a vertex is not finite");
  }
}

/// Segments of a strand among strands of which the longest has `most`.
int segments_of(double length, double longest, int most, std::size_t vertices) noexcept {
  const int least = vertices > 2 ? std::min(2, most) : 1;
  return longest > 0 ? std::clamp(static_cast<int>(std::lround(most * length / longest)), least, most) : least;
}

double half_width(double length, int segments) noexcept {
  return std::min(kHalfWidth * length / segments, length);
}

/// One strand at a time: smoothed, sampled, cut into equal chords.
class LineMaker {
 public:
  /// @return length of the smoothed strand [m]
  double smooth(std::span<const vec3> strand, int segments) {
    smooth_.set(strand);
    const double length = smooth_.length_m(), width = half_width(length, segments);
    const int samples = kSamples * segments;
    samples_.resize(static_cast<std::size_t>(samples) + 1);
    double sum = 0;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      samples_[i] = smooth_.at(length * static_cast<double>(i) / samples, width);
      if (i > 0) sum += glm::distance(samples_[i - 1], samples_[i]);
    }
    return sum;
  }

  /// `out`: the vertices, root and tip as they are in the strand. After smooth().
  /// Places on the samples move towards where the way along the chords so far is even, until it is.
  void cut(std::span<const vec3> strand, std::span<vec3> out) {
    const std::size_t segments = out.size() - 1;
    places_.resize(out.size());
    chords_.resize(out.size());
    for (std::size_t i = 0; i <= segments; ++i)
      places_[i] = static_cast<double>(i * (samples_.size() - 1)) / static_cast<double>(segments);
    for (int round = 0; round < kRounds && measure_chords() > kChordTolerance; ++round) even_places();
    for (std::size_t i = 1; i < segments; ++i) out[i] = vec3(sample(places_[i]));
    out.front() = strand.front();
    out.back() = strand.back();
  }

 private:
  dvec3 sample(double place) const noexcept {
    const std::size_t k = std::min(static_cast<std::size_t>(place), samples_.size() - 2);
    return samples_[k] + (place - static_cast<double>(k)) * (samples_[k + 1] - samples_[k]);
  }

  /// chords_[i]: way along the chords to place i. @return largest deviation of a chord from the mean, as a share of it
  double measure_chords() noexcept {
    dvec3 last = samples_.front();
    double least = std::numeric_limits<double>::max(), most = 0;
    chords_[0] = 0;
    for (std::size_t i = 1; i < places_.size(); ++i) {
      const dvec3 p = sample(places_[i]);
      const double chord = glm::distance(last, p);
      least = std::min(least, chord), most = std::max(most, chord);
      chords_[i] = chords_[i - 1] + chord;
      last = p;
    }
    return most > 0 ? (most - least) / most : 0;
  }

  void even_places() {
    const double mean = chords_.back() / static_cast<double>(places_.size() - 1);
    before_ = places_;
    for (std::size_t i = 1, k = 1; i + 1 < places_.size(); ++i) {
      const double way = mean * static_cast<double>(i);
      while (k + 1 < places_.size() && chords_[k] < way) ++k;
      const double chord = chords_[k] - chords_[k - 1];
      const double share = chord > 0 ? std::clamp((way - chords_[k - 1]) / chord, 0.0, 1.0) : 0.0;
      places_[i] = before_[k - 1] + share * (before_[k] - before_[k - 1]);
    }
  }

  SmoothStrand smooth_;
  std::vector<dvec3> samples_;
  std::vector<double> places_, before_, chords_;
};

/// Diameters of a strand at even places along it, one for each vertex of its line.
void resample_diameters(std::span<const float> from, std::span<float> to) noexcept {
  for (std::size_t i = 0; i < to.size(); ++i) {
    const float at = static_cast<float>(i) / static_cast<float>(to.size() - 1) * static_cast<float>(from.size() - 1);
    const std::size_t k = std::min(static_cast<std::size_t>(at), from.size() - 1),
                      next = std::min(k + 1, from.size() - 1);
    to[i] = from[k] + (at - static_cast<float>(k)) * (from[next] - from[k]);
  }
}

/// Places of a strand's vertices on its line, by arc length: as far along as the smoothed strand has come.
void place_strand(std::span<const vec3> strand, std::span<const vec3> line, const glm::quat& first,
                  std::span<Riders::Place> places) {
  const std::size_t segments = line.size() - 1;
  SmoothStrand smooth;
  smooth.set(strand);
  const double width = segments > 0 ? half_width(smooth.length_m(), static_cast<int>(segments)) : 0.0;
  std::vector<double> along(strand.size(), 0.0);
  dvec3 last(strand[0]);
  for (std::size_t i = 1; i < strand.size(); ++i) {
    const dvec3 p = smooth.at(smooth.arc_m(i), width);
    along[i] = along[i - 1] + glm::distance(last, p);
    last = p;
  }
  MovingLine moving;
  moving.set(line, first);
  for (std::size_t i = 0; i < strand.size(); ++i) {
    const double at = along.back() > 0 ? along[i] / along.back() * static_cast<double>(segments) : 0.0;
    Riders::Place& place = places[i];
    place.segment = static_cast<std::uint32_t>(std::min(at, std::max(static_cast<double>(segments) - 1, 0.0)));
    place.fraction = static_cast<float>(std::min(at - place.segment, 1.0));
    place.offset = moving.offset_of(strand[i], place.segment, place.fraction);
  }
}

}  // namespace

Strands centre_lines(const Strands& hair, int vertices) {
  check(hair, vertices);
  const int most = vertices - 1;
  const std::size_t count = hair.count();
  std::vector<double> hair_length(count), length(count);
  std::vector<int> smoothing(count);  // segments that the window was chosen for
  for_strands(count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const std::span<const vec3> strand = hair.strand(s);
      for (std::size_t i = 1; i < strand.size(); ++i)
        hair_length[s] += glm::distance(dvec3(strand[i - 1]), dvec3(strand[i]));
    }
  });
  const double longest_hair = count > 0 ? *std::max_element(hair_length.begin(), hair_length.end()) : 0.0;
  for_strands(count, [&](std::size_t begin, std::size_t end) {
    LineMaker maker;
    for (std::size_t s = begin; s < end; ++s) {
      if (hair.strand(s).empty()) continue;
      smoothing[s] = segments_of(hair_length[s], longest_hair, most, hair.strand(s).size());
      length[s] = maker.smooth(hair.strand(s), smoothing[s]);
    }
  });
  const double longest = count > 0 ? *std::max_element(length.begin(), length.end()) : 0.0;

  Strands lines;
  lines.diameter_m = hair.diameter_m;
  lines.colours = hair.colours;
  lines.offsets.resize(count + 1, 0);
  for (std::size_t s = 0; s < count; ++s) {
    const std::size_t n = hair.strand(s).size();
    const int used = n > 0 ? segments_of(length[s], longest, most, n) + 1 : 0;
    lines.offsets[s + 1] = lines.offsets[s] + static_cast<std::uint32_t>(used);
  }
  lines.vertices.resize(lines.offsets.back());
  if (!hair.diameters_m.empty()) lines.diameters_m.resize(lines.vertices.size());
  for_strands(count, [&](std::size_t begin, std::size_t end) {
    LineMaker maker;
    for (std::size_t s = begin; s < end; ++s) {
      const std::size_t first = lines.offsets[s], n = lines.offsets[s + 1] - first;
      if (n == 0) continue;
      maker.smooth(hair.strand(s), smoothing[s]);
      maker.cut(hair.strand(s), std::span(lines.vertices).subspan(first, n));
      if (lines.diameters_m.empty()) continue;
      resample_diameters(std::span(hair.diameters_m).subspan(hair.offsets[s], hair.strand(s).size()),
                         std::span(lines.diameters_m).subspan(first, n));
    }
  });
  return lines;
}

StrandDetail::StrandDetail(const Strands& hair, const Strands& lines) {
  if (lines.count() != hair.count()) {
    throw InputError("centre lines",
                     std::to_string(lines.count()) + " for " + std::to_string(hair.count()) + " strands");
  }
  check(hair, 2);
  check(lines, 2);
  for (std::size_t s = 0; s < hair.count(); ++s) {
    if (lines.strand(s).empty() && !hair.strand(s).empty())
      throw InputError("centre line " + std::to_string(s), "has no vertices, its strand has");
  }
  riders_ = Riders(hair.offsets, lines);
  for_strands(hair.count(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s)
      if (!hair.strand(s).empty()) place_strand(hair.strand(s), lines.strand(s), riders_.first[s], riders_.strand(s));
  });
}

void StrandDetail::apply(const Strands& lines, const glm::dquat& turn, Strands& out) const {
  riders_.ride(lines, turn, out.vertices);
}

}  // namespace pelage
