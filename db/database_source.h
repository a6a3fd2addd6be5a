// DatabaseSource: the SATF [Xu2006 eq. 4] looked up in a database of records. attach() turns sectors into features,
// finds their nearest records and chooses among them so that strands run through; evaluate() is one bilinear lookup.
//
// Coherent choice (DESIGN section 5). A track's sectors, root to tip, take a sequence of (record, shift in s), which
// minimises  sum over plates of  |feature distance|^2 / dimension  +  kJumpWeight * sum over HSVs of  jump.
//   feature distance: sector's scaled features against those of the record's strands after the shift
//   jump: mean squared difference of the two records' s-profiles (tau seen along r), the first moved on by the HSV's
//         mean drift, in units of the database's mean squared profile, weighted by the sector's hat window (sector.h).
// A record that is held, its shift following the drift, costs no jump. Candidates of a plate are its nearest records at
// a few shifts and whatever the previous plate held; dynamic programming with the kBeam best kept per plate. Sectors
// without strands (kEmptyDensity) are not searched; they evaluate to tau 0, re 1, and a track starts anew behind them.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <vector>

#include "pelage/db/record_bank.h"
#include "pelage/db/record_source.h"

namespace pelage {

/// Mean density [strands per sector] below which a sector counts as empty: the tail of a strand next door.
inline constexpr float kEmptyDensity = 0.02F;

struct LookupSettings {
  int neighbours = 1;      // records blended per sector by inverse feature distance, [1, 8]
  bool coherent = true;    // choose along tracks; off: the nearest at each plate by itself
  bool own_alpha = false;  // tau from the sector's own strands, analytic; reflectance from the record
};

class DatabaseSource final : public RecordSource {
 public:
  /// The feature set that the database was baked with.
  explicit DatabaseSource(std::shared_ptr<const RecordBank> bank, const LookupSettings& settings = LookupSettings{});
  /// Another feature set: features and index are made again from the stored strands.
  DatabaseSource(std::shared_ptr<const RecordBank> bank, const LookupSettings& settings, FeatureSet features);
  /// @throws InputError as DatabaseReader       @throws UsageError for settings out of range
  explicit DatabaseSource(const std::filesystem::path& database, const LookupSettings& settings = LookupSettings{});
  ~DatabaseSource() override;

  const RecordBank& bank() const noexcept { return *bank_; }
  int samples() const noexcept override { return bank_->shape().samples; }
  float reference_scale() const noexcept override {
    return static_cast<float>(bank_->metadata().settings.reference_scale);
  }
  void attach(const SectorSet& sectors) override;
  std::uint64_t searches() const noexcept override { return searches_; }
  void evaluate(std::size_t sector, const SatfAngles& angles, std::span<float> tau,
                std::span<float> re) const noexcept override;

  /// What a sector shows; nothing blended and shift 0 for an empty one.
  struct Pick {
    std::uint32_t record;
    float weight;  // of the blend, sum 1
  };
  std::span<const Pick> picks(std::size_t sector) const noexcept;
  float shift(std::size_t sector) const noexcept { return shifts_[sector]; }

 private:
  struct Catalogue;  // index and shift tables of the records
  void keep_own(const SectorSet& sectors);
  void own_tau(std::size_t sector, const SatfAngles& angles, std::span<float> tau) const noexcept;

  std::shared_ptr<const RecordBank> bank_;
  LookupSettings settings_;
  std::unique_ptr<const Catalogue> catalogue_;
  std::vector<Pick> picks_;      // [sector][neighbours]
  std::vector<float> shifts_;    // [sector]
  SectorSet own_;                // strands inside the sectors, for own_alpha
  std::vector<float> own_mass_;  // of each: its share between r = 0 and r = 1
  std::atomic<std::uint64_t> searches_{0};
};

}  // namespace pelage
