// The paper's index read to the letter: the nearest entry of features and both angles, shown as it is.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "fixtures.h"
#include "pelage/data_schema/errors.h"
#include "pelage/db/database_source.h"
#include "pelage/db/literal_key_source.h"
#include "pelage/db/sectors.h"

namespace pelage {
namespace {

using namespace fixtures;

constexpr float kTurn = 2 * std::numbers::pi_v<float>;

std::shared_ptr<const RecordBank> bank_of(const BakeSettings& settings, const std::vector<StoredSector>& rows) {
  return std::make_shared<RecordBank>(metadata_of(settings, rows.size()), scale_of(rows), rows);
}

/// Sectors with these crossings, one after the other on one track.
SectorSet sectors_with(const std::vector<std::vector<glm::vec2>>& all) {
  SectorSet sectors;
  sectors.plates = static_cast<int>(all.size()) - 1;
  for (const auto& crossings : all) {
    sectors.crossings.insert(sectors.crossings.end(), crossings.begin(), crossings.end());
    sectors.offsets.push_back(static_cast<std::uint32_t>(sectors.crossings.size()));
    sectors.drift.push_back(0);
  }
  return sectors;
}

struct Values {
  std::vector<float> tau, re;
};
Values shown(const RecordSource& source, std::size_t sector, float view, float light) {
  const auto n = static_cast<std::size_t>(source.samples());
  Values out{std::vector<float>(n), std::vector<float>(n)};
  source.evaluate(sector, {view, view, light, light}, out.tau, out.re);
  return out;
}

class LiteralKey : public ::testing::Test {
 protected:
  LiteralKey() {
    std::vector<std::vector<glm::vec2>> own;
    for (const StoredSector& s : rows_) own.push_back(s.crossings);
    own.push_back({});
    source_.attach(sectors_with(own));
  }
  float view(int i) const { return kTurn * static_cast<float>(i) / static_cast<float>(settings_.views); }
  float light(int i) const { return kTurn * static_cast<float>(i) / static_cast<float>(settings_.lights); }

  BakeSettings settings_ = small_settings();
  std::vector<StoredSector> rows_ = arbitrary_sectors(settings_, 7);
  LiteralKeySource source_{bank_of(settings_, rows_)};
};

TEST_F(LiteralKey, ShowsARecordsOwnValuesAtBakedAngles) {
  const auto n = static_cast<std::size_t>(settings_.samples);
  for (std::size_t record = 0; record < rows_.size(); ++record) {
    const auto tau = dequantise(rows_[record].tau, settings_.storage);
    const auto re = dequantise(rows_[record].re, settings_.storage);
    for (int v = 0; v < settings_.views; ++v) {
      for (int l = 0; l < settings_.lights; ++l) {
        const Values got = shown(source_, record, view(v), light(l));
        for (std::size_t x = 0; x < n; ++x) {  // tolerance as in test_lookup.cpp: rounding of angles to cells
          const auto row = static_cast<std::size_t>(v);
          ASSERT_NEAR(got.tau[x], tau[row * n + x], 4e-5F);
          ASSERT_NEAR(got.re[x],
                      re[(row * static_cast<std::size_t>(settings_.lights) + static_cast<std::size_t>(l)) * n + x],
                      4e-5F);
        }
      }
    }
  }
}

TEST_F(LiteralKey, JumpsHalfWayBetweenAngles) {
  const float step = view(1);
  for (const float turns : {0.0F, kTurn, -3 * kTurn}) {  // angles have no seam
    for (int v = 0; v < settings_.views; ++v) {
      const Values at = shown(source_, 2, view(v), light(1));
      for (const float share : {-0.49F, -0.2F, 0.3F, 0.49F}) {
        const Values near = shown(source_, 2, view(v) + share * step + turns, light(1));
        EXPECT_EQ(near.tau, at.tau) << v << " " << share;
        EXPECT_EQ(near.re, at.re) << v << " " << share;
      }
      EXPECT_NE(shown(source_, 2, view(v) + 0.51F * step + turns, light(1)).tau, at.tau);
    }
  }
}

TEST_F(LiteralKey, FindsTheNearestRecordAtTheNearestAngles) {
  // Every record has all angles, so the two searches part; DatabaseSource's own pick is the oracle for the record.
  const auto bank = bank_of(settings_, rows_);
  std::vector<std::vector<glm::vec2>> others;
  for (unsigned seed = 100; seed < 130; ++seed) others.push_back(arbitrary_crossings(seed));
  const SectorSet sectors = sectors_with(others);
  DatabaseSource oracle(bank, {1, false, false});
  oracle.attach(sectors);
  source_.attach(sectors);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> angle(-kTurn, kTurn);
  const auto nearest = [](float a, int count) {
    const int i = static_cast<int>(std::lround(a / kTurn * static_cast<float>(count)));
    return ((i % count) + count) % count;
  };
  for (std::size_t i = 0; i < sectors.size(); ++i) {
    for (int k = 0; k < 20; ++k) {
      const float v = angle(random), l = angle(random);
      const auto entry = source_.nearest(i, v, l);
      ASSERT_TRUE(entry.has_value());
      EXPECT_EQ(entry->record, oracle.picks(i)[0].record);
      EXPECT_EQ(entry->view, nearest(v, settings_.views));
      EXPECT_EQ(entry->light, nearest(l, settings_.lights));
    }
  }
  EXPECT_EQ(source_.searches(), 600U) << "one for each evaluation, whatever moves";
}

TEST_F(LiteralKey, ShowsNothingOfSectorsWithoutStrands) {
  const Values got = shown(source_, rows_.size(), 1, 2);
  EXPECT_EQ(got.tau, std::vector<float>(got.tau.size(), 0.0F));
  EXPECT_EQ(got.re, std::vector<float>(got.re.size(), 1.0F));
}

TEST_F(LiteralKey, TakesOpacityAlone) {
  std::vector<float> tau(static_cast<std::size_t>(settings_.samples));
  source_.evaluate(1, {view(3), view(3), light(2), light(2)}, tau, {});
  EXPECT_EQ(tau, shown(source_, 1, view(3), light(2)).tau);
}

TEST(LiteralKeyMemory, RefusesWhatWouldNotFitAndSaysWhatToBake) {
  BakeSettings settings = small_settings();
  settings.views = settings.lights = 256;
  settings.samples = 4;
  const HrirRecord record = arbitrary_record(settings, 1);
  std::vector<StoredSector> rows;
  for (unsigned i = 0; i < 200; ++i) rows.push_back(stored(settings, record, arbitrary_crossings(i)));
  EXPECT_THAT(message_of<InputError>([&] { LiteralKeySource{bank_of(settings, rows)}; }),
              ::testing::AllOf(::testing::HasSubstr("200 records of 256 x 256"), ::testing::HasSubstr("bake.sectors")));
}

}  // namespace
}  // namespace pelage
