// RecordSource: the SATF [Xu2006 eq. 4] as the runtime sees it. The database is one source, direct tracing another.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "pelage/data_schema/sector.h"

namespace pelage {

/// Angles [rad] at s = 0 and s = 1, linear in between (unwrapped: `last - first` may exceed pi), in sector coordinates:
/// from outward r, positive towards +s, already mapped through J^-1 (DESIGN section 4).
struct SatfAngles {
  float view_first, view_last;
  float light_first, light_last;
};

class RecordSource {
 public:
  virtual ~RecordSource() = default;
  RecordSource() = default;
  RecordSource(const RecordSource&) = delete;
  RecordSource& operator=(const RecordSource&) = delete;

  virtual int samples() const noexcept = 0;            ///< values along s per evaluation
  virtual float reference_scale() const noexcept = 0;  ///< c0 of the optical depths

  /// Finds what the sectors need (features, search, coherent choice along tracks). Once per geometry, not per frame.
  virtual void attach(const SectorSet& sectors) = 0;
  /// Searches (FLANN queries) made so far: constant while only camera and light move.
  virtual std::uint64_t searches() const noexcept = 0;

  /// SATF of an attached sector: `tau` (at c0) and straight reflectance `re`, samples() values each, entry x at
  /// s = (x + 1/2) / samples(). `re` may be empty: only tau is wanted. Thread-safe.
  virtual void evaluate(std::size_t sector, const SatfAngles& angles, std::span<float> tau,
                        std::span<float> re) const noexcept = 0;
};

}  // namespace pelage
