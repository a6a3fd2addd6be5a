#include "pelage/hair/facts.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>
#include <glm/glm.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

#include "pelage/hair/hair_formats.h"
#include "pelage/hair/resample.h"

namespace pelage::hair {
namespace {

constexpr double kShortShare = 0.01;  // of the mean length: such a strand is an accident
constexpr double kUnevenLimit = 1.0;  // segments of a strand that differ by more than their mean
constexpr std::size_t kNamed = 12;    // how many strands a text names before it says "and more"

Spread spread_of(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
  };
  double sum = 0;
  for (const double v : values) sum += v;
  return {values.front(), at(0.1), at(0.5), at(0.9), values.back(), sum / static_cast<double>(values.size())};
}

std::string number(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.4g", value);
  return buffer;
}

/// Distance from each root to the nearest other, by a sweep along x in both directions.
std::vector<double> nearest_root_distances_m(const Strands& strands) {
  std::vector<glm::dvec3> roots;
  for (std::size_t i = 0; i < strands.count(); ++i) roots.emplace_back(strands.strand(i).front());
  std::sort(roots.begin(), roots.end(), [](const auto& a, const auto& b) { return a.x < b.x; });
  constexpr std::size_t kMost = 2500;  // roots in one plane across x: an upper bound is enough
  std::vector<double> nearest(roots.size(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < roots.size(); ++i) {
    const std::size_t last = std::min(roots.size(), i + kMost), first = i - std::min(i, kMost);
    for (std::size_t k = i + 1; k < last && roots[k].x - roots[i].x < nearest[i]; ++k)
      nearest[i] = std::min(nearest[i], glm::distance(roots[i], roots[k]));
    for (std::size_t k = i; k > first && roots[i].x - roots[k - 1].x < nearest[i]; --k)
      nearest[i] = std::min(nearest[i], glm::distance(roots[i], roots[k - 1]));
  }
  return nearest;
}

/// How many strands repeat the first `vertices` vertices of an earlier one, bit for bit.
std::size_t count_repeated(const Strands& strands, std::size_t vertices) {
  std::set<std::string_view> seen;
  std::size_t repeated = 0;
  for (std::size_t i = 0; i < strands.count(); ++i) {
    const auto points = strands.strand(i);
    const std::size_t n = std::min(vertices, points.size());
    if (!seen.insert({reinterpret_cast<const char*>(points.data()), n * sizeof(glm::vec3)}).second) ++repeated;
  }
  return repeated;
}

void measure_strands(const Strands& strands, HairFacts& facts) {
  std::vector<double> counts, lengths, spacings, unevenness;
  for (std::size_t i = 0; i < strands.count(); ++i) {
    const auto points = strands.strand(i);
    double least = std::numeric_limits<double>::infinity(), most = 0;
    for (std::size_t k = 1; k < points.size(); ++k) {
      const double d = glm::distance(glm::dvec3(points[k - 1]), glm::dvec3(points[k]));
      spacings.push_back(d);
      least = std::min(least, d);
      most = std::max(most, d);
    }
    const double length = arc_length_m(points);
    counts.push_back(static_cast<double>(points.size()));
    lengths.push_back(length);
    if (length > 0) unevenness.push_back((most - least) / (length / static_cast<double>(points.size() - 1)));
  }
  facts.vertices_per_strand = spread_of(counts);
  facts.length_m = spread_of(lengths);
  facts.spacing_m = spread_of(std::move(spacings));
  facts.uneven = spread_of(std::move(unevenness)).median;
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    if (lengths[i] < kShortShare * facts.length_m.mean) facts.short_strands.push_back(i);
  }
}

void measure_box(const Strands& strands, HairFacts& facts) {
  facts.box_min_m = facts.box_max_m = strands.vertices.front();
  for (const glm::vec3& p : strands.vertices) {
    facts.box_min_m = glm::min(facts.box_min_m, p);
    facts.box_max_m = glm::max(facts.box_max_m, p);
  }
}

void measure_diameter(const Strands& strands, HairFacts& facts) {
  facts.diameter_from_file = !strands.diameters_m.empty() || strands.diameter_m > 0;
  const float one = strands.diameter_m > 0 ? strands.diameter_m : default_diameter_m(strands.count());
  if (strands.diameters_m.empty()) {
    facts.diameter_m = spread_of({static_cast<double>(one)});
  } else {
    facts.diameter_m = spread_of({strands.diameters_m.begin(), strands.diameters_m.end()});
  }
}

/// Hair hangs: tips lie below roots. Where they do so along another axis, that one is probably up.
void remark_up_axis(const Strands& strands, HairFacts& facts) {
  glm::dvec3 fall(0.0);
  for (std::size_t i = 0; i < strands.count(); ++i) {
    fall += glm::dvec3(strands.strand(i).front()) - glm::dvec3(strands.strand(i).back());
  }
  fall /= static_cast<double>(strands.count()) * std::max(facts.length_m.mean, 1e-30);
  constexpr double kClear = 0.6;  // share of the length that strands fall on average before we say so
  if (fall.y > 0.25 * kClear) return;
  if (fall.z > kClear)
    facts.remarks.push_back("the strands run along -Z, not down: if Z is up in this file, give --up z");
  if (fall.x > kClear)
    facts.remarks.push_back("the strands run along -X, not down: if X is up in this file, give --up x");
}

std::string name_indices(const std::vector<std::size_t>& indices) {
  std::string text;
  for (std::size_t k = 0; k < std::min(indices.size(), kNamed); ++k)
    text += (k > 0 ? ", " : "") + std::to_string(indices[k]);
  return indices.size() > kNamed ? text + " and more" : text;
}

void remark(const Strands& strands, const ReadReport& report, double metres_per_unit, HairFacts& facts) {
  facts.remarks = report.notes;
  const std::string unit = implausible_unit(facts.length_m.median, metres_per_unit);
  if (!unit.empty()) facts.remarks.push_back(unit);
  remark_up_axis(strands, facts);
  if (!facts.short_strands.empty()) {
    facts.remarks.push_back(std::to_string(facts.short_strands.size()) +
                            " strands are shorter than 1 % of the mean: " + name_indices(facts.short_strands));
  }
  if (facts.uneven > kUnevenLimit) facts.remarks.push_back("the vertices are unevenly spaced along the strands");
  if (facts.repeated_strands > 0) {
    facts.remarks.push_back(std::to_string(facts.repeated_strands) + " strands repeat an earlier one");
  } else if (facts.repeated_roots > 0) {
    facts.remarks.push_back(std::to_string(facts.repeated_roots) + " roots are at the place of an earlier one");
  }
  if (facts.strands < 1000) facts.remarks.push_back("only " + counted(facts.strands, "strand") + ": guides, probably");
}

void append_line(std::string& out, const char* name, const std::string& value) {
  char head[32];
  std::snprintf(head, sizeof head, "%-20s", name);
  out += head + value + "\n";
}

std::string describe(const Spread& s, double scale, const char* unit) {
  return "min " + number(scale * s.min) + ", 10% " + number(scale * s.p10) + ", median " + number(scale * s.median) +
         ", 90% " + number(scale * s.p90) + ", max " + number(scale * s.max) + unit;
}

nlohmann::json json_of(const Spread& s) {
  return {{"min", s.min}, {"p10", s.p10}, {"median", s.median}, {"p90", s.p90}, {"max", s.max}, {"mean", s.mean}};
}

nlohmann::json json_of(glm::vec3 v) {
  return nlohmann::json::array({v.x, v.y, v.z});
}

}  // namespace

HairFacts hair_facts(const Strands& strands, const ReadReport& report, double metres_per_unit) {
  HairFacts facts;
  facts.format = report.format;
  facts.strands_in_file = report.strands_in_file;
  facts.strands = strands.count();
  facts.vertices = strands.vertices.size();
  facts.coloured = !strands.colours.empty();
  facts.opacity = report.opacity.value_or(kDefaultOpacity);
  facts.opacity_from_file = report.opacity.has_value();
  facts.issues = report.issues;
  facts.dropped = report.dropped();
  facts.repaired = report.repaired();
  if (strands.count() == 0) return facts;
  measure_strands(strands, facts);
  measure_box(strands, facts);
  measure_diameter(strands, facts);
  if (strands.count() > 1) facts.root_spacing_m = spread_of(nearest_root_distances_m(strands));
  facts.repeated_roots = count_repeated(strands, 1);
  facts.repeated_strands = count_repeated(strands, std::numeric_limits<std::size_t>::max());
  remark(strands, report, metres_per_unit, facts);
  return facts;
}

std::string to_text(const HairFacts& f) {
  std::string out;
  const glm::vec3 size = f.box_max_m - f.box_min_m;
  const auto corner = [](glm::vec3 v) {
    return "(" + number(static_cast<double>(v.x)) + ", " + number(static_cast<double>(v.y)) + ", " +
           number(static_cast<double>(v.z)) + ")";
  };
  append_line(out, "format", f.format);
  append_line(out, "strands", std::to_string(f.strands) + " of " + std::to_string(f.strands_in_file) + " in the file");
  append_line(out, "vertices", std::to_string(f.vertices));
  append_line(out, "vertices per strand", describe(f.vertices_per_strand, 1, ""));
  append_line(out, "box", corner(f.box_min_m) + " to " + corner(f.box_max_m) + " m, size " + corner(size));
  append_line(out, "strand length", describe(f.length_m, 1e3, " mm"));
  append_line(out, "vertex spacing", describe(f.spacing_m, 1e3, " mm"));
  if (f.root_spacing_m) append_line(out, "root spacing", describe(*f.root_spacing_m, 1e3, " mm"));
  append_line(out, "diameter",
              f.diameter_from_file ? describe(f.diameter_m, 1e6, " um")
                                   : number(1e6 * f.diameter_m.median) + " um, default for this count");
  append_line(out, "opacity", number(static_cast<double>(f.opacity)) + (f.opacity_from_file ? "" : ", default"));
  append_line(out, "colours", f.coloured ? "in the file" : "none");
  append_line(out, "dropped, repaired", std::to_string(f.dropped) + ", " + std::to_string(f.repaired));
  for (std::size_t k = 0; k < std::min(f.issues.size(), kNamed); ++k) {
    const StrandIssue& issue = f.issues[k];
    out += "  strand " + std::to_string(issue.strand) + (issue.dropped ? " dropped: " : " repaired: ") + issue.reason +
           "\n";
  }
  if (f.dropped + f.repaired > kNamed) out += "  and " + std::to_string(f.dropped + f.repaired - kNamed) + " more\n";
  for (const std::string& text : f.remarks) out += "note: " + text + "\n";
  return out;
}

std::string to_json(const HairFacts& f) {
  nlohmann::json issues = nlohmann::json::array();
  for (const StrandIssue& s : f.issues)
    issues.push_back({{"strand", s.strand}, {"dropped", s.dropped}, {"reason", s.reason}});
  const nlohmann::json json = {
      {"format", f.format},
      {"strands_in_file", f.strands_in_file},
      {"strands", f.strands},
      {"vertices", f.vertices},
      {"vertices_per_strand", json_of(f.vertices_per_strand)},
      {"box_min_m", json_of(f.box_min_m)},
      {"box_max_m", json_of(f.box_max_m)},
      {"length_m", json_of(f.length_m)},
      {"spacing_m", json_of(f.spacing_m)},
      {"unevenness", f.uneven},
      {"root_spacing_m", f.root_spacing_m ? json_of(*f.root_spacing_m) : nlohmann::json()},
      {"diameter_m", json_of(f.diameter_m)},
      {"diameter_from_file", f.diameter_from_file},
      {"opacity", f.opacity},
      {"opacity_from_file", f.opacity_from_file},
      {"coloured", f.coloured},
      {"repeated_roots", f.repeated_roots},
      {"repeated_strands", f.repeated_strands},
      {"short_strands", f.short_strands},
      {"dropped", f.dropped},
      {"repaired", f.repaired},
      {"issues", issues},
      {"notes", f.remarks},
  };
  // Notes quote the file, which need not be UTF-8.
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace pelage::hair
