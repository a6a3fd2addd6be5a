#include "pelage/app/prepare.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <optional>

#include "pelage/bake/bake_pipeline.h"
#include "pelage/bake/direct_source.h"
#include "pelage/console/program.h"
#include "pelage/console/progress.h"
#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/output_file.h"
#include "pelage/db/database.h"
#include "pelage/db/database_source.h"
#include "pelage/db/literal_key_source.h"
#include "pelage/hair/cluster_fit.h"
#include "pelage/hair/hair_file.h"
#include "pelage/hair/mesh_obj.h"
#include "pelage/satf/self_shadow.h"

namespace pelage::app {

namespace {

std::filesystem::path& temporary_cache() {
  static std::filesystem::path folder;  // empty: none
  return folder;
}

}  // namespace

std::filesystem::path cache_folder() {
  if (!temporary_cache().empty()) return temporary_cache();
  const auto from = [](const char* name) {
    const char* const value = std::getenv(name);
    return std::filesystem::path(value == nullptr ? "" : value);
  };
  if (const auto own = from("PELAGE_CACHE"); !own.empty()) return own;
  if (const auto xdg = from("XDG_CACHE_HOME"); !xdg.empty()) return xdg / "pelage";
  if (const auto home = from("HOME"); !home.empty()) return home / ".cache" / "pelage";
  return std::filesystem::temp_directory_path() / "pelage-cache";
}

TemporaryCache::TemporaryCache(const std::filesystem::path& folder, std::uintmax_t most_bytes)
    : folder_(folder), before_(temporary_cache()), most_bytes_(most_bytes) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw OutputError(folder.string(), error.message());
  temporary_cache() = folder;
}

TemporaryCache::~TemporaryCache() {
  temporary_cache() = before_;
  std::error_code none;
  std::filesystem::remove_all(folder_, none);
}

void TemporaryCache::trim() const {
  std::vector<std::filesystem::directory_entry> files;
  std::uintmax_t bytes = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder_)) {
    if (file.path().extension() != ".hrir") continue;
    files.push_back(file);
    bytes += file.file_size();
  }
  std::sort(files.begin(), files.end(),
            [](const auto& a, const auto& b) { return a.last_write_time() < b.last_write_time(); });
  for (const auto& file : files) {
    if (bytes <= most_bytes_) return;
    bytes -= file.file_size();
    std::error_code none;
    std::filesystem::remove(file, none);
  }
}

namespace {

std::string file_bytes(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError(file.string(), "cannot be read");
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// 16 hex digits of what a cached file depends on; the program's revision too, since it decides what is computed.
std::string cache_key(const std::string& text) {
  Checksum sum;
  sum.add(text.data(), text.size());
  const std::string revision = program_revision();
  sum.add(revision.data(), revision.size());
  return fmt::format("{:016x}", sum.value());
}

std::filesystem::path cached(const std::string& name) {
  std::error_code error;
  std::filesystem::create_directories(cache_folder(), error);
  if (error)
    throw OutputError(cache_folder().string(), error.message() + "; set PELAGE_CACHE to a folder that can be written");
  return cache_folder() / name;
}

hair::ReadOptions read_options(const Scene& scene) {
  hair::ReadOptions read;
  read.metres_per_unit = hair::parse_unit(scene.unit);
  read.up = hair::parse_up_axis(scene.up);
  read.curve = hair::parse_curve(scene.curve);
  return read;
}

/// The strands of a hair file with the diameter that is drawn, and their opacity; what was wrong with the file goes to
/// the log.
StrandHair read_strands(const Scene& scene) {
  hair::ReadReport report;
  StrandHair hair{std::filesystem::path(scene.hair).stem().string(),
                  hair::read_hair(scene.hair, read_options(scene), &report)};
  Strands& strands = hair.strands;
  hair.opacity = scene.opacity > 0 ? scene.opacity : report.opacity.value_or(kDefaultOpacity);
  if (scene.diameter_um > 0) {
    strands.diameters_m.clear();
    strands.diameter_m = 1e-6F * scene.diameter_um;
  } else if (strands.diameters_m.empty()) {
    strands.diameter_m = hair::drawn_diameter_m(strands);
  }
  for (const hair::StrandIssue& issue : report.issues) {
    spdlog::debug("{}: strand {} {}: {}", scene.hair, issue.strand, issue.dropped ? "dropped" : "repaired",
                  issue.reason);
  }
  for (const std::string& note : report.notes) spdlog::info("{}: {}", scene.hair, note);
  return hair;
}

Hairstyle fit_hairstyle(const Scene& scene) {
  const StrandHair hair = read_strands(scene);
  const Strands& strands = hair.strands;
  hair::FitSettings fit;
  fit.clusters = scene.clusters;
  hair::ClusterFit fitted = hair::fit_clusters(strands, fit);
  Hairstyle style;
  style.name = std::filesystem::path(scene.hair).stem().string();
  style.source = std::filesystem::path(scene.hair).filename().string();
  style.diameter_m = hair::drawn_diameter_m(strands);
  style.opacity = hair.opacity;
  style.clusters = std::move(fitted.clusters);
  spdlog::info(
      "{}: {} strands in {} clusters, {:.1f} % of their length inside, RMS {:.2f} mm; D {:.0f} um, opacity {:.2f}",
      style.source, fitted.report.strands, style.clusters.size(), 100 * fitted.report.inside, 1e3 * fitted.report.rms_m,
      1e6 * static_cast<double>(style.diameter_m), style.opacity);
  return style;
}

/// Fitted before, or now. @throws OutputError when it cannot be kept
Hairstyle cached_hairstyle(const std::filesystem::path& file, const Scene& scene) {
  if (std::filesystem::exists(file)) {
    try {
      spdlog::debug("{}: fitted before, {}", scene.hair, file.string());
      return load_hairstyle(file);
    } catch (const InputError& damaged) {
      spdlog::warn("{}; it is fitted again", damaged.what());
    }
  }
  check_writable(file);  // before the work
  Hairstyle style = fit_hairstyle(scene);
  try {
    save_hairstyle(style, file);
  } catch (const OutputError& error) {
    spdlog::warn("{}; the fit is not kept", error.what());
  }
  return style;
}

}  // namespace

Hairstyle prepare_hairstyle(const Scene& scene) {
  if (std::filesystem::path(scene.hair).extension() == ".json") return load_hairstyle(scene.hair);
  const std::string parts = file_bytes(scene.hair) + "\n" + scene.unit + scene.up + scene.curve +
                            fmt::format("{} {} {}", scene.clusters, scene.diameter_um, scene.opacity);
  std::optional<Hairstyle> style;
  try {
    style = cached_hairstyle(cached("fit-" + cache_key(parts) + ".json"), scene);
  } catch (const OutputError& error) {
    spdlog::warn("{}; the fit is not kept", error.what());
  }
  if (!style) style = fit_hairstyle(scene);
  style->division = scene.division;
  return *style;
}

StrandHair prepare_strands(const Scene& scene) {
  if (std::filesystem::path(scene.hair).extension() == ".json") {
    const Hairstyle style = load_hairstyle(scene.hair);
    return {style.name, hair_strands(style, make_model(style, scene.bake, scene.bake.samples)), style.opacity};
  }
  StrandHair hair = read_strands(scene);
  spdlog::info("{}: {} strands, {} vertices; D {:.0f} um, opacity {:.2f}", hair.name, hair.strands.count(),
               hair.strands.vertices.size(), 1e6 * static_cast<double>(hair::drawn_diameter_m(hair.strands)),
               hair.opacity);
  return hair;
}

Mesh prepare_head(const Scene& scene) {
  return scene.head.empty() ? Mesh{} : hair::read_obj(scene.head, read_options(scene));
}

namespace {

/// @param style  none: random sectors
void bake(const BakeSettings& settings, const Hairstyle* style, const std::filesystem::path& file) {
  const std::string whom = style == nullptr ? "any hair" : style->name;
  console::Progress progress("baking for " + whom, static_cast<std::uint64_t>(settings.sectors), "sectors");
  const BakeResult result = bake_database(settings, style, file, [&](std::uint64_t done, std::uint64_t) {
    console::throw_if_interrupted();
    progress.update(done);
  });
  spdlog::info("{}: {} records baked in {:.1f} s, {}", whom, result.records, result.seconds, file.string());
}

using Bank = std::shared_ptr<const RecordBank>;

/// The cached database adapted to this hairstyle, baked now if there is none or it is damaged.
Bank cached_bank(const BakeSettings& settings, const Hairstyle& style) {
  const auto file = cached("adapted-" + cache_key(hairstyle_hash(style) + to_json(settings)) + ".hrir");
  if (std::filesystem::exists(file)) {
    try {
      return std::make_shared<RecordBank>(file);
    } catch (const InputError& damaged) {
      spdlog::warn("{}; it is baked again", damaged.what());
    }
  }
  bake(settings, &style, file);
  return std::make_shared<RecordBank>(file);
}

}  // namespace

std::shared_ptr<const RecordBank> bake_temporary(const BakeSettings& settings, const Hairstyle* style) {
  std::string name = (std::filesystem::temp_directory_path() / "pelage-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw OutputError(name, "cannot be made: set PELAGE_CACHE or TMPDIR");
  const std::unique_ptr<const std::filesystem::path, void (*)(const std::filesystem::path*)> folder(
      new std::filesystem::path(name), [](const std::filesystem::path* path) {
        std::error_code none;
        std::filesystem::remove_all(*path, none);
        delete path;
      });
  bake(settings, style, *folder / "baked.hrir");
  return std::make_shared<RecordBank>(*folder / "baked.hrir");
}

std::unique_ptr<RecordSource> record_source(const SatfSettings& satf, Bank bank) {
  if (satf.records == RecordsFrom::literal_key) return std::make_unique<LiteralKeySource>(std::move(bank));
  const LookupSettings lookup{satf.neighbours, true, satf.records == RecordsFrom::own_alpha};
  return std::make_unique<DatabaseSource>(std::move(bank), lookup);
}

std::unique_ptr<RecordSource> prepare_records(const Scene& scene, const Hairstyle& style, BakeSettings& bake) {
  bake = scene.bake;
  if (scene.satf.records == RecordsFrom::direct) return std::make_unique<DirectSource>(bake);
  Bank bank;
  if (!scene.database.empty()) {
    const std::filesystem::path file =
        scene.database == kGenericDatabase ? prepare_generic_database(scene) : std::filesystem::path(scene.database);
    bank = std::make_shared<RecordBank>(file);
    bake = bank->metadata().settings;
    return record_source(scene.satf, std::move(bank));
  }
  try {
    bank = cached_bank(bake, style);
  } catch (const OutputError& error) {
    spdlog::warn("{}; the database is not kept", error.what());
    bank = bake_temporary(bake, &style);
  }
  return record_source(scene.satf, std::move(bank));
}

std::filesystem::path prepare_generic_database(const Scene& scene) {
  auto file = cached("generic-" + cache_key(to_json(scene.bake)) + ".hrir");
  if (std::filesystem::exists(file)) {
    try {
      const RecordBank whole(file);
      return file;
    } catch (const InputError& damaged) {
      spdlog::warn("{}; it is baked again", damaged.what());
    }
  }
  bake(scene.bake, nullptr, file);
  return file;
}

}  // namespace pelage::app
