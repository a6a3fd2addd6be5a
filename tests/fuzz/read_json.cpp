// Harnesses of the JSON readers. That all numbers are finite follows from writing and reading again: JSON has no other.
#include <cmath>

#include "harness.h"
#include "pelage/data_schema/bake_settings.h"
#include "pelage/data_schema/hairstyle.h"
#include "pelage/data_schema/scene.h"

namespace pelage::fuzz {
namespace {

void check(const Cluster& c) {
  require(c.centre_line.size() >= 4 && c.cross_sections.size() >= 4, "curves have four control points");
  require(c.strand_offsets.front() == 0 && c.strand_offsets.back() == c.strand_points.size(),
          "offsets span the strands' points");
  for (std::size_t i = 0; i < c.strand_count(); ++i)
    require(c.strand_offsets[i] < c.strand_offsets[i + 1], "a strand has points");
  for (const DiskPoint& p : c.strand_points)
    require(std::isfinite(p.t) && std::isfinite(p.x) && std::isfinite(p.y), "strands are finite");
  const auto swept = accepted([&] { return sweep(c, 5); });
  if (!swept) return;
  for (const Frame& f : swept->frames)
    for (const glm::vec3& v : {f.position, f.tangent, f.normal, f.binormal})
      require(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z), "frames are finite");
}

void read_scene(const std::filesystem::path& file) {
  const auto scene = accepted([&] { return load_scene(file); });
  if (!scene) return;
  const std::string text = to_json(*scene);
  require(to_json(load_scene(scratch("again.json", text))) == text, "written and read again it is the same");
}

}  // namespace

void read_json_scene(std::string_view bytes) {
  const std::filesystem::path file = scratch("fuzz.json", bytes);
  read_scene(file);
  const auto material = accepted([&] { return load_material(file); });
  if (!material) return;
  Scene scene;
  scene.hair = "x.hair";
  scene.material = *material;
  require(load_scene(scratch("again.json", to_json(scene))).material == *material, "a material is the same in a scene");
}

void read_json_hairstyle(std::string_view bytes) {
  const std::filesystem::path file = scratch("fuzz.json", bytes);
  const auto style = accepted([&] { return load_hairstyle(file); });
  if (!style) return;
  for (const Cluster& c : style->clusters) check(c);
  save_hairstyle(*style, file);
  const std::string first = bytes_of(file);
  save_hairstyle(load_hairstyle(file), file);
  require(bytes_of(file) == first, "written and read again it is the same");
}

void read_json_bake(std::string_view bytes) {
  const auto settings = accepted([&] { return bake_settings_from_json(std::string(bytes), "fuzz.json"); });
  if (!settings) return;
  require(bake_settings_from_json(to_json(*settings), "again") == *settings, "written and read again it is the same");
}

}  // namespace pelage::fuzz
