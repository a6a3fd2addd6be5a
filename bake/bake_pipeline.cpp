#include "pelage/bake/bake_pipeline.h"

#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <chrono>
#include <cstdio>
#include <memory>
#include <vector>

#include "pelage/bake/planar_tracer.h"
#include "pelage/bake/sector_sampling.h"
#include "pelage/data_schema/errors.h"
#include "pelage/db/database.h"
#include "pelage/db/database_source.h"
#include "pelage/db/sectors.h"

namespace pelage {
namespace {

/// The sectors to bake, by index.
using Choice = std::function<std::vector<glm::vec2>(std::uint64_t index)>;

struct Plan {
  std::uint64_t sectors = 0;
  Choice crossings;
};

Plan plan_random(const BakeSettings& settings) {
  return {static_cast<std::uint64_t>(settings.sectors),
          [&settings](std::uint64_t i) { return random_sector(settings, i); }};
}

/// Non-empty sectors of a hairstyle and their scaled features.
struct Population {
  std::vector<std::uint32_t> sectors;
  std::vector<float> features;
};
Population population(const SectorSet& sectors, const BakeSettings& settings) {
  const std::vector<float> all = density_features(sectors, settings.features, settings.grid, settings.sigma);
  const auto width = static_cast<std::size_t>(dimension(settings.features));
  Population p;
  for (std::size_t i = 0; i < sectors.size(); ++i) {
    const float* row = &all[i * width];
    if (!(row[0] >= kEmptyDensity)) continue;
    p.sectors.push_back(static_cast<std::uint32_t>(i));
    p.features.insert(p.features.end(), row, row + width);
  }
  if (!p.sectors.empty()) fit_scale(p.features, static_cast<int>(width)).apply(p.features);
  return p;
}

Plan plan_adapted(const BakeSettings& settings, const Hairstyle& style) {
  auto sectors = std::make_shared<const SectorSet>(sectors_of(style.clusters, style.division));
  const Population all = population(*sectors, settings);
  if (all.sectors.empty())
    throw InputError(style.name, "no strand crosses any of its sectors: there is nothing to bake");
  std::vector<std::uint32_t> chosen =
      representatives(all.features, dimension(settings.features), settings.sectors, settings.seed);
  for (std::uint32_t& index : chosen) index = all.sectors[index];
  const auto count = static_cast<std::uint64_t>(chosen.size());
  return {count, [sectors, chosen = std::move(chosen)](std::uint64_t i) {
            const SectorCrossings strands = sectors->sector(chosen[i]);
            return std::vector<glm::vec2>(strands.begin(), strands.end());
          }};
}

StoredSector bake_sector(const PlanarTracer& tracer, std::vector<glm::vec2> crossings, std::uint64_t index) {
  const BakeSettings& settings = tracer.settings();
  StoredSector row;
  row.features.resize(static_cast<std::size_t>(dimension(settings.features)));
  density_features(projections(crossings, settings.grid, settings.sigma), settings.features, row.features);
  const HrirRecord record = tracer.trace_record(density_grid(crossings, settings.grid, settings.sigma));
  const std::string where = "sector " + std::to_string(index);
  row.tau = quantise(record.tau, settings.storage, where + ", tau");
  row.re = quantise(record.re, settings.storage, where + ", re");
  row.crossings = std::move(crossings);
  return row;
}

/// Bakes rows writer.next_row() .. range.end-1 on all threads and appends them in order. The rows under way are
/// consecutive and no more than the tokens, so that each has a slot of its own; slots outlive an interruption, on which
/// the pipeline drops its tokens without destroying them.
void bake_rows(const PlanarTracer& tracer, const Choice& crossings, RowRange range, DatabaseWriter& writer,
               const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  std::uint64_t next = writer.next_row();
  std::vector<StoredSector> slots(static_cast<std::size_t>(4 * tbb::this_task_arena::max_concurrency()));
  const auto number = [&](tbb::flow_control& control) -> std::uint64_t {
    if (next == range.end) control.stop();
    return next == range.end ? 0 : next++;
  };
  const auto trace = [&](std::uint64_t i) -> StoredSector* {
    StoredSector& row = slots[static_cast<std::size_t>(i % slots.size())];
    row = bake_sector(tracer, crossings(i), i);
    return &row;
  };
  const auto store = [&](const StoredSector* row) {
    writer.append(*row);
    if (progress) progress(writer.next_row() - range.first, range.size());
  };
  using Row = StoredSector*;
  tbb::parallel_pipeline(slots.size(),
                         tbb::make_filter<void, std::uint64_t>(tbb::filter_mode::serial_in_order, number) &
                             tbb::make_filter<std::uint64_t, Row>(tbb::filter_mode::parallel, trace) &
                             tbb::make_filter<Row, void>(tbb::filter_mode::serial_in_order, store));
}

/// @throws InputError for rows that were begun for another number of records
RowRange rows_of(const Part& part, std::uint64_t records) {
  if (const auto* shard = std::get_if<Shard>(&part)) return shard_of(records, shard->index, shard->count);
  const RowRange range = std::get<RowRange>(part);
  if (range.first < range.end && range.end <= records) return range;
  throw InputError("records " + std::to_string(range.first) + " to " + std::to_string(range.end - 1),
                   "were begun, but there are only " + std::to_string(records) + " now: bake with the same settings");
}

}  // namespace

std::string hairstyle_hash(const Hairstyle& style) {
  Checksum sum;
  const Division& d = style.division;
  sum.add(&d.layers, sizeof d.layers);
  sum.add(&d.sectors, sizeof d.sectors);
  sum.add(&d.plates, sizeof d.plates);
  sum.add(&d.core, sizeof d.core);
  for (const Cluster& c : style.clusters) {
    sum.add(c.strand_offsets.data(), c.strand_offsets.size() * sizeof(std::uint32_t));
    sum.add(c.strand_points.data(), c.strand_points.size() * sizeof(DiskPoint));
  }
  char hex[17];
  std::snprintf(hex, sizeof hex, "%016llx", static_cast<unsigned long long>(sum.value()));
  return hex;
}

BakeResult bake_database(const BakeSettings& settings, const Hairstyle* style, const std::filesystem::path& out,
                         const std::function<void(std::uint64_t, std::uint64_t)>& progress, const Part& part) {
  const auto start = std::chrono::steady_clock::now();
  record_shape(settings);  // refuses before the work starts
  const Plan plan = style == nullptr ? plan_random(settings) : plan_adapted(settings, *style);
  DatabaseMetadata metadata{settings, "random", "", "", program_revision(), plan.sectors};
  if (style != nullptr) {
    metadata.source = "hairstyle";
    metadata.source_name = style->name;
    metadata.source_hash = hairstyle_hash(*style);
  }
  const RowRange range = rows_of(part, plan.sectors);
  DatabaseWriter writer(out, metadata, range);
  BakeResult result{range.size(), plan.sectors, range, writer.next_row() - range.first, 0};
  bake_rows(PlanarTracer(settings), plan.crossings, range, writer, progress);
  writer.finish();
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace pelage
