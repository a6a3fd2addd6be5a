// DirectSource: the tracer behind the RecordSource interface.
#include "pelage/bake/direct_source.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "pelage/bake/sector_sampling.h"

namespace pelage {
namespace {

SectorSet sectors(std::uint64_t first) {
  SectorSet set;
  set.plates = 1;
  for (std::uint64_t i = 0; i < 10; ++i) {
    if (i != 3)  // sector 3 is empty
      for (const glm::vec2& p : random_sector(BakeSettings{}, first + i)) set.crossings.push_back(p);
    set.offsets.push_back(static_cast<std::uint32_t>(set.crossings.size()));
    set.drift.push_back(0);
  }
  return set;
}

constexpr SatfAngles kAngles{0.3F, 0.5F, 1.0F, 1.4F};

const auto kSamples = static_cast<std::size_t>(BakeSettings{}.samples);

struct Values {
  std::vector<float> tau = std::vector<float>(kSamples), re = std::vector<float>(kSamples);
  bool operator==(const Values&) const = default;
};

Values evaluate(const RecordSource& source, std::size_t sector) {
  Values v;
  source.evaluate(sector, kAngles, v.tau, v.re);
  return v;
}

Values traced(const SectorSet& set, std::size_t sector) {
  const BakeSettings settings;
  Values v;
  PlanarTracer(settings).trace_rays(PlanarField(density_grid(set.sector(sector), settings.grid, settings.sigma)),
                                    kAngles, v.tau, v.re);
  return v;
}

TEST(DirectSource, TracesTheAttachedSectors) {
  const BakeSettings settings;
  DirectSource source(settings);
  EXPECT_EQ(source.samples(), settings.samples);
  EXPECT_FLOAT_EQ(source.reference_scale(), 0.025F);
  const SectorSet a = sectors(0), b = sectors(100);
  source.attach(a);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(evaluate(source, i), traced(a, i)) << i;
  source.attach(b);  // the same last index must not serve the old density
  EXPECT_EQ(evaluate(source, 9), traced(b, 9));
  DirectSource other(settings);
  other.attach(a);
  EXPECT_EQ(evaluate(other, 9), traced(a, 9));
  EXPECT_EQ(evaluate(source, 9), traced(b, 9));
  EXPECT_EQ(source.searches(), 0U);
}

TEST(DirectSource, EmptySectorIsTransparent) {
  DirectSource source{BakeSettings{}};
  source.attach(sectors(0));
  evaluate(source, 2);
  const Values v = evaluate(source, 3);
  EXPECT_TRUE(std::all_of(v.tau.begin(), v.tau.end(), [](float t) { return t == 0; }));
  EXPECT_TRUE(std::all_of(v.re.begin(), v.re.end(), [](float r) { return r == 1; }));
}

TEST(DirectSource, ServesThreadsAtOnce) {
  DirectSource source{BakeSettings{}};
  const SectorSet set = sectors(0);
  source.attach(set);
  std::vector<Values> expected;
  for (std::size_t i = 0; i < 10; ++i) expected.push_back(traced(set, i));
  tbb::parallel_for(0, 400, [&](int i) {
    const auto sector = static_cast<std::size_t>(i % 10);
    EXPECT_EQ(evaluate(source, sector), expected[sector]);
  });
}

}  // namespace
}  // namespace pelage
