// Settings of a bake: everything that a record depends on besides the sector itself. Stored whole in the database.
// File format: schemas/bake.schema.json.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace pelage {

/// What describes a sector's density to the search (db/features.h).
enum class FeatureSet { paper3, moments5, profile11 };

/// How reflectance and optical depth are stored: 8-bit (error 1/510 of the record's maximum) or IEEE half.
enum class Storage { u8, half };

/// Phong in the plane [Xu2006 section 5.1]. Only ratios matter: records are normalised so that the mean over light
/// angles is 1 (DESIGN section 3).
struct PlanarPhong {
  double diffuse = 0.7;   // >= 0
  double specular = 0.3;  // >= 0, not both 0
  double exponent = 8;    // [1, 1000]
  bool operator==(const PlanarPhong&) const = default;
};

/// The largest integer up to which every JSON reader keeps all of them exactly.
constexpr std::uint64_t kLargestSeed = (std::uint64_t{1} << 53) - 1;

struct BakeSettings {
  std::uint64_t seed = 1;          // [0, kLargestSeed]
  int sectors = 1000;              // records to bake, [1, 1,000,000]
  int grid = 32;                   // density grid cells per side, [8, 128]
  double sigma = 0.05;             // standard deviation of a strand's Gaussian, sector coordinates, [0.01, 0.08]
  int views = 128;                 // view angles on the full circle, [4, 256]
  int lights = 8;                  // light angles on the full circle, [4, 256]
  int samples = 16;                // values along s, [4, 256]
  double smoothing = 1.5;          // Gaussian along s, in units of sigma, [0, 4]
  double reference_scale = 0.025;  // c0, optical scale at which reflectance is composited (DESIGN section 4)
  double max_path = 4;             // longest march in units of the sector's height, [1, 16]
  double early_stop = 0.995;       // opacity at which reflectance stops accumulating, (0, 1]
  double max_strands = 24;         // random sectors: strands per sector are drawn log-uniformly from [1, max_strands]
  PlanarPhong phong;
  FeatureSet features = FeatureSet::profile11;
  Storage storage = Storage::u8;
  bool operator==(const BakeSettings&) const = default;
};

BakeSettings load_bake_settings(const std::filesystem::path& file);  ///< @throws InputError
std::string to_json(const BakeSettings& settings);                   ///< canonical text: fixed key order, no spaces
BakeSettings bake_settings_from_json(const std::string& text, const std::string& where);  ///< @throws InputError

}  // namespace pelage
