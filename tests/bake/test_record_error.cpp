// What turns a source of records into an error: the sample of sectors, values along s, and the bars.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "../db/fixtures.h"
#include "pelage/bake/direct_source.h"
#include "pelage/bake/record_error.h"

namespace pelage {
namespace {

using namespace fixtures;

TEST(SectorSample, CountsPlatesBetweenThoseThatAreBaked) {
  const Hairstyle style = hand_made_style(2, 60, 1);
  const BakeSettings settings = small_settings();
  const SectorSample own = sample_sectors(style, settings, 1'000'000, 2);
  const SectorSample between = sample_sectors(style, settings, 1'000'000, 2, Counted::between);
  ASSERT_EQ(between.sectors.tracks(), own.sectors.tracks());
  ASSERT_EQ(between.sectors.plates, 2 * own.sectors.plates);
  EXPECT_EQ(own.counted, own.used);
  const auto length = static_cast<std::size_t>(own.sectors.plates) + 1;
  std::size_t same = 0;
  for (std::size_t i = 0; i < own.sectors.size(); ++i) {
    // The own plates are the even ones; floating point may differ in the last place.
    const std::size_t there = i / length * (2 * length - 1) + 2 * (i % length);
    EXPECT_FALSE(between.counted[there]);
    const SectorCrossings a = own.sectors.sector(i), b = between.sectors.sector(there);
    same += a.size() == b.size();
  }
  EXPECT_GE(same, own.sectors.size() * 99 / 100);
  EXPECT_GT(std::count(between.counted.begin(), between.counted.end(), 1), 50);
}

TEST(RecordError, HasABarThatIsTheDeltaMethodsOverTracks) {
  SectorSample sample;
  sample.angle_pairs = 1;
  sample.sectors.plates = 1;
  sample.sectors.offsets.assign(7, 0);
  sample.sectors.drift.assign(6, 0);
  sample.used = sample.counted = std::vector<char>(6, 1);
  sample.used[5] = sample.counted[5] = 0;
  SeenSectors seen, truth;
  seen.samples = truth.samples = 1;
  seen.alpha = truth.alpha = truth.radiance = std::vector<float>(5, 0.0F);
  seen.along_r = truth.along_r = std::vector<float>(6, 0.0F);
  seen.radiance = {1, 1, 2, 2, 3};  // squares per track: 2 of 2 values, 8 of 2, 9 of 1
  const RecordError error = record_error(seen, truth, sample);
  const double mean = 19.0 / 5;
  EXPECT_NEAR(error.radiance_rmse, std::sqrt(mean), 1e-12);
  EXPECT_NEAR(error.radiance_bias, 9.0 / 5, 1e-12);
  const double sum = std::pow(2 - 2 * mean, 2) + std::pow(8 - 2 * mean, 2) + std::pow(9 - mean, 2);
  EXPECT_NEAR(error.radiance_rmse_error, std::sqrt(sum * 3 / 2) / 5 / (2 * std::sqrt(mean)), 1e-12);
}

/// tau is a wave along s.
class Wave final : public RecordSource {
 public:
  explicit Wave(int samples) : samples_(samples) {}
  int samples() const noexcept override { return samples_; }
  float reference_scale() const noexcept override { return 1e-3F; }
  void attach(const SectorSet&) override {}
  std::uint64_t searches() const noexcept override { return 0; }
  void evaluate(std::size_t, const SatfAngles&, std::span<float> tau, std::span<float> re) const noexcept override {
    for (std::size_t x = 0; x < tau.size(); ++x) {
      const double s = (static_cast<double>(x) + 0.5) / samples_;
      tau[x] = static_cast<float>(2e-5 * (1.5 + std::sin(2 * std::numbers::pi * s)));
    }
    std::fill(re.begin(), re.end(), 1.0F);
  }

 private:
  int samples_;
};

TEST(SeenSectors, AreInterpolatedAlongS) {
  const SectorSample sample = sample_sectors(hand_made_style(1, 60, 1), small_settings(), 100, 2);
  const SeenSectors fine = look(Wave(96), sample);
  double before = 0;
  for (const int samples : {8, 16, 32}) {
    const RecordError e = record_error(look(Wave(samples), sample, 96), fine, sample);
    const double error = e.alpha_rmse;
    if (before > 0) {
      EXPECT_NEAR(before / error, 4, 0.5) << samples << ": linear interpolation is of order two";
    }
    EXPECT_EQ(e.alpha_rmse, e.radiance_rmse);
    before = error;
  }
  EXPECT_EQ(record_error(look(Wave(96), sample, 96), fine, sample).alpha_rmse, 0);
}

TEST(SeenSectors, OfAFinerTraceComeCloserToIt) {
  const Hairstyle style = hand_made_style(2, 60, 1);
  BakeSettings settings = small_settings();
  const SectorSample sample = sample_sectors(style, settings, 200, 3, Counted::between);
  const auto seen = [&](int grid) {
    settings.grid = grid;
    DirectSource source(settings);
    source.attach(sample.sectors);
    return look(source, sample);
  };
  const SeenSectors truth = seen(64);
  const double coarse = record_error(seen(8), truth, sample).radiance_rmse;
  const double fine = record_error(seen(32), truth, sample).radiance_rmse;
  EXPECT_LT(3 * fine, coarse);
  EXPECT_GT(fine, 0);
}

}  // namespace
}  // namespace pelage
