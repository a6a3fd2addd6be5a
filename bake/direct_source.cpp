#include "pelage/bake/direct_source.h"

#include <atomic>

namespace pelage {
namespace {

std::atomic<std::uint64_t> attachments{0};

/// The sector that this thread traced last.
struct Cache {
  std::uint64_t attachment = 0;
  std::size_t sector = 0;
  DensityGrid grid;
  PlanarField field;
};
thread_local Cache cache;

}  // namespace

void DirectSource::attach(const SectorSet& sectors) {
  sectors_ = sectors;
  attachment_ = ++attachments;
}

void DirectSource::evaluate(std::size_t sector, const SatfAngles& angles, std::span<float> tau,
                            std::span<float> re) const noexcept {
  const BakeSettings& settings = tracer_.settings();
  if (cache.attachment != attachment_ || cache.sector != sector) {
    fill_density_grid(sectors_.sector(sector), settings.grid, settings.sigma, cache.grid);
    cache.field.assign(cache.grid);
    cache.attachment = attachment_;
    cache.sector = sector;
  }
  tracer_.trace_rays(cache.field, angles, tau, re);
}

}  // namespace pelage
