// Harnesses of the hair readers. The format is recognised by content and extension, so each gives its name.
#include <cmath>

#include "harness.h"
#include "pelage/hair/facts.h"
#include "pelage/hair/hair_file.h"

namespace pelage::fuzz {
namespace {

using hair::ReadOptions;
using hair::ReadReport;

bool finite(glm::vec3 p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

void check(const Strands& s) {
  require(s.offsets.front() == 0 && s.offsets.back() == s.vertices.size(), "offsets span the vertices");
  for (std::size_t i = 0; i < s.count(); ++i) {
    require(s.offsets[i] + 2 <= s.offsets[i + 1], "a strand has two vertices");
    for (std::size_t k = s.offsets[i] + 1; k < s.offsets[i + 1]; ++k)
      require(s.vertices[k] != s.vertices[k - 1], "neighbouring vertices differ");
  }
  for (const glm::vec3& p : s.vertices) require(finite(p), "vertices are finite");
  require(s.diameters_m.empty() || s.diameters_m.size() == s.vertices.size(), "one diameter per vertex");
  for (const float d : s.diameters_m) require(d >= 0 && std::isfinite(d), "diameters are numbers >= 0");
  require(s.diameter_m >= 0 && std::isfinite(s.diameter_m), "the diameter is a number >= 0");
  require(s.colours.empty() || s.colours.size() == s.count(), "one colour per strand");
  for (const glm::vec3& c : s.colours)
    for (int k = 0; k < 3; ++k) require(c[k] >= 0 && c[k] <= 1, "colours are in [0, 1]");
}

void check(const Strands& s, const ReadReport& report) {
  require(!report.format.empty(), "the format is named");
  require(s.count() + report.dropped() == report.strands_in_file, "every strand is kept or counted as dropped");
  for (std::size_t i = 0; i < report.issues.size(); ++i) {
    require(report.issues[i].strand < report.strands_in_file, "an issue names a strand of the file");
    require(i == 0 || report.issues[i - 1].strand <= report.issues[i].strand, "issues are in order");
  }
  require(!report.opacity || (*report.opacity > 0 && *report.opacity <= 1), "opacity is in (0, 1]");
}

float diameter_at(const Strands& s, std::size_t vertex) {
  return s.diameters_m.empty() ? s.diameter_m : s.diameters_m[vertex];
}

/// The same, though a format may say one diameter for all only once.
bool same_diameters(const Strands& a, const Strands& b) {
  for (std::size_t i = 0; i < a.vertices.size(); ++i)
    if (diameter_at(a, i) != diameter_at(b, i)) return false;
  return true;
}

/// Written as `extension` says and read again it is the same, but for what the writer said is lost; or it is refused.
void check_written_again(const Strands& s, std::optional<float> opacity, const std::string& extension) {
  const std::string name = "again" + extension;
  hair::WriteReport written;
  std::string bytes;
  try {
    bytes = format_strands(s, name, opacity, &written);
  } catch (const OutputError&) {
    return;
  }
  ReadOptions options;
  options.check_unit = false;
  ReadReport report;
  const Strands again = hair::parse_hair(std::as_bytes(std::span(bytes)), name, options, &report);
  require(again.offsets == s.offsets && again.vertices == s.vertices, "written and read again it has the same strands");
  if (!written.lost.empty()) return;
  require(same_diameters(again, s), "written and read again it has the same diameters");
  require(again.colours == s.colours, "written and read again it has the same colours");
  require(report.opacity == opacity, "written and read again it has the same opacity");
}

/// As it is, and with every option set to something else.
void read_as(const std::string& extension, std::string_view bytes) {
  const ReadOptions other{0.01, hair::UpAxis::z, hair::Curve::b_spline, false};
  for (const ReadOptions& options : {ReadOptions{}, other}) {
    ReadReport report;
    const auto strands = accepted(
        [&] { return hair::parse_hair(std::as_bytes(std::span(bytes)), "fuzz" + extension, options, &report); });
    if (!strands) continue;
    check(*strands);
    check(*strands, report);
    check_written_again(*strands, report.opacity, extension);
    check_written_again(*strands, report.opacity, ".hair");
    require(!to_json(hair_facts(*strands, report, report.metres_per_unit)).empty(), "there are facts");
  }
}

Strands three_strands() {
  Strands s;
  for (int i = 0; i < 3; ++i) {
    const float x = 0.01F * static_cast<float>(i);
    s.append(std::vector<glm::vec3>{{x, 0, 0}, {x, 0.05F, 0}, {x, 0.1F, 0.01F}, {x, 0.15F, 0.03F}});
    s.colours.emplace_back(0.5F, 0.25F, x);
  }
  s.diameter_m = 1e-4F;
  return s;
}

std::vector<std::string> written_as(const std::string& extension) {
  return {hair::format_strands(three_strands(), "seed" + extension, 0.5F)};
}

}  // namespace

void read_hair(std::string_view bytes) {
  read_as(".hair", bytes);
}
void read_tfx(std::string_view bytes) {
  read_as(".tfx", bytes);
}
void read_data(std::string_view bytes) {
  read_as(".data", bytes);
}
void read_ply(std::string_view bytes) {
  read_as(".ply", bytes);
}
void read_obj_strands(std::string_view bytes) {
  read_as(".obj", bytes);
}
void read_usda(std::string_view bytes) {
  read_as(".usda", bytes);
}

std::vector<std::string> hair_seeds() {
  return written_as(".hair");
}
std::vector<std::string> tfx4_seeds() {
  return written_as(".tfx");
}
std::vector<std::string> data_seeds() {
  return written_as(".data");
}
std::vector<std::string> ply_seeds() {
  return written_as(".ply");
}
std::vector<std::string> obj_strands_seeds() {
  return written_as(".obj");
}
std::vector<std::string> usda_seeds() {
  return written_as(".usda");
}

}  // namespace pelage::fuzz
