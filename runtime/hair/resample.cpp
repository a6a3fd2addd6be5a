#include "pelage/hair/resample.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>

#include "pelage/data_schema/errors.h"

namespace pelage::hair {
namespace {

constexpr double kMaxSegments = 65'534;  // a HAIR file's limit on the segments of a strand, so that all can be written

/// Where the k-th even sample lies: a segment and the fraction along it.
struct Place {
  std::size_t segment;
  float fraction;
};

/// Places of `count` even samples along a polyline of >= 1 point, arc length accumulated in double.
std::vector<Place> even_places(std::span<const glm::vec3> points, std::size_t count) {
  std::vector<double> arc(points.size(), 0.0);
  for (std::size_t i = 1; i < points.size(); ++i) {
    arc[i] = arc[i - 1] + glm::distance(glm::dvec3(points[i - 1]), glm::dvec3(points[i]));
  }
  std::vector<Place> places(count, Place{0, 0.0F});
  if (points.size() < 2) return places;
  std::size_t segment = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double target = arc.back() * static_cast<double>(k) / static_cast<double>(count - 1);
    while (segment + 2 < points.size() && arc[segment + 1] < target) ++segment;
    const double length = arc[segment + 1] - arc[segment];
    const double fraction = length > 0 ? std::clamp((target - arc[segment]) / length, 0.0, 1.0) : 0.0;
    places[k] = {segment, static_cast<float>(fraction)};
  }
  places.front() = {0, 0.0F};
  places.back() = {points.size() - 2, 1.0F};
  return places;
}

/// Linear interpolation that returns the ends bit for bit.
template <class T>
T sample(std::span<const T> values, Place place) {
  const T& a = values[place.segment];
  if (place.fraction == 0.0F) return a;
  const T& b = values[place.segment + 1];
  if (place.fraction == 1.0F) return b;
  return a + place.fraction * (b - a);
}

/// Strands counts vertices in 32 bits.
void check_total(double vertices) {
  if (vertices <= 4'294'967'295.0) return;
  throw UsageError("resampling would make " + std::to_string(static_cast<std::uint64_t>(vertices)) +
                   " vertices, 4294967295 can be counted: give fewer per strand");
}

void append_resampled(const Strands& in, std::size_t strand, std::size_t count, Strands& out) {
  const std::span<const glm::vec3> points = in.strand(strand);
  const std::vector<Place> places = points.empty() ? std::vector<Place>{} : even_places(points, count);
  for (const Place& place : places) out.vertices.push_back(sample(points, place));
  if (!in.diameters_m.empty()) {
    const std::span<const float> diameters(in.diameters_m.data() + in.offsets[strand], points.size());
    for (const Place& place : places) out.diameters_m.push_back(sample(diameters, place));
  }
  out.offsets.push_back(static_cast<std::uint32_t>(out.vertices.size()));
}

Strands without_vertices(const Strands& strands) {
  Strands out;
  out.colours = strands.colours;
  out.diameter_m = strands.diameter_m;
  return out;
}

}  // namespace

double arc_length_m(std::span<const glm::vec3> points) noexcept {
  double length = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    length += glm::distance(glm::dvec3(points[i - 1]), glm::dvec3(points[i]));
  }
  return length;
}

std::vector<glm::vec3> resample_polyline(std::span<const glm::vec3> points, int count) {
  PELAGE_ASSERT(!points.empty() && count >= 2);
  std::vector<glm::vec3> out;
  out.reserve(static_cast<std::size_t>(count));
  for (const Place& place : even_places(points, static_cast<std::size_t>(count))) out.push_back(sample(points, place));
  return out;
}

Strands resample(const Strands& strands, int vertices_per_strand) {
  if (vertices_per_strand < 2) {
    throw UsageError("vertices per strand " + std::to_string(vertices_per_strand) + ": give at least 2");
  }
  check_total(static_cast<double>(strands.count()) * vertices_per_strand);  // exact up to 2^53, and no more than 2^63
  Strands out = without_vertices(strands);
  for (std::size_t i = 0; i < strands.count(); ++i) {
    append_resampled(strands, i, static_cast<std::size_t>(vertices_per_strand), out);
  }
  return out;
}

Strands resample_to_spacing(const Strands& strands, float spacing_m) {
  if (!(spacing_m > 0) || !std::isfinite(spacing_m)) {
    throw UsageError("spacing " + std::to_string(spacing_m) + " m: give a positive number");
  }
  std::vector<double> counts;
  double total = 0;
  for (std::size_t i = 0; i < strands.count(); ++i) {
    const double segments = std::ceil(arc_length_m(strands.strand(i)) / static_cast<double>(spacing_m));
    counts.push_back(std::clamp(segments, 1.0, kMaxSegments) + 1);
    total += counts.back();
  }
  check_total(total);
  Strands out = without_vertices(strands);
  for (std::size_t i = 0; i < strands.count(); ++i)
    append_resampled(strands, i, static_cast<std::size_t>(counts[i]), out);
  return out;
}

}  // namespace pelage::hair
