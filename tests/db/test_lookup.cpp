// Search, bank and source: exactness, periodicity, coherence. HARD_CASES 12, 13, 16 (0 neighbours), 18.
#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include <cmath>
#include <numbers>

#include "fixtures.h"
#include "pelage/data_schema/errors.h"
#include "pelage/db/database_source.h"
#include "pelage/db/nearest_sectors.h"
#include "pelage/db/sectors.h"

namespace pelage {
namespace {

using namespace fixtures;
using testing::HasSubstr;

constexpr float kTurn = 2 * std::numbers::pi_v<float>;

std::vector<float> random_points(int count, int dimensions, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  std::vector<float> points(static_cast<std::size_t>(count * dimensions));
  for (float& p : points) p = normal(random);
  return points;
}

TEST(NearestSectors, EqualsLookingAtEveryPoint) {
  for (const int dimensions : {1, 3, 5, 11}) {
    for (const int count : {1, 2, 9, 11, 500}) {
      const NearestSectors index(random_points(count, dimensions, 1), dimensions);
      const auto queries = random_points(100, dimensions, 2);
      for (std::size_t q = 0; q < 100; ++q) {
        const std::span query(&queries[q * static_cast<std::size_t>(dimensions)], static_cast<std::size_t>(dimensions));
        for (const int k : {1, 4, 8}) EXPECT_EQ(index.nearest(query, k), index.nearest_exhaustive(query, k));
      }
    }
  }
}

TEST(NearestSectors, TiesGoToTheFirstRecord) {
  std::vector<float> points = random_points(40, 3, 1);
  for (int copy = 0; copy < 4; ++copy) points.insert(points.end(), points.begin(), points.begin() + 120);
  const NearestSectors index(points, 3);
  const auto found = index.nearest(std::span(points).subspan(3 * 17, 3), 3);
  EXPECT_EQ(found, (std::vector<Neighbour>{{17, 0.0F}, {57, 0.0F}, {97, 0.0F}}));
}

TEST(NearestSectors, ALatticeFullOfTiesEqualsLookingAtEveryPoint) {
  std::vector<float> points;
  for (int i = 0; i < 343; ++i) {
    for (const int c : {i % 7, i / 7 % 7, i / 49}) points.push_back(static_cast<float>(c));
  }
  points.insert(points.end(), points.begin(), points.begin() + 300);
  const NearestSectors index(points, 3);
  for (const std::vector<float>& query : {std::vector<float>{3, 3, 3}, {2.5F, 2.5F, 2.5F}, {0, 0, 0}, {9, 3, 3}}) {
    for (const int k : {1, 2, 7, 8, 40, 443}) EXPECT_EQ(index.nearest(query, k), index.nearest_exhaustive(query, k));
  }
}

TEST(NearestSectors, ManyEqualPointsCostNoMoreThanOne) {  // minutes, if each query looked at all of them
  const NearestSectors index(std::vector<float>(400'000, 0.5F), 2);
  for (int i = 0; i < 200'000; ++i) ASSERT_EQ(index.nearest(index.point(0), 2)[1].record, 1U);
}

TEST(NearestSectors, DistancesBeyondFloatAreStillOrdered) {
  const NearestSectors index({0, 1e30F, 2e30F}, 1);
  EXPECT_EQ(index.nearest(std::vector<float>{3e38F}, 2).size(), 2U);
}

TEST(NearestSectors, RefusesNothingAndNaN) {
  EXPECT_THAT(message_of<UsageError>([] { NearestSectors({}, 3); }), HasSubstr("at least one"));
  EXPECT_THAT(message_of<InputError>([] { NearestSectors({0, 1, 2, 3, std::nanf(""), 5}, 3); }), HasSubstr("record 1"));
}

/// A bank of arbitrary records, and the same as floats.
struct Bank {
  BakeSettings settings;
  std::vector<StoredSector> sectors;
  std::shared_ptr<const RecordBank> bank;

  explicit Bank(const BakeSettings& s, int count = 5) : Bank(s, arbitrary_sectors(s, count)) {}
  Bank(const BakeSettings& s, std::vector<StoredSector> rows) : settings(s), sectors(std::move(rows)) {
    bank = std::make_shared<RecordBank>(metadata_of(settings, sectors.size()), scale_of(sectors), sectors);
  }
  std::vector<float> tau(std::size_t record) const { return dequantise(sectors[record].tau, settings.storage); }
  std::vector<float> re(std::size_t record) const { return dequantise(sectors[record].re, settings.storage); }
};

struct Looked {
  std::vector<float> tau, re;
};
Looked look(const RecordBank& bank, std::size_t record, float shift, const SatfAngles& angles) {
  const auto n = static_cast<std::size_t>(bank.shape().samples);
  Looked out{std::vector<float>(n), std::vector<float>(n)};
  bank.lookup(record, shift, angles, out.tau, out.re);
  return out;
}
SatfAngles fixed_angles(float view, float light) {
  return {view, view, light, light};
}

class RecordBankTest : public testing::TestWithParam<Storage> {
 protected:
  Bank bank_{small_settings(GetParam())};
  // Rounding of angles to cells (2e-6 of a cell at 8 cells) times the largest step between cells, and for halves the
  // bank's 16 bits.
  float tolerance_ = 4e-5F;
};
INSTANTIATE_TEST_SUITE_P(Storages, RecordBankTest, testing::Values(Storage::u8, Storage::half),
                         [](const auto& storage) { return storage.param == Storage::u8 ? "u8" : "half"; });

TEST_P(RecordBankTest, GridAnglesGiveStoredValues) {
  for (std::size_t record = 0; record < bank_.sectors.size(); ++record) {
    const auto tau = bank_.tau(record), re = bank_.re(record);
    for (int v = -8; v < 16; ++v) {
      for (int l = -6; l < 12; ++l) {
        const Looked got = look(*bank_.bank, record, 0,
                                fixed_angles(kTurn * static_cast<float>(v) / 8, kTurn * static_cast<float>(l) / 6));
        const auto view = static_cast<std::size_t>((v + 8) % 8), light = static_cast<std::size_t>((l + 6) % 6);
        for (std::size_t x = 0; x < 16; ++x) {
          ASSERT_NEAR(got.tau[x], tau[view * 16 + x], tolerance_) << v << ' ' << x;
          ASSERT_NEAR(got.re[x], re[(view * 6 + light) * 16 + x], tolerance_) << v << ' ' << l << ' ' << x;
        }
      }
    }
  }
}

TEST_P(RecordBankTest, InterpolatesAcrossTheWrap) {
  const auto tau = bank_.tau(1), re = bank_.re(1);
  // 359 degrees of 8 views: .9778 of the way from view 7 to view 0; 1 degree: .0222 from view 0 to view 1.
  for (const float degrees : {359.0F, 1.0F, -1.0F, 361.0F, 719.0F}) {
    const Looked got = look(*bank_.bank, 1, 0, fixed_angles(degrees * kTurn / 360, degrees * kTurn / 360));
    const bool below = std::fmod(degrees + 720, 360.0F) > 180;
    const std::size_t v0 = below ? 7 : 0, v1 = below ? 0 : 1, l0 = below ? 5 : 0, l1 = below ? 0 : 1;
    const float v = below ? 1 - 8.0F / 360 : 8.0F / 360, l = below ? 1 - 6.0F / 360 : 6.0F / 360;
    for (std::size_t x = 0; x < 16; ++x) {
      EXPECT_NEAR(got.tau[x], (1 - v) * tau[v0 * 16 + x] + v * tau[v1 * 16 + x], tolerance_);
      const auto at = [&](std::size_t i, std::size_t j) { return re[(i * 6 + j) * 16 + x]; };
      EXPECT_NEAR(got.re[x],
                  (1 - v) * ((1 - l) * at(v0, l0) + l * at(v0, l1)) + v * ((1 - l) * at(v1, l0) + l * at(v1, l1)),
                  tolerance_);
    }
  }
}

TEST_P(RecordBankTest, AnglesVaryLinearlyAlongS) {
  const SatfAngles angles{5.9F, 7.1F, 0.4F, -1.3F};
  const Looked got = look(*bank_.bank, 2, 0, angles);
  for (std::size_t x = 0; x < 16; ++x) {
    const float s = (static_cast<float>(x) + 0.5F) / 16;
    const Looked one = look(*bank_.bank, 2, 0, fixed_angles(5.9F + s * 1.2F, 0.4F - s * 1.7F));
    EXPECT_NEAR(got.tau[x], one.tau[x], tolerance_);
    EXPECT_NEAR(got.re[x], one.re[x], tolerance_);
  }
}

TEST_P(RecordBankTest, ShiftMovesTheRecordTowardsLargerS) {
  const auto tau = bank_.tau(3);
  for (const float samples : {1.0F, 3.0F, 16.0F, -2.0F, 2.5F, 0.25F}) {
    const Looked got = look(*bank_.bank, 3, samples / 16, fixed_angles(0, 0));
    const float whole = std::floor(samples), beyond = samples - whole;
    for (int x = 0; x < 16; ++x) {
      const auto from = [&](int k) {
        return tau[static_cast<std::size_t>(((x - static_cast<int>(whole) - k) % 16 + 16) % 16)];
      };
      EXPECT_NEAR(got.tau[static_cast<std::size_t>(x)], (1 - beyond) * from(0) + beyond * from(1), tolerance_)
          << samples << ' ' << x;
    }
  }
}

TEST_P(RecordBankTest, ConstantRecordIsConstantAtEveryAngleAndShift) {
  HrirRecord flat{record_shape(bank_.settings), {}, {}};
  flat.tau.assign(flat.shape.tau_size(), 0.125F);
  flat.re.assign(flat.shape.re_size(), 1.5F);
  const Bank bank(bank_.settings, {stored(bank_.settings, flat, {{0.5F, 0.5F}})});
  std::mt19937 random(1);
  std::uniform_real_distribution<float> angle(-20, 20);
  for (int i = 0; i < 200; ++i) {
    const Looked got = look(*bank.bank, 0, angle(random), {angle(random), angle(random), angle(random), angle(random)});
    for (std::size_t x = 0; x < 16; ++x) {
      EXPECT_NEAR(got.tau[x], 0.125F, 1e-6F);
      EXPECT_NEAR(got.re[x], 1.5F, 1e-6F);
    }
  }
}

TEST_P(RecordBankTest, TauAloneIsTheSame) {
  const SatfAngles angles{1, 2, 3, 4};
  const Looked both = look(*bank_.bank, 4, 0.3F, angles);
  std::vector<float> tau(16);
  bank_.bank->lookup(4, 0.3F, angles, tau, {});
  EXPECT_EQ(tau, both.tau);
}

// ---------------------------------------------------------------------------------------------------------------------

/// A record as wide in s as a strand at `s`, the same from all sides.
HrirRecord bump_record(const BakeSettings& settings, float s) {
  HrirRecord record{record_shape(settings), {}, {}};
  record.re.assign(record.shape.re_size(), 1.0F);
  for (int v = 0; v < settings.views; ++v) {
    for (int x = 0; x < settings.samples; ++x) {
      float d = (static_cast<float>(x) + 0.5F) / static_cast<float>(settings.samples) - s;
      d -= std::round(d);
      record.tau.push_back(0.2F * std::exp(-d * d / (2 * 0.09F * 0.09F)));
    }
  }
  return record;
}

/// One strand per record, at s = (i + 1/2) / count.
Bank bumps(int count) {
  BakeSettings settings = small_settings();
  settings.samples = 32;
  settings.grid = 32;
  std::vector<StoredSector> rows;
  for (int i = 0; i < count; ++i) {
    const float s = (static_cast<float>(i) + 0.5F) / static_cast<float>(count);
    rows.push_back(stored(settings, bump_record(settings, s), {{s, 0.5F}}));
  }
  return {settings, std::move(rows)};
}

/// One track whose only strand is at s on plate i.
template <class Place>
SectorSet track_of(int plates, Place place) {
  SectorSet set;
  set.plates = plates;
  for (int i = 0; i <= plates; ++i) {
    set.crossings.push_back({place(i), 0.5F});
    set.offsets.push_back(static_cast<std::uint32_t>(set.crossings.size()));
    set.drift.push_back(i < plates ? place(i + 1) - place(i) : 0.0F);
  }
  return set;
}

TEST(DatabaseSource, HoldsTheRecordOfAConstantTrack) {
  const Bank bank = bumps(8);
  DatabaseSource source(bank.bank);
  // Jitter of +-.02 around .372, where the nearest of the eight records flips between .3125 and .4375.
  const SectorSet set = track_of(20, [](int i) { return 0.375F + (i % 2 == 0 ? 0.02F : -0.02F); });
  SectorSet still = set;
  std::fill(still.drift.begin(), still.drift.end(), 0.0F);
  source.attach(still);
  std::uint32_t first = source.picks(0).front().record;
  for (std::size_t i = 0; i < set.size(); ++i) {
    ASSERT_EQ(source.picks(i).size(), 1U);
    EXPECT_EQ(source.picks(i).front().record, first) << i;
    EXPECT_EQ(source.shift(i), source.shift(0)) << i;
  }
  // Without coherence it does flip: the test above tests something.
  DatabaseSource single(bank.bank, {.coherent = false});
  single.attach(still);
  EXPECT_NE(single.picks(0).front().record, single.picks(1).front().record);
}

TEST(DatabaseSource, FollowsTheDrift) {
  const Bank bank = bumps(8);
  DatabaseSource source(bank.bank);
  const SectorSet set = track_of(20, [](int i) { return 0.2F + 0.03F * static_cast<float>(i); });
  source.attach(set);
  std::vector<float> tau(32);
  for (std::size_t i = 0; i < set.size(); ++i) {
    source.evaluate(i, fixed_angles(0, 0), tau, {});
    double mass = 0, sine = 0, cosine = 0;
    for (std::size_t x = 0; x < 32; ++x) {
      const double at = 2 * std::numbers::pi * (static_cast<double>(x) + 0.5) / 32;
      mass += static_cast<double>(tau[x]);
      sine += static_cast<double>(tau[x]) * std::sin(at);
      cosine += static_cast<double>(tau[x]) * std::cos(at);
    }
    double off = std::atan2(sine, cosine) / (2 * std::numbers::pi) - static_cast<double>(set.crossings[i].x);
    off -= std::round(off);
    EXPECT_LT(std::abs(off), 0.05) << "plate " << i;  // one standard deviation of a strand
    EXPECT_GT(mass, 0);
  }
  // It moves by the drift from plate to plate, not by the spacing of the records.
  for (std::size_t i = 1; i < set.size(); ++i) {
    float step = source.shift(i) - source.shift(i - 1);
    step -= std::round(step);
    if (source.picks(i).front().record == source.picks(i - 1).front().record) {
      EXPECT_NEAR(step, 0.03F, 0.01F);  // taken up anew at a tried shift: a fifth of a strand's sigma
    }
  }
}

TEST(DatabaseSource, SearchesOncePerSectorWithStrandsAndNeverInEvaluate) {
  const Bank bank = bumps(8);
  DatabaseSource source(bank.bank);
  SectorSet set = track_of(9, [](int) { return 0.4F; });
  set.offsets.resize(5);  // the last six sectors are empty
  set.crossings.resize(4);
  set.offsets.resize(11, 4);
  source.attach(set);
  EXPECT_EQ(source.searches(), 4U);
  std::vector<float> tau(32), re(32);
  for (std::size_t i = 0; i < set.size(); ++i) source.evaluate(i, {0, 1, 2, 3}, tau, re);
  EXPECT_EQ(source.searches(), 4U);
  EXPECT_THAT(tau, testing::Each(0.0F));  // of the last, empty one
  EXPECT_THAT(re, testing::Each(1.0F));
  EXPECT_TRUE(source.picks(9).empty());
}

TEST(DatabaseSource, ASectorOfTheDatabaseFindsItself) {
  for (const FeatureSet set : {FeatureSet::paper3, FeatureSet::moments5, FeatureSet::profile11}) {
    const Bank bank(small_settings(), 12);
    DatabaseSource source(bank.bank, {.coherent = false}, set);
    SectorSet sectors;
    sectors.plates = 11;
    for (const StoredSector& s : bank.sectors) {
      sectors.crossings.insert(sectors.crossings.end(), s.crossings.begin(), s.crossings.end());
      sectors.offsets.push_back(static_cast<std::uint32_t>(sectors.crossings.size()));
      sectors.drift.push_back(0);
    }
    source.attach(sectors);
    for (std::uint32_t i = 0; i < 12; ++i) EXPECT_EQ(source.picks(i).front().record, i);
  }
}

TEST(DatabaseSource, BlendsByInverseDistance) {
  const Bank bank(small_settings(), 12);
  DatabaseSource source(bank.bank, {.neighbours = 3, .coherent = false});
  SectorSet sectors = track_of(2, [](int i) { return 0.3F + 0.1F * static_cast<float>(i); });
  source.attach(sectors);
  const SatfAngles angles{0.3F, 0.5F, 2, 2.5F};
  std::vector<float> tau(16), re(16);
  source.evaluate(1, angles, tau, re);
  ASSERT_EQ(source.picks(1).size(), 3U);
  double weights = 0;
  std::vector<double> depth(16), premultiplied(16);
  for (const auto& pick : source.picks(1)) {
    const Looked one = look(*bank.bank, pick.record, 0, angles);
    weights += static_cast<double>(pick.weight);
    for (std::size_t x = 0; x < 16; ++x) {
      depth[x] += static_cast<double>(pick.weight * one.tau[x]);
      premultiplied[x] += static_cast<double>(pick.weight * one.tau[x] * one.re[x]);
    }
  }
  EXPECT_NEAR(weights, 1, 1e-6);
  EXPECT_GE(source.picks(1)[0].weight, source.picks(1)[2].weight);
  for (std::size_t x = 0; x < 16; ++x) {
    EXPECT_NEAR(tau[x], depth[x], 1e-6);
    EXPECT_NEAR(re[x], premultiplied[x] / depth[x], 1e-4);
  }
}

TEST(DatabaseSource, RefusesNoNeighboursAndTakesAsManyAsThereAre) {
  const Bank bank(small_settings(), 2);
  EXPECT_THAT(message_of<UsageError>([&] { DatabaseSource(bank.bank, {.neighbours = 0}); }),
              HasSubstr("neighbours is 0"));
  EXPECT_THROW(DatabaseSource(bank.bank, {.neighbours = 9}), UsageError);
  DatabaseSource source(bank.bank, {.neighbours = 5});
  source.attach(track_of(3, [](int) { return 0.4F; }));
  EXPECT_EQ(source.picks(0).size(), 2U);
}

TEST(DatabaseSource, SectorsOfAnyCountAreFinite) {  // none, one, 10,000, all on the border or far outside
  const Bank bank(small_settings(), 12);
  SectorSet set;
  set.plates = 5;
  std::mt19937 random(1);
  std::uniform_real_distribution<float> place(-0.35F, 1.35F);
  for (const int count : {0, 1, 10000, 40, 40, 0}) {
    for (int i = 0; i < count; ++i) {
      const bool border = set.offsets.size() == 4;
      set.crossings.push_back(border ? glm::vec2(i % 2, 1.0F) : glm::vec2(place(random), place(random)));
    }
    set.offsets.push_back(static_cast<std::uint32_t>(set.crossings.size()));
    set.drift.push_back(place(random));
  }
  for (const bool coherent : {false, true}) {
    for (const bool own_alpha : {false, true}) {
      for (const int neighbours : {1, 4}) {
        DatabaseSource source(bank.bank, {neighbours, coherent, own_alpha});
        source.attach(set);
        std::vector<float> tau(16), re(16);
        for (std::size_t i = 0; i < set.size(); ++i) {
          for (float view = -7; view < 7; view += 0.37F) {
            source.evaluate(i, {view, view + 0.5F, 1, 2}, tau, re);
            for (std::size_t x = 0; x < 16; ++x) {
              ASSERT_TRUE(std::isfinite(tau[x]) && tau[x] >= 0) << i << ' ' << view;
              ASSERT_TRUE(std::isfinite(re[x]) && re[x] >= 0) << i << ' ' << view;
            }
          }
        }
      }
    }
  }
}

TEST(DatabaseSource, NoTracksIsFine) {
  const Bank bank(small_settings(), 2);
  DatabaseSource source(bank.bank);
  source.attach(SectorSet{});
  EXPECT_EQ(source.searches(), 0U);
}

TEST(DatabaseSource, FeaturesAreScaledBeforeTheyAreCompared) {
  // Densities differ by 40 strands, positions by .8: unscaled, density alone would decide.
  BakeSettings settings = small_settings();
  settings.features = FeatureSet::paper3;
  std::vector<StoredSector> rows;
  for (const int strands : {1, 5, 40}) {
    for (const float s : {0.1F, 0.9F}) {
      rows.push_back(stored(settings, arbitrary_record(settings, 1),
                            std::vector<glm::vec2>(static_cast<std::size_t>(strands), {s, 0.5F})));
    }
  }
  const Bank bank(settings, rows);
  DatabaseSource source(bank.bank, {.coherent = false});
  SectorSet set;
  set.plates = 0;
  set.crossings.assign(9, {0.85F, 0.5F});
  set.offsets.push_back(9);
  set.drift.push_back(0);
  set.plates = 1;
  set.offsets.push_back(9);
  set.drift.push_back(0);
  source.attach(set);
  EXPECT_EQ(source.picks(0).front().record, 3U);  // five strands at .9
}

TEST(DatabaseSource, TheSameForAnyNumberOfThreads) {
  const Bank bank(small_settings(), 12);
  const Hairstyle style = hand_made_style(2, 60, 5);
  const SectorSet set = sectors_of(style.clusters, style.division);
  std::vector<std::pair<std::uint32_t, float>> once;
  for (const std::size_t threads : {1U, 2U, 3U, 8U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    DatabaseSource source(bank.bank);
    source.attach(set);
    std::vector<std::pair<std::uint32_t, float>> picks;
    for (std::size_t i = 0; i < set.size(); ++i) {
      picks.emplace_back(source.picks(i).empty() ? 999 : source.picks(i).front().record, source.shift(i));
    }
    if (once.empty()) once = picks;
    EXPECT_EQ(picks, once) << threads;
  }
}

}  // namespace
}  // namespace pelage
