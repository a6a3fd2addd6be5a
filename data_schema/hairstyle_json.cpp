// Hairstyle as JSON (schemas/hairstyle.schema.json, SCHEMA.md). Written with packed strands: base64 keeps every bit and
// is five times shorter than decimal text.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "pelage/data_schema/bake_settings_fields.h"
#include "pelage/data_schema/base64.h"
#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/json_file.h"
#include "pelage/data_schema/output_file.h"
#include "pelage/data_schema/procedural_strands.h"
#include "pelage/data_schema/validate.h"

namespace pelage {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

constexpr std::size_t kMaxProceduralStrands = 1'000'000;  // per file: 400 MB of points
constexpr float kMaxDisk = 1000.0F;                       // farther than any strand of a fitted cluster strays

static_assert(std::endian::native == std::endian::little, "packed strands are copied as they lie in memory");
static_assert(sizeof(DiskPoint) == 3 * sizeof(float));

/// The same curve with at least four control values: Bezier degree elevation (fewer than four are one Bezier segment).
template <class Value, class Mix>
std::vector<Value> at_least_four(std::vector<Value> controls, Mix mix) {
  while (controls.size() < 4) {
    const std::size_t n = controls.size();
    std::vector<Value> raised{controls.front()};
    for (std::size_t k = 1; k < n; ++k)
      raised.push_back(mix(controls[k], controls[k - 1], static_cast<float>(k) / static_cast<float>(n)));
    raised.push_back(controls.back());
    controls = std::move(raised);
  }
  return controls;
}

std::vector<glm::vec3> read_centre_line(const json& j) {
  std::vector<glm::vec3> points(j.size());
  for (std::size_t i = 0; i < j.size(); ++i) json_fields::get(j[i], points[i]);
  return at_least_four(points, [](glm::vec3 a, glm::vec3 b, float w) { return a + w * (b - a); });
}

std::vector<CrossSection> read_cross_sections(const json& cluster) {
  std::vector<CrossSection> sections;
  const auto number = [](const json& j) { return static_cast<float>(j.get<double>()); };
  if (cluster.contains("radii_m")) {
    const json& radii = cluster["radii_m"];
    for (const json& radius : radii.is_array() ? radii : json::array({radii}))
      sections.push_back({number(radius), 0.0F, number(radius)});
  } else {
    for (const json& s : cluster["cross_sections"]) sections.push_back({number(s[0]), number(s[1]), number(s[2])});
  }
  return at_least_four(sections, [](CrossSection a, CrossSection b, float w) {
    return CrossSection{a.xx + w * (b.xx - a.xx), a.xy + w * (b.xy - a.xy), a.yy + w * (b.yy - a.yy)};
  });
}

/// One perpendicular to the centre line at the root: the world axis least along it, made orthogonal.
glm::vec3 default_normal(const std::vector<glm::vec3>& centre_line) {
  const auto next = std::find_if(centre_line.begin(), centre_line.end(),
                                 [&](const glm::vec3& p) { return glm::length(p - centre_line[0]) > 0; });
  if (next == centre_line.end()) return {1, 0, 0};  // no length: check() refuses the cluster
  const glm::vec3 tangent = glm::normalize(*next - centre_line[0]), size = glm::abs(tangent);
  const glm::vec3 axis = size.x <= size.y && size.x <= size.z ? glm::vec3(1, 0, 0)
                         : size.y <= size.z                   ? glm::vec3(0, 1, 0)
                                                              : glm::vec3(0, 0, 1);
  return glm::normalize(axis - glm::dot(axis, tangent) * tangent);
}

glm::mat4 read_transform(const json& rows) {
  glm::mat4 m(1.0F);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column)
      json_fields::get(rows[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)], m[column][row]);
  return m;
}

std::vector<std::byte> decode(const json& packed, const char* key, std::size_t unit, const std::string& where) {
  auto bytes = base64_decode(packed[key].get_ref<const std::string&>());
  if (!bytes) throw InputError(where, "packed_strands/" + std::string(key) + " is not base64");
  if (bytes->size() % unit != 0)
    throw InputError(where, "packed_strands/" + std::string(key) + " holds " + std::to_string(bytes->size()) +
                                " bytes, which is no multiple of " + std::to_string(unit) + ": the file is cut");
  return *std::move(bytes);
}

void read_packed(Cluster& cluster, const json& packed, const std::string& where) {
  const auto counts = decode(packed, "points_per_strand", sizeof(std::uint32_t), where);
  const auto points = decode(packed, "points", sizeof(DiskPoint), where);
  cluster.strand_points.resize(points.size() / sizeof(DiskPoint));
  if (!points.empty()) std::memcpy(cluster.strand_points.data(), points.data(), points.size());
  std::uint64_t end = 0;
  for (std::size_t i = 0; i < counts.size(); i += sizeof(std::uint32_t)) {
    std::uint32_t count = 0;
    std::memcpy(&count, &counts[i], sizeof count);
    end += count;
    if (end > cluster.strand_points.size()) break;
    cluster.strand_offsets.push_back(static_cast<std::uint32_t>(end));
  }
  if (end != cluster.strand_points.size())
    throw InputError(where, "packed_strands: points_per_strand and points disagree: " +
                                std::to_string(cluster.strand_points.size()) + " points are there");
}

void read_explicit(Cluster& cluster, const json& strands) {
  for (const json& strand : strands) {
    for (const json& p : strand) {
      DiskPoint point{};
      json_fields::get(p[0], point.t);
      json_fields::get(p[1], point.x);
      json_fields::get(p[2], point.y);
      cluster.strand_points.push_back(point);
    }
    cluster.strand_offsets.push_back(static_cast<std::uint32_t>(cluster.strand_points.size()));
  }
}

void read_strands(Cluster& cluster, const json& j, const std::string& where) {
  if (j.contains("packed_strands"))
    read_packed(cluster, j["packed_strands"], where);
  else if (j.contains("strands"))
    read_explicit(cluster, j["strands"]);
  else
    append_procedural_strands(
        cluster, j["strand_count"].get<std::size_t>(),
        j.value("distribution", "uniform") == "shell" ? StrandDistribution::shell : StrandDistribution::uniform,
        j.value("seed", std::uint64_t{1}));
}

Cluster read_cluster(const json& j, const std::string& where) {
  Cluster cluster;
  cluster.centre_line = read_centre_line(j["centre_line"]);
  cluster.cross_sections = read_cross_sections(j);
  cluster.first_normal = default_normal(cluster.centre_line);
  if (j.contains("first_normal")) json_fields::get(j["first_normal"], cluster.first_normal);
  for (const json& rows : j.value("transforms", json::array())) cluster.transforms.push_back(read_transform(rows));
  if (j.contains("colour")) json_fields::get(j["colour"], cluster.colour);
  read_strands(cluster, j, where);
  return cluster;
}

std::string cluster_name(const std::string& where, std::size_t i) {
  return where + ": /clusters/" + std::to_string(i);
}

bool is_finite(glm::vec3 v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

void check_strand(std::span<const DiskPoint> strand, const std::string& where) {
  if (strand.size() < 2) throw InputError(where, "has fewer than 2 points");
  float last_t = -1.0F;
  for (std::size_t k = 0; k < strand.size(); ++k) {
    const DiskPoint& p = strand[k];
    const std::string point = "point " + std::to_string(k);
    if (!(p.t >= 0 && p.t <= 1)) throw InputError(where, point + ": t = " + std::to_string(p.t) + " is not in [0, 1]");
    if (!(std::abs(p.x) <= kMaxDisk && std::abs(p.y) <= kMaxDisk))
      throw InputError(where, point + ": (" + std::to_string(p.x) + ", " + std::to_string(p.y) +
                                  ") is not within 1000 of the disk's centre");
    if (p.t <= last_t) throw InputError(where, point + ": t = " + std::to_string(p.t) + " does not increase");
    last_t = p.t;
  }
}

void check_shape(const Cluster& c, const std::string& where) {
  if (!std::all_of(c.centre_line.begin(), c.centre_line.end(), is_finite))
    throw InputError(where, "centre_line holds a number that is not finite");
  for (std::size_t i = 0; i < c.cross_sections.size(); ++i) {
    const CrossSection& s = c.cross_sections[i];
    if (!(s.xx > 0 && s.yy > 0 && s.determinant() > 0 && std::isfinite(s.xx + s.yy)))
      throw InputError(where, "cross_sections/" + std::to_string(i) +
                                  " is not positive definite: xx, yy and xx yy - xy^2 must be above 0");
  }
  const bool has_length = std::any_of(c.centre_line.begin(), c.centre_line.end(),
                                      [&](glm::vec3 p) { return glm::length(p - c.centre_line[0]) > 1e-6F; });
  if (!has_length) throw InputError(where, "centre_line has no length: give points that differ");
  if (!(is_finite(c.first_normal) && glm::length(c.first_normal) > 1e-6F))
    throw InputError(where, "first_normal has no length");
}

void check_transforms(const Cluster& c, const std::string& where) {
  for (std::size_t i = 0; i < c.transforms.size(); ++i) {
    const double volume = glm::determinant(glm::dmat3(c.transforms[i]));
    if (!(std::abs(volume) > 1e-12 && std::isfinite(volume)) || !is_finite(glm::vec3(c.transforms[i][3])))
      throw InputError(where, "transforms/" + std::to_string(i) + " flattens the cluster or is not finite");
  }
}

void check(const Hairstyle& style, const std::string& where) {
  if (!(style.diameter_m > 0 && std::isfinite(style.diameter_m)))
    throw InputError(where, "the strand diameter must be above 0");
  if (!(style.opacity > 0 && style.opacity <= 1)) throw InputError(where, "opacity must lie in (0, 1]");
  for (std::size_t i = 0; i < style.clusters.size(); ++i) {
    const Cluster& c = style.clusters[i];
    check_shape(c, cluster_name(where, i));
    check_transforms(c, cluster_name(where, i));
    for (std::size_t s = 0; s < c.strand_count(); ++s)
      check_strand(c.strand(s), cluster_name(where, i) + ": strand " + std::to_string(s));
  }
}

void check_hash(const std::string& hash, const std::string& where) {
  const bool is_hex =
      std::all_of(hash.begin(), hash.end(), [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); });
  if (!hash.empty() && (hash.size() != 64 || !is_hex))
    throw InputError(where, "source_hash is not 64 lower-case hexadecimal digits");
}

void check_procedural_total(const json& clusters, const std::string& where) {
  std::size_t total = 0;
  for (const json& cluster : clusters) total += cluster.value("strand_count", std::size_t{0});
  if (total > kMaxProceduralStrands)
    throw InputError(where, "strand_count adds up to " + std::to_string(total) + ": at most 1,000,000 are made up");
}

/// Strands of all instances.
std::size_t drawn_strands(const Hairstyle& style) {
  std::size_t count = 0;
  for (const Cluster& c : style.clusters) count += c.strand_count() * std::max<std::size_t>(1, c.transforms.size());
  return count;
}

Hairstyle read_hairstyle(const json& document, const std::string& where) {
  check_procedural_total(document["clusters"], where);
  Hairstyle style;
  style.name = document.value("name", "");
  style.source = document.value("source", "");
  style.source_hash = document.value("source_hash", "");
  check_hash(style.source_hash, where);
  if (document.contains("opacity")) json_fields::get(document["opacity"], style.opacity);
  if (document.contains("division")) json_fields::get(document["division"], style.division);
  for (const json& cluster : document["clusters"])
    style.clusters.push_back(read_cluster(cluster, cluster_name(where, style.clusters.size())));
  style.diameter_m = document.contains("strand_diameter_um")
                         ? static_cast<float>(document["strand_diameter_um"].get<double>() * 1e-6)
                         : default_diameter_m(drawn_strands(style));
  return style;
}

template <class T>
std::string encode(std::span<const T> values) {
  return base64_encode(std::as_bytes(values));
}

ordered_json write_transform(const glm::mat4& m) {
  ordered_json rows = ordered_json::array();
  for (int row = 0; row < 3; ++row) {
    ordered_json& list = rows.emplace_back(ordered_json::array());
    for (int column = 0; column < 4; ++column) list.push_back(json_fields::put(m[column][row]));
  }
  return rows;
}

ordered_json write_cluster(const Cluster& c) {
  ordered_json j = ordered_json::object();
  for (const glm::vec3& p : c.centre_line) j["centre_line"].push_back(json_fields::put(p));
  for (const CrossSection& s : c.cross_sections)
    j["cross_sections"].push_back(json_fields::put(glm::vec3(s.xx, s.xy, s.yy)));
  j["first_normal"] = json_fields::put(c.first_normal);
  for (const glm::mat4& m : c.transforms) j["transforms"].push_back(write_transform(m));
  if (c.colour.x >= 0) j["colour"] = json_fields::put(c.colour);
  std::vector<std::uint32_t> counts;
  for (std::size_t i = 0; i < c.strand_count(); ++i) counts.push_back(c.strand_offsets[i + 1] - c.strand_offsets[i]);
  j["packed_strands"] = {{"points_per_strand", encode(std::span<const std::uint32_t>(counts))},
                         {"points", encode(std::span<const DiskPoint>(c.strand_points))}};
  return j;
}

/// Micrometres that read back as exactly this diameter, in few digits where few do.
double micrometres(float diameter_m) {
  const double exact = static_cast<double>(diameter_m) * 1e6;
  const double tidy = json_fields::shortest(static_cast<float>(exact));
  return static_cast<float>(tidy * 1e-6) == diameter_m ? tidy : exact;
}

ordered_json write_header(const Hairstyle& style) {
  return {{"version", 1},
          {"name", style.name},
          {"source", style.source},
          {"source_hash", style.source_hash},
          {"strand_diameter_um", micrometres(style.diameter_m)},
          {"opacity", json_fields::put(style.opacity)},
          {"division", json_fields::put(style.division)}};
}

}  // namespace

Hairstyle load_hairstyle(const std::filesystem::path& file) {
  const std::string where = file.string();
  Hairstyle style;
  {
    const json document = parse_json(read_text(file), where);
    validate(document, "hairstyle", where);
    style = read_hairstyle(document, where);
  }
  check(style, where);
  return style;
}

void save_hairstyle(const Hairstyle& style, const std::filesystem::path& file) {
  check(style, "hairstyle for " + file.string());
  AtomicFile out(file);
  std::string text = json_fields::text_of(write_header(style));
  text.back() = ',';
  text += "\n\"clusters\":[\n";  // one cluster a line
  for (std::size_t i = 0; i < style.clusters.size(); ++i)
    text += (i == 0 ? "" : ",\n") + json_fields::text_of(write_cluster(style.clusters[i]));
  out.write(text + "\n]}\n");
  out.commit();
}

}  // namespace pelage
