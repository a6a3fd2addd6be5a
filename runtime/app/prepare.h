// From a scene to something that can be drawn: hairstyle (read, or fitted and cached), record source (database given,
// or adapted one baked and cached, or direct tracing), head.
#pragma once

#include <filesystem>
#include <memory>

#include "pelage/data_schema/mesh.h"
#include "pelage/data_schema/scene.h"
#include "pelage/db/record_bank.h"
#include "pelage/db/record_source.h"

namespace pelage::app {

/// Fitted hairstyles and adapted databases are kept here, named by a hash of everything they depend on:
/// $PELAGE_CACHE, else $XDG_CACHE_HOME/pelage, else ~/.cache/pelage. Safe to delete at any time; where it cannot be
/// written, nothing is kept and a warning says so.
std::filesystem::path cache_folder();

/// Another folder while it lives, removed with all that is in it: for sweeps, whose many databases nobody asks for
/// again. Its databases are kept below `most_bytes`, the oldest going first, whenever trim() is called.
class TemporaryCache {
 public:
  /// @throws OutputError
  TemporaryCache(const std::filesystem::path& folder, std::uintmax_t most_bytes);
  ~TemporaryCache();
  TemporaryCache(const TemporaryCache&) = delete;
  TemporaryCache& operator=(const TemporaryCache&) = delete;
  void trim() const;

 private:
  std::filesystem::path folder_, before_;
  std::uintmax_t most_bytes_;
};

Hairstyle prepare_hairstyle(const Scene& scene);
/// Hair strand by strand, with a drawn diameter: a hair file's own strands, or those of a hairstyle's clusters.
struct StrandHair {
  std::string name;
  Strands strands;
  float opacity = kDefaultOpacity;
};
StrandHair prepare_strands(const Scene& scene);
/// Hair and what it grows on.
struct Subject {
  StrandHair hair;
  Mesh head;
};
Mesh prepare_head(const Scene& scene);
/// @param bake  out: the settings that the records were baked with
std::unique_ptr<RecordSource> prepare_records(const Scene& scene, const Hairstyle& style, BakeSettings& bake);
/// What looks records up in the database as the settings have it; not for RecordsFrom::direct.
std::unique_ptr<RecordSource> record_source(const SatfSettings& satf, std::shared_ptr<const RecordBank> bank);
/// Baked into a temporary file that is removed once it is read.
/// @param style  none: random sectors
std::shared_ptr<const RecordBank> bake_temporary(const BakeSettings& settings, const Hairstyle* style);
/// A database of random sectors, baked with the scene's settings and kept like the adapted ones. @return its file
/// @throws OutputError where the cache cannot be written
std::filesystem::path prepare_generic_database(const Scene& scene);

}  // namespace pelage::app
