// Distances between records, and from sectors to records, against looking at every pair.
#include "pelage/db/coverage.h"

#include <gmock/gmock.h>

#include <cmath>

#include "fixtures.h"
#include "pelage/db/database_source.h"
#include "pelage/db/sectors.h"

namespace pelage {
namespace {

using namespace fixtures;

RecordBank bank_of(const std::vector<StoredSector>& sectors, const BakeSettings& settings) {
  return {metadata_of(settings, sectors.size()), scale_of(sectors), sectors};
}

/// RMS over the features, in deviations of the records.
double distance(const RecordBank& bank, const float* a, const float* b) {
  const std::vector<double>& inv_sigma = bank.feature_scale().inv_sigma;
  double sum = 0;
  for (std::size_t i = 0; i < inv_sigma.size(); ++i) {
    sum += std::pow((static_cast<double>(a[i]) - static_cast<double>(b[i])) * inv_sigma[i], 2);
  }
  return std::sqrt(sum / static_cast<double>(inv_sigma.size()));
}

TEST(Coverage, SpacingIsTheDistanceToTheNearestOtherRecord) {
  const BakeSettings settings = small_settings();
  const RecordBank bank = bank_of(arbitrary_sectors(settings, 60), settings);
  const std::vector<float> spacing = record_spacing(bank);
  ASSERT_EQ(spacing.size(), 60U);
  const std::size_t width = bank.features().size() / 60;
  for (std::size_t i = 0; i < 60; ++i) {
    double nearest = INFINITY;
    for (std::size_t j = 0; j < 60; ++j) {
      if (i != j) nearest = std::min(nearest, distance(bank, &bank.features()[i * width], &bank.features()[j * width]));
    }
    EXPECT_NEAR(spacing[i], nearest, 1e-5 * (1 + nearest)) << i;  // float sums of 11 terms
  }
}

TEST(Coverage, TwinsAreAtDistanceZeroAndALoneRecordToo) {
  const BakeSettings settings = small_settings();
  std::vector<StoredSector> sectors = arbitrary_sectors(settings, 5);
  sectors.push_back(sectors[2]);
  const std::vector<float> spacing = record_spacing(bank_of(sectors, settings));
  EXPECT_EQ(spacing[2], 0.0F);
  EXPECT_EQ(spacing[5], 0.0F);
  EXPECT_GT(spacing[1], 0.0F);
  EXPECT_EQ(record_spacing(bank_of(arbitrary_sectors(settings, 1), settings)), std::vector<float>{0.0F});
}

TEST(Coverage, SectorsAreMeasuredToTheirNearestRecordAndEmptyOnesLeftOut) {
  const BakeSettings settings = small_settings();
  const RecordBank bank = bank_of(arbitrary_sectors(settings, 40), settings);
  const Hairstyle style = hand_made_style(2, 3, 1);
  const SectorSet sectors = sectors_of(style.clusters, style.division);
  const std::vector<float> features = used_sector_features(bank, sectors);
  const std::vector<float> distances = distances_to_records(bank, features);
  const std::size_t width = features.size() / distances.size();
  ASSERT_GT(distances.size(), 20U);
  ASSERT_LT(distances.size(), sectors.size());
  for (std::size_t i = 0; i < distances.size(); i += 7) {
    EXPECT_GE(features[i * width], kEmptyDensity);
    double nearest = INFINITY;
    for (std::size_t j = 0; j < bank.size(); ++j) {
      nearest = std::min(nearest, distance(bank, &features[i * width], &bank.features()[j * width]));
    }
    EXPECT_NEAR(distances[i], nearest, 1e-5 * (1 + nearest)) << i;
  }
  std::vector<float> own(bank.features().begin(), bank.features().end());
  EXPECT_THAT(distances_to_records(bank, own), testing::Each(0.0F));
  EXPECT_TRUE(distances_to_records(bank, {}).empty());
}

TEST(Coverage, UncoveredIsBeyondNearlyAllRecords) {
  std::vector<float> spacing;
  for (int i = 1; i <= 100; ++i) spacing.push_back(static_cast<float>(i));
  EXPECT_EQ(uncovered_share(spacing, {1, 95, 96, 1000}), 0.5);
  EXPECT_EQ(uncovered_share(spacing, {}), 0.0);
}

TEST(Coverage, Quantiles) {
  EXPECT_EQ(quantile({}, 0.5), 0.0F);
  EXPECT_EQ(quantile({3, 1, 2}, 0), 1.0F);
  EXPECT_EQ(quantile({3, 1, 2}, 0.5), 2.0F);
  EXPECT_EQ(quantile({3, 1, 2}, 1), 3.0F);
}

}  // namespace
}  // namespace pelage
