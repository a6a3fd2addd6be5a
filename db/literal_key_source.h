// LiteralKeySource: paper B's index read to the letter [Xu2006 eq. 4, section 5.2]. The key of an entry is
// (features, view angle, light angle), an entry is one row of values of one record seen from one direction and lit from
// one, and the entry whose key is nearest is shown as it is: nothing is interpolated in angle, so pictures jump when
// camera or light turn, and every evaluation is a search. A rung to compare with (DESIGN section 4).
//
// Key: features scaled to unit variance; each angle as sqrt(2) (cos, sin), which has unit variance too and no seam.
// Since every record has all angles, the nearest entry is that of the nearest record at the nearest angles, which the
// tests use. Angles that change along s are taken in its middle. Sectors without strands are as in DatabaseSource.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <vector>

#include "pelage/db/nearest_sectors.h"
#include "pelage/db/record_bank.h"
#include "pelage/db/record_source.h"

namespace pelage {

class LiteralKeySource final : public RecordSource {
 public:
  /// @throws InputError where the search would take more than 2 GiB
  explicit LiteralKeySource(std::shared_ptr<const RecordBank> bank);

  int samples() const noexcept override { return bank_->shape().samples; }
  float reference_scale() const noexcept override {
    return static_cast<float>(bank_->metadata().settings.reference_scale);
  }
  void attach(const SectorSet& sectors) override;
  std::uint64_t searches() const noexcept override { return searches_; }
  void evaluate(std::size_t sector, const SatfAngles& angles, std::span<float> tau,
                std::span<float> re) const noexcept override;

  std::size_t bytes() const noexcept;  ///< of the entries' keys, their search and the records

  /// Entry that an attached sector shows; none where it is empty.
  struct Entry {
    std::uint32_t record;
    int view, light;
    bool operator==(const Entry&) const = default;
  };
  std::optional<Entry> nearest(std::size_t sector, float view, float light) const;

 private:
  std::shared_ptr<const RecordBank> bank_;
  NearestSectors index_;
  std::vector<float> features_;  // [sector][dimension], scaled
  std::vector<char> empty_;      // [sector]
  mutable std::atomic<std::uint64_t> searches_{0};
};

}  // namespace pelage
