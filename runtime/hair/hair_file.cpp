#include "pelage/hair/hair_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <glm/glm.hpp>
#include <glm/vec4.hpp>
#include <utility>

#include "pelage/data_schema/errors.h"
#include "pelage/hair/hair_reader.h"
#include "pelage/hair/input_file.h"
#include "pelage/hair/resample.h"

namespace pelage::hair {
namespace {

namespace fs = std::filesystem;

constexpr float kMaxCoordinate_m = 1e6F;  // 1000 km: beyond it squares of lengths lose all meaning in float
constexpr double kMinMedianLength_m = 3e-3, kMaxMedianLength_m = 3.0;  // DESIGN section 3
constexpr double kLikelyLength_m = 0.15;     // of a strand on a head: decides which unit is proposed
constexpr float kMaxThicknessShare = 0.05F;  // of the median strand length: beyond it, thickness is no diameter

struct NamedUnit {
  const char* name;
  double metres;
};
constexpr NamedUnit kUnits[] = {{"m", 1.0}, {"cm", 0.01}, {"mm", 0.001}, {"in", 0.0254}};

std::string text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.4g", value);
  return buffer;
}

bool starts_with(std::span<const std::byte> bytes, std::string_view magic) {
  return bytes.size() >= magic.size() && std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}

/// Formats that people have and this build does not read, by their first bytes.
struct KnownFormat {
  std::string_view magic, name;
};
constexpr KnownFormat kRefused[] = {{"version", "TFX 2, the text format of TressFX 2"},
                                    {"Ogawa", "Alembic"},
                                    {"\x89HDF", "Alembic (HDF5)"},
                                    {"ply", "PLY"},
                                    {"BINARY_HAIR", "Mitsuba's binary hair"},
                                    {"\x80\xBF\x80"
                                     "FIBER",
                                     "Tungsten's fiber"}};

RawHair decode(std::span<const std::byte> bytes, const std::string& where) {
  if (starts_with(bytes, "HAIR") || starts_with(bytes, "hair")) return decode_hair(bytes, where);
  for (const KnownFormat& format : kRefused) {
    if (starts_with(bytes, format.magic)) {
      throw InputError(where,
                       std::string(format.name) + " is not read by this build: convert it to HAIR or TFX 4 (binary)");
    }
  }
  const bool named_tfx = fs::path(where).extension() == ".tfx";
  const bool looks_like_tfx = bytes.size() >= 4 && load<float>(bytes, 0) == 4.0F;
  if (named_tfx || looks_like_tfx) return decode_tfx(bytes, where);
  throw InputError(where,
                   "neither HAIR (first bytes \"HAIR\") nor TFX 4 (first number 4.0): convert it to one of them");
}

/// A vertex with its diameter: what a strand's repairs act on.
using ThickPoints = std::vector<glm::vec4>;

/// Uniform cubic B-spline over >= 4 control points, two vertices per control point, evenly in the parameter.
ThickPoints evaluate_b_spline_strand(const ThickPoints& control) {
  const std::size_t count = 2 * control.size();
  const std::size_t spans = control.size() - 3;
  ThickPoints points;
  for (std::size_t k = 0; k < count; ++k) {
    const double x = static_cast<double>(k * spans) / static_cast<double>(count - 1);
    const std::size_t span = std::min(static_cast<std::size_t>(x), spans - 1);
    const auto u = static_cast<float>(x - static_cast<double>(span));
    const float v = 1.0F - u;
    const glm::vec4* p = control.data() + span;
    points.push_back((v * v * v * p[0] + (3.0F * u * u * u - 6.0F * u * u + 4.0F) * p[1] +
                      (3.0F * v * v * v - 6.0F * v * v + 4.0F) * p[2] + u * u * u * p[3]) /
                     6.0F);
  }
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
    if (options_.curve == Curve::b_spline && points.size() >= 4) points = evaluate_b_spline_strand(points);
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
                          static_cast<float>(options_.metres_per_unit) * thickness);
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
    if (!good) repair(i, "colour that is no number replaced by the mean of the others");
  }

  void drop(std::size_t i, std::string reason) { report_.issues.push_back({i, true, std::move(reason)}); }
  void repair(std::size_t i, std::string reason) { report_.issues.push_back({i, false, std::move(reason)}); }

  const RawHair& raw_;
  const ReadOptions& options_;
  ReadReport& report_;
  float mean_thickness_;
  glm::vec3 mean_colour_;
  Strands strands_;
};

double median_length_m(const Strands& strands) {
  std::vector<double> lengths;
  for (std::size_t i = 0; i < strands.count(); ++i) lengths.push_back(arc_length_m(strands.strand(i)));
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  return *middle;
}

/// Thickness is a diameter only where it is small against the strands: 0 and 1 are also what writers leave that have
/// none.
void settle_thickness(const RawHair& raw, const ReadOptions& options, double median_m, Strands& strands,
                      ReadReport& report) {
  const float limit_m = kMaxThicknessShare * static_cast<float>(median_m);
  const float whole_file_m = static_cast<float>(options.metres_per_unit) * raw.default_thickness;
  const float mean_m = raw.thickness.empty() ? whole_file_m : mean_of<float, double>(strands.diameters_m, is_thickness);
  const bool initial_value = raw.thickness.empty() && (raw.default_thickness == 0.0F || raw.default_thickness == 1.0F);
  if (!initial_value && mean_m > 0.0F && mean_m <= limit_m) {
    if (raw.thickness.empty()) strands.diameter_m = whole_file_m;
    return;
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

std::size_t count_issues(const std::vector<StrandIssue>& issues, bool dropped) {
  return static_cast<std::size_t>(
      std::count_if(issues.begin(), issues.end(), [&](const StrandIssue& s) { return s.dropped == dropped; }));
}

}  // namespace

glm::vec3 to_metres(glm::vec3 p, const ReadOptions& options) noexcept {
  const auto scale = static_cast<float>(options.metres_per_unit);
  p *= scale;
  if (options.up == UpAxis::z) return {p.x, p.z, -p.y};
  if (options.up == UpAxis::x) return {-p.y, p.x, p.z};
  return p;
}

bool is_usable(glm::vec3 p) noexcept {
  return std::abs(p.x) <= kMaxCoordinate_m && std::abs(p.y) <= kMaxCoordinate_m && std::abs(p.z) <= kMaxCoordinate_m;
}

void check_options(const ReadOptions& options) {
  if (options.metres_per_unit > 0 && options.metres_per_unit <= 1e6) return;
  throw UsageError("unit of " + text(options.metres_per_unit) +
                   " m: give m, cm, mm, in or a positive number of metres");
}

std::vector<std::byte> read_bytes(const fs::path& file) {
  std::error_code error;
  if (!fs::exists(file, error)) throw InputError(file.string(), "no such file: check the path");
  if (!fs::is_regular_file(file, error)) throw InputError(file.string(), "not a regular file: give a hair file");
  std::ifstream in(file, std::ios::binary);
  std::vector<std::byte> bytes(in ? fs::file_size(file, error) : 0);
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!in) throw InputError(file.string(), "cannot be read: check its permissions");
  return bytes;
}

std::size_t ReadReport::dropped() const noexcept {
  return count_issues(issues, true);
}
std::size_t ReadReport::repaired() const noexcept {
  return count_issues(issues, false);
}

double parse_unit(std::string_view unit) {
  for (const NamedUnit& u : kUnits) {
    if (unit == u.name) return u.metres;
  }
  double metres = 0;
  const auto [end, error] = std::from_chars(unit.data(), unit.data() + unit.size(), metres);
  if (error != std::errc{} || end != unit.data() + unit.size() || !(metres > 0) || !(metres <= 1e6)) {
    throw UsageError("unit \"" + std::string(unit) + "\": give m, cm, mm, in or a positive number of metres per unit");
  }
  return metres;
}

UpAxis parse_up_axis(std::string_view axis) {
  if (axis == "x") return UpAxis::x;
  if (axis == "y") return UpAxis::y;
  if (axis == "z") return UpAxis::z;
  throw UsageError("up axis \"" + std::string(axis) + "\": give x, y or z");
}

Curve parse_curve(std::string_view curve) {
  if (curve == "polyline") return Curve::polyline;
  if (curve == "bspline") return Curve::b_spline;
  throw UsageError("curve \"" + std::string(curve) + "\": give polyline or bspline");
}

std::string implausible_unit(double median_length_m, double metres_per_unit) {
  if (median_length_m >= kMinMedianLength_m && median_length_m <= kMaxMedianLength_m) return {};
  const double median_units = median_length_m / metres_per_unit;
  const auto distance = [&](const NamedUnit& u) {
    return std::abs(std::log(median_units * u.metres / kLikelyLength_m));
  };
  const NamedUnit& best = *std::min_element(std::begin(kUnits), std::end(kUnits),
                                            [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
  const double length_m = median_units * best.metres;
  const bool fits = length_m >= kMinMedianLength_m && length_m <= kMaxMedianLength_m;
  std::string number = text(kLikelyLength_m / median_units);  // metres per unit that makes the median a likely one
  return "the median strand is " + text(median_length_m) + " m long, which no hair is: probably the unit is not " +
         text(metres_per_unit) + " m; try --unit " +
         (fits ? std::string(best.name) + " (median " + text(length_m) + " m)" : number + " (metres per unit)");
}

Strands parse_hair(std::span<const std::byte> bytes, const std::string& where, const ReadOptions& options,
                   ReadReport* report) {
  check_options(options);
  const RawHair raw = decode(bytes, where);
  ReadReport local;
  local.format = raw.format;
  local.strands_in_file = raw.offsets.size() - 1;
  local.notes = raw.notes;
  Strands strands = Cleaner(raw, options, local).run();
  if (strands.count() == 0) {
    const std::string why = local.issues.empty() ? "" : ", strand 0: " + local.issues.front().reason;
    throw InputError(where,
                     "no usable strand among " + std::to_string(local.strands_in_file) + why + ": export it again");
  }
  const double median_m = median_length_m(strands);
  const std::string doubt = implausible_unit(median_m, options.metres_per_unit);
  if (options.check_unit && !doubt.empty()) throw InputError(where, doubt);
  settle_thickness(raw, options, median_m, strands, local);
  settle_opacity(raw, local);
  if (report != nullptr) *report = std::move(local);
  return strands;
}

Strands read_hair(const fs::path& file, const ReadOptions& options, ReadReport* report) {
  return parse_hair(read_bytes(file), file.string(), options, report);
}

}  // namespace pelage::hair
