#include "pelage/app/prepare.h"

#include <spdlog/spdlog.h>

#include <cstdlib>
#include <fstream>

#include "pelage/bake/direct_source.h"
#include "pelage/data_schema/errors.h"
#include "pelage/hair/cluster_fit.h"
#include "pelage/hair/hair_file.h"
#include "pelage/hair/head.h"

namespace pelage::app {

std::filesystem::path cache_folder() {
  const auto from = [](const char* name) {
    const char* const value = std::getenv(name);
    return std::filesystem::path(value == nullptr ? "" : value);
  };
  if (const auto own = from("PELAGE_CACHE"); !own.empty()) return own;
  if (const auto xdg = from("XDG_CACHE_HOME"); !xdg.empty()) return xdg / "pelage";
  if (const auto home = from("HOME"); !home.empty()) return home / ".cache" / "pelage";
  return std::filesystem::temp_directory_path() / "pelage-cache";
}

namespace {

Hairstyle fit_hairstyle(const Scene& scene) {
  hair::ReadOptions read;
  read.metres_per_unit = hair::parse_unit(scene.unit);
  read.up = hair::parse_up_axis(scene.up);
  hair::ReadReport report;
  const Strands strands = hair::read_hair(scene.hair, read, &report);
  for (const hair::StrandIssue& issue : report.issues) {
    spdlog::debug("{}: strand {} {}: {}", scene.hair, issue.strand, issue.dropped ? "dropped" : "repaired", issue.reason);
  }
  hair::FitSettings fit;
  fit.clusters = scene.clusters;
  hair::ClusterFit fitted = hair::fit_clusters(strands, fit);
  Hairstyle style;
  style.name = std::filesystem::path(scene.hair).stem().string();
  style.source = std::filesystem::path(scene.hair).filename().string();
  style.division = scene.division;
  style.diameter_m = hair::drawn_diameter_m(strands);
  style.opacity = report.opacity.value_or(kDefaultOpacity);
  style.clusters = std::move(fitted.clusters);
  spdlog::info("{}: {} strands in {} clusters, {:.1f} % of their length inside, RMS {:.2f} mm; D {:.0f} um, opacity {:.2f}",
               style.source, fitted.report.strands, style.clusters.size(), 100 * fitted.report.inside,
               1e3 * fitted.report.rms_m, 1e6 * static_cast<double>(style.diameter_m), style.opacity);
  return style;
}

}  // namespace

Hairstyle prepare_hairstyle(const Scene& scene) {
  if (std::filesystem::path(scene.hair).extension() == ".json") return load_hairstyle(scene.hair);
  return fit_hairstyle(scene);
}

Mesh prepare_head(const Scene& scene) {
  (void)scene;
  return {};
}

std::unique_ptr<RecordSource> prepare_records(const Scene& scene, const Hairstyle& style, BakeSettings& bake) {
  (void)style;
  bake = scene.bake;
  return std::make_unique<DirectSource>(bake);
}

}  // namespace pelage::app
