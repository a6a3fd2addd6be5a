// All records of a database in memory, laid out for the lookup: the value of the SATF [Xu2006 eq. 4].
//
// Layout, measured (tests/bench/bench_maps.cpp, where records change from sector to sector as they do in use):
//   re   [record][view][light + 1][sample], the first light again at the end: a sector touches a handful of cache
//   lines.
//        [view][sample][light] brings both lights with one load but touches a line per sample.
//   tau  [record][view][sample]
// Cells are 8 bits as stored; halves become 16 bits of the record's maximum (error <= max / 131070, below the half's
// own 2^-11 of values beyond 1.6 % of it).
#pragma once

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <glm/vec2.hpp>
#include <memory>
#include <span>
#include <vector>

#include "pelage/db/database.h"
#include "pelage/db/record_source.h"

namespace pelage {

class RecordBank {
 public:
  /// Reads and verifies all rows, on TBB's threads.
  explicit RecordBank(const DatabaseReader& reader);
  /// @throws InputError as DatabaseReader
  explicit RecordBank(const std::filesystem::path& database) : RecordBank(DatabaseReader(database)) {}
  /// From rows in memory.
  RecordBank(DatabaseMetadata metadata, FeatureScale scale, std::span<const StoredSector> sectors);

  std::size_t size() const noexcept { return scales_.size(); }
  const RecordShape& shape() const noexcept { return shape_; }
  const DatabaseMetadata& metadata() const noexcept { return metadata_; }
  const FeatureScale& feature_scale() const noexcept { return feature_scale_; }
  std::span<const float> features() const noexcept { return features_; }  ///< [record][dimension], unscaled
  SectorCrossings crossings(std::size_t record) const noexcept {
    return {crossings_.data() + offsets_[record], crossings_.data() + offsets_[record + 1]};
  }
  float tau(std::size_t record, int view, int sample) const noexcept;
  std::size_t bytes() const noexcept { return tau_.size + re_.size; }

  /// tau and re of a record moved by `shift` along s (in sector widths, periodic), at angles that are linear in s:
  /// entry x of `tau` and `re` is at s = (x + 1/2) / samples. Bilinear in the periodic angles; along s, the record's
  /// samples are evaluated where they come to lie and interpolated linearly. `re` may be empty. Angles and shift must
  /// be finite.
  void lookup(std::size_t record, float shift, const SatfAngles& angles, std::span<float> tau,
              std::span<float> re) const noexcept;

 private:
  struct Scales {
    float tau, re;  // value of one step of a cell
  };
  /// Bytes that nobody clears first, in huge pages where the system has them: touching 69 MB of fresh 4 KB pages costs
  /// seven times copying them (tests/bench/bench_open.cpp).
  struct Cells {
    struct Free {
      void operator()(std::uint8_t* p) const noexcept { std::free(p); }
    };
    std::unique_ptr<std::uint8_t[], Free> bytes;
    std::size_t size = 0;
    void allocate(std::size_t count);
    std::uint8_t* data() const noexcept { return bytes.get(); }
  };
  void allocate(std::size_t records);
  void set(std::size_t record, const SectorView& sector);
  void set_crossings(std::span<const std::vector<glm::vec2>> of_record);

  DatabaseMetadata metadata_;
  FeatureScale feature_scale_;
  RecordShape shape_;
  std::size_t cell_bytes_ = 1;
  std::vector<Scales> scales_;
  Cells tau_, re_;
  std::vector<float> features_;
  std::vector<std::uint32_t> offsets_{0};
  std::vector<glm::vec2> crossings_;
};

}  // namespace pelage
