#include "pelage/hair/hair_file.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <glm/glm.hpp>
#include <utility>

#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/output_file.h"
#include "pelage/hair/hair_clean.h"
#include "pelage/hair/hair_formats.h"
#include "pelage/hair/input_file.h"
#include "pelage/hair/text_words.h"

namespace pelage::hair {
namespace {

namespace fs = std::filesystem;

constexpr float kMaxCoordinate_m = 1e6F;  // 1000 km: beyond it squares of lengths lose all meaning in float
constexpr double kMinMedianLength_m = 3e-3, kMaxMedianLength_m = 3.0;  // DESIGN section 3
constexpr double kLikelyLength_m = 0.15;  // of a strand on a head: decides which unit is proposed

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

std::size_t count_issues(const std::vector<StrandIssue>& issues, bool dropped) {
  return static_cast<std::size_t>(
      std::count_if(issues.begin(), issues.end(), [&](const StrandIssue& s) { return s.dropped == dropped; }));
}

}  // namespace

glm::vec3 to_metres(glm::vec3 p, const ReadOptions& options) noexcept {
  p = glm::vec3(options.metres_per_unit * glm::dvec3(p));  // rounded once: 30 cm are 0.3F
  if (options.up == UpAxis::z) return {p.x, p.z, -p.y};
  if (options.up == UpAxis::x) return {-p.y, p.x, p.z};
  return p;
}

bool is_usable(glm::vec3 p) noexcept {
  return std::abs(p.x) <= kMaxCoordinate_m && std::abs(p.y) <= kMaxCoordinate_m && std::abs(p.z) <= kMaxCoordinate_m;
}

bool is_unit(double metres) noexcept {
  return metres >= 1e-12 && metres <= 1e6;
}

void check_options(const ReadOptions& options) {
  if (is_unit(options.metres_per_unit)) return;
  throw UsageError("unit of " + text(options.metres_per_unit) +
                   " m: give m, cm, mm, in or a number of metres from 1e-12 to 1e6");
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
  return count_issues(issues, true) + dropped_unlisted;
}
std::size_t ReadReport::repaired() const noexcept {
  return count_issues(issues, false) + repaired_unlisted;
}

double parse_unit(std::string_view unit) {
  for (const NamedUnit& u : kUnits) {
    if (unit == u.name) return u.metres;
  }
  const std::optional<double> metres = parse_double(unit);
  if (!metres || !is_unit(*metres)) {
    throw UsageError("unit \"" + std::string(unit) + "\": give m, cm, mm, in or metres per unit from 1e-12 to 1e6");
  }
  return *metres;
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
  const RawHair raw = format_of(bytes, where).decode(bytes, where);
  ReadReport local;
  Strands strands = clean(raw, options, where, local);
  if (report != nullptr) *report = std::move(local);
  return strands;
}

Strands read_hair(const fs::path& file, const ReadOptions& options, ReadReport* report) {
  return parse_hair(read_bytes(file), file.string(), options, report);
}

void check_hair_output(const fs::path& file) {
  format_to_write(file);
}

std::string format_strands(const Strands& strands, const fs::path& file, std::optional<float> opacity,
                           WriteReport* report) {
  const Format& format = format_to_write(file);
  WriteReport local{format.name};
  const auto lose = [&](bool there, Holds what, const char* name) {
    if (there && (format.holds & what) == 0)
      local.lost.push_back(std::string(name) + ": " + format.name + " has no place for it");
  };
  lose(!strands.colours.empty(), kColours, "colour");
  lose(has_diameters(strands), kDiameters, "diameter");
  lose(opacity.has_value(), kOpacity, "opacity");
  const std::string where = file.string();
  Output output{where, opacity, local};
  std::string bytes = format.encode(strands, output);
  if (report != nullptr) *report = std::move(local);
  return bytes;
}

WriteReport write_strands(const Strands& strands, const fs::path& file, std::optional<float> opacity) {
  WriteReport report;
  const std::string bytes = format_strands(strands, file, opacity, &report);
  AtomicFile out(file);
  out.write(bytes);
  out.commit();
  return report;
}

void write_hair(const Strands& strands, const fs::path& file) {
  const std::string where = file.string();
  WriteReport none;
  Output output{where, std::nullopt, none};
  const std::string bytes = encode_hair(strands, output);
  AtomicFile out(file);
  out.write(bytes);
  out.commit();
}

}  // namespace pelage::hair
