// DirectSource: the SATF without a database. Every evaluation traces the sector's own density (the last rung of the
// accuracy ladder and the truth of the database's errors, DESIGN section 4).
#pragma once

#include "pelage/bake/planar_tracer.h"
#include "pelage/db/record_source.h"

namespace pelage {

class DirectSource final : public RecordSource {
 public:
  explicit DirectSource(const BakeSettings& settings) : tracer_(settings) {}

  int samples() const noexcept override { return tracer_.settings().samples; }
  float reference_scale() const noexcept override { return static_cast<float>(tracer_.settings().reference_scale); }
  void attach(const SectorSet& sectors) override;  ///< copies the crossings
  std::uint64_t searches() const noexcept override { return 0; }
  /// The density of the sector evaluated last is kept per thread: asking again for other angles costs the trace alone.
  void evaluate(std::size_t sector, const SatfAngles& angles, std::span<float> tau,
                std::span<float> re) const noexcept override;

 private:
  PlanarTracer tracer_;
  SectorSet sectors_;
  std::uint64_t attachment_ = 0;  // unique among all sources of the process
};

}  // namespace pelage
