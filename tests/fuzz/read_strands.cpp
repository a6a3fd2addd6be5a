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

void check_written_again(const Strands& s) {
  // A diameter of 1 m is what writers leave that know none; a HAIR strand has 65,536 vertices at most.
  if (s.diameter_m == 1.0F) return;
  for (std::size_t i = 0; i < s.count(); ++i)
    if (s.strand(i).size() > 65'536) return;
  const std::filesystem::path file = scratch("again.hair");
  hair::write_hair(s, file);
  ReadOptions options;
  options.check_unit = false;
  const Strands again = hair::read_hair(file, options);
  require(again.offsets == s.offsets && again.vertices == s.vertices && again.diameters_m == s.diameters_m &&
              again.colours == s.colours && again.diameter_m == s.diameter_m,
          "written and read again it is the same");
}

/// As it is, and with every option set to something else.
void read_as(const std::string& where, std::string_view bytes) {
  const ReadOptions other{0.01, hair::UpAxis::z, hair::Curve::b_spline, false};
  for (const ReadOptions& options : {ReadOptions{}, other}) {
    ReadReport report;
    const auto strands = accepted([&] {
      return hair::parse_hair(std::as_bytes(std::span(bytes.data(), bytes.size())), where, options, &report);
    });
    if (!strands) continue;
    check(*strands);
    check(*strands, report);
    check_written_again(*strands);
    require(!to_json(hair_facts(*strands, report, options.metres_per_unit)).empty(), "there are facts");
  }
}

}  // namespace

void read_hair(std::string_view bytes) {
  read_as("fuzz.hair", bytes);
}
void read_tfx4(std::string_view bytes) {
  read_as("fuzz.tfx", bytes);
}

}  // namespace pelage::fuzz
