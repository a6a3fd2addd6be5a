// Turns what a file says into clean Strands, strand by strand, and keeps account of what was repaired or dropped.
#include "pelage/hair/hair_clean.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <glm/glm.hpp>
#include <glm/vec4.hpp>
#include <utility>

#include "pelage/data_schema/errors.h"
#include "pelage/hair/curve_basis.h"
#include "pelage/hair/input_file.h"
#include "pelage/hair/resample.h"

namespace pelage::hair {
namespace {

constexpr float kMaxThicknessShare = 0.05F;  // of the median strand length: beyond it, thickness is no diameter

std::string text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.4g", value);
  return buffer;
}

/// A vertex with its diameter: what a strand's repairs act on.
using ThickPoints = std::vector<glm::vec4>;

/// Uniform cubic B-spline over >= 4 control points, two vertices per control point, evenly in the parameter.
ThickPoints evaluate_b_spline_strand(const ThickPoints& control) {
  const CurveSpans spans = divide(Basis::b_spline, control.size());
  ThickPoints points;
  for (std::size_t k = 0; k < spans.vertices; ++k) points.push_back(evaluate(Basis::b_spline, spans, control, k));
  return points;
}

/// Removes vertices equal to their predecessor; returns how many there were.
std::size_t merge_repeated(ThickPoints& points) {
  const auto same_place = [](const glm::vec4& a, const glm::vec4& b) { return glm::vec3(a) == glm::vec3(b); };
  const auto end = std::unique(points.begin(), points.end(), same_place);
  const auto removed = static_cast<std::size_t>(points.end() - end);
  points.erase(end, points.end());
  return removed;
}

bool is_thickness(float t) {
  return t >= 0.0F && std::isfinite(t);
}
bool is_colour(glm::vec3 c) {
  return std::isfinite(c.x) && std::isfinite(c.y) && std::isfinite(c.z);
}

/// Mean of the values that `good` accepts, zero without any.
template <class T, class D, class Good>
T mean_of(const std::vector<T>& values, Good good) {
  D sum(0.0);
  double n = 0;
  for (const T& v : values) {
    if (!good(v)) continue;
    sum += D(v);
    n += 1;
  }
  return n > 0 ? T(sum / n) : T(0.0F);
}

/// Turns what the file says into clean Strands, strand by strand, and keeps account.
class Cleaner {
 public:
  Cleaner(const RawHair& raw, const ReadOptions& options, ReadReport& report)
      : raw_(raw),
        options_(options),
        report_(report),
        mean_thickness_(mean_of<float, double>(raw.thickness, is_thickness)),
        mean_colour_(glm::clamp(mean_of<glm::vec3, glm::dvec3>(raw.colours, is_colour), 0.0F, 1.0F)) {}

  Strands run() {
    for (std::size_t i = 0; i + 1 < raw_.offsets.size(); ++i) add(i);
    if (clamped_colours_ > 0)
      report_.notes.push_back("colours of " + counted(clamped_colours_, "strand") + " clamped to 0 to 1");
    return std::move(strands_);
  }

 private:
  void add(std::size_t i) {
    ThickPoints points = points_of(i);
    const auto bad = std::find_if(points.begin(), points.end(), [](const glm::vec4& p) { return !is_usable(p); });
    if (bad != points.end()) {
      return drop(i, "vertex " + std::to_string(bad - points.begin()) + " is not a finite position within 1000 km");
    }
    if (points.size() < 2) return drop(i, std::to_string(points.size()) + " vertices, a strand needs 2");
    if (options_.curve == Curve::b_spline && !raw_.says_curve && points.size() >= 4)
      points = evaluate_b_spline_strand(points);
    const std::size_t merged = merge_repeated(points);
    if (points.size() < 2) return drop(i, "all vertices are at the same place");
    if (merged > 0) repair(i, std::to_string(merged) + " zero-length segments merged");
    append(i, points);
  }

  ThickPoints points_of(std::size_t i) {
    ThickPoints points;
    bool bad_thickness = false;
    for (std::size_t k = raw_.offsets[i]; k < raw_.offsets[i + 1]; ++k) {
      float thickness = raw_.thickness.empty() ? 0.0F : raw_.thickness[k];
      if (!is_thickness(thickness)) {
        thickness = mean_thickness_;
        bad_thickness = true;
      }
      points.emplace_back(to_metres(raw_.points[k], options_),
                          static_cast<float>(options_.metres_per_unit * static_cast<double>(thickness)));
    }
    if (bad_thickness) repair(i, "thickness that is no number >= 0 replaced by the mean of the others");
    return points;
  }

  void append(std::size_t i, const ThickPoints& points) {
    for (const glm::vec4& p : points) {
      strands_.vertices.emplace_back(p);
      if (!raw_.thickness.empty()) strands_.diameters_m.push_back(p.w);
    }
    strands_.offsets.push_back(static_cast<std::uint32_t>(strands_.vertices.size()));
    if (raw_.colours.empty()) return;
    const bool good = is_colour(raw_.colours[i]);
    strands_.colours.push_back(good ? glm::clamp(raw_.colours[i], 0.0F, 1.0F) : mean_colour_);
    if (good && strands_.colours.back() != raw_.colours[i]) ++clamped_colours_;
    if (!good) repair(i, "colour that is no number replaced by the mean of the others");
  }

  void drop(std::size_t i, std::string reason) { list(report_.dropped_unlisted, {i, true, std::move(reason)}); }
  void repair(std::size_t i, std::string reason) { list(report_.repaired_unlisted, {i, false, std::move(reason)}); }
  void list(std::size_t& unlisted, StrandIssue issue) {
    if (report_.issues.size() < kMaxIssues)
      report_.issues.push_back(std::move(issue));
    else
      ++unlisted;
  }

  const RawHair& raw_;
  const ReadOptions& options_;
  ReadReport& report_;
  float mean_thickness_;
  glm::vec3 mean_colour_;
  std::size_t clamped_colours_ = 0;
  Strands strands_;
};

double median_length_m(const Strands& strands) {
  std::vector<double> lengths;
  for (std::size_t i = 0; i < strands.count(); ++i) lengths.push_back(arc_length_m(strands.strand(i)));
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  return *middle;
}

/// One diameter for all, where the file repeats it: formats differ in how they say so.
void collapse_equal(Strands& strands) {
  std::vector<float>& d = strands.diameters_m;
  if (d.empty() || std::adjacent_find(d.begin(), d.end(), std::not_equal_to<>()) != d.end()) return;
  strands.diameter_m = d.front();
  d.clear();
}

/// Thickness is a diameter only where it is small against the strands: 0 and 1 are also what writers leave that have
/// none.
void settle_thickness(const RawHair& raw, const ReadOptions& options, double median_m, Strands& strands,
                      ReadReport& report) {
  const float limit_m = kMaxThicknessShare * static_cast<float>(median_m);
  const float whole_file_m = static_cast<float>(options.metres_per_unit * static_cast<double>(raw.default_thickness));
  const float mean_m = raw.thickness.empty() ? whole_file_m : mean_of<float, double>(strands.diameters_m, is_thickness);
  const bool initial_value = raw.thickness.empty() && (raw.default_thickness == 0.0F || raw.default_thickness == 1.0F);
  if (!initial_value && mean_m > 0.0F && mean_m <= limit_m) {
    strands.diameter_m = raw.thickness.empty() ? whole_file_m : 0.0F;
    return collapse_equal(strands);
  }
  strands.diameters_m.clear();
  if (initial_value) return;
  report.notes.push_back("thickness " + text(static_cast<double>(mean_m)) +
                         " m ignored: no plausible diameter for strands of " + text(median_m) + " m");
}

void settle_opacity(const RawHair& raw, ReadReport& report) {
  if (!raw.opacity) return;
  if (*raw.opacity > 0.0F && *raw.opacity <= 1.0F) {
    report.opacity = raw.opacity;
  } else {
    report.notes.push_back("transparency ignored: opacity would be " + text(static_cast<double>(*raw.opacity)));
  }
}

/// The file's own unit and axis win over the options; an option that says something else is told.
ReadOptions settle_frame(const RawHair& raw, ReadOptions options, ReadReport& report) {
  if (raw.metres_per_unit) {
    if (options.metres_per_unit != 1.0 && options.metres_per_unit != *raw.metres_per_unit)
      report.notes.push_back("--unit ignored: the file says " + text(*raw.metres_per_unit) + " m per unit");
    options.metres_per_unit = *raw.metres_per_unit;
  }
  if (raw.up) {
    if (options.up != UpAxis::y && options.up != *raw.up)
      report.notes.push_back("--up ignored: the file says its up axis");
    options.up = *raw.up;
  }
  if (raw.says_curve && options.curve != Curve::polyline)
    report.notes.push_back("--curve ignored: the file says what its vertices are");
  return options;
}

/// The decoder's repairs and the cleaner's issues, each in order of strand, as one list of at most kMaxIssues.
void merge_repairs(std::vector<StrandIssue> repairs, ReadReport& report) {
  std::vector<StrandIssue>& issues = report.issues;
  const auto middle = static_cast<std::ptrdiff_t>(repairs.size());
  repairs.insert(repairs.end(), issues.begin(), issues.end());
  std::inplace_merge(repairs.begin(), repairs.begin() + middle, repairs.end(),
                     [](const StrandIssue& a, const StrandIssue& b) { return a.strand < b.strand; });
  issues = std::move(repairs);
  for (; issues.size() > kMaxIssues; issues.pop_back())
    ++(issues.back().dropped ? report.dropped_unlisted : report.repaired_unlisted);
}

/// Why the first strand that was dropped was.
std::string first_drop(const ReadReport& report) {
  const auto it = std::find_if(report.issues.begin(), report.issues.end(), [](const auto& s) { return s.dropped; });
  return it == report.issues.end() ? "" : ", strand " + std::to_string(it->strand) + ": " + it->reason;
}

}  // namespace

Strands clean(const RawHair& raw, const ReadOptions& given, const std::string& where, ReadReport& report) {
  report.format = raw.format;
  report.strands_in_file = raw.offsets.size() - 1;
  report.notes = raw.notes;
  if (raw.varying_colours > 0) {
    report.notes.push_back("per-point colours averaged to one per strand: they vary along " +
                           counted(raw.varying_colours, "strand"));
  }
  const ReadOptions options = settle_frame(raw, given, report);
  report.metres_per_unit = options.metres_per_unit;
  Strands strands = Cleaner(raw, options, report).run();
  merge_repairs(raw.repairs, report);
  if (strands.count() == 0) {
    throw InputError(where, "no usable strand among " + std::to_string(report.strands_in_file) + first_drop(report) +
                                ": export it again");
  }
  const double median_m = median_length_m(strands);
  const std::string doubt = implausible_unit(median_m, options.metres_per_unit);
  if (options.check_unit && !doubt.empty()) {
    throw InputError(
        where, doubt + (raw.metres_per_unit ? "; but this file says its unit itself, which goes first: correct it there"
                                            : ""));
  }
  settle_thickness(raw, options, median_m, strands, report);
  settle_opacity(raw, report);
  return strands;
}

}  // namespace pelage::hair
