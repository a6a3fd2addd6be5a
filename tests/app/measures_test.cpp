// The measures of `pelage tradeoff` on a groom of our own: errors fall as they should, bars are what they say.
#include <gmock/gmock.h>

#include <cmath>

#include "../data_schema/temporary.h"
#include "../db/fixtures.h"
#include "pelage/app/measure.h"
#include "pelage/app/shadow_error.h"
#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/scene_values.h"
#include "pelage/hair/groom.h"
#include "pelage/hair/hair_file.h"

namespace pelage::app {
namespace {

using Strings = std::vector<std::string>;

MeasureRequest request_for(const test::TemporaryFolder& folder, std::uint32_t strands) {
  hair::GroomSettings settings;
  settings.strands = strands;
  Strands groom = hair::groom(settings);
  hair::write_hair(groom, folder / "groom.hair");
  MeasureRequest request;
  request.scene.hair = folder / "groom.hair";
  request.scene.method = Method::density_map;
  request.quick = true;
  return request;
}

/// Of log y against log x.
double slope_of(const std::vector<double>& x, const std::vector<double>& y) {
  const auto n = static_cast<double>(x.size());
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double u = std::log(x[i]), v = std::log(y[i]);
    sx += u;
    sy += v;
    sxx += u * u;
    sxy += u * v;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

double other(const Measured& measured, const std::string& name) {
  for (const auto& [key, value] : measured.others)
    if (key == name) return value;
  throw std::out_of_range(name);
}

TEST(ShadowErrorBar, IsThatOfTheDeltaMethodAndOfTheTruth) {
  // Errors of .1 and .3, half each: mean square .05, s.d. of squares .04.
  std::vector<float> t;
  std::vector<TruthEstimate> truth;
  for (int i = 0; i < 200; ++i) {
    t.push_back(0.5F);
    truth.push_back({i % 2 == 0 ? 0.4 : 0.2, 0});
  }
  const double rmse = std::sqrt(0.05);
  EXPECT_NEAR(shadow_error(t, truth).rmse, rmse, 1e-12);
  EXPECT_NEAR(shadow_error(t, truth).rmse_error, 0.04 / std::sqrt(200) / (2 * rmse), 1e-9);
  for (TruthEstimate& e : truth) e.standard_error = 0.1;
  EXPECT_NEAR(shadow_error(t, truth).rmse_error, std::hypot(0.04 / std::sqrt(200), 0.01) / (2 * rmse), 1e-9);
  EXPECT_EQ(shadow_error({0.4F}, {{static_cast<double>(0.4F), 0.1}}).rmse_error, 0);
}

class Transmittance : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<test::TemporaryFolder>();
    request_ = request_for(*folder_, 3000);
    measure_ = measure_transmittance(request_);
  }
  static void TearDownTestSuite() {
    measure_.reset();
    folder_.reset();
  }
  static Measured measured(const Strings& settings) { return measure_->measure(with_values(request_.scene, settings)); }
  inline static std::unique_ptr<test::TemporaryFolder> folder_;
  inline static MeasureRequest request_;
  inline static std::unique_ptr<Measure> measure_;
};

TEST_F(Transmittance, ErrorFallsWithCellsAtTheKnownOrder) {
  std::vector<double> cells, errors;
  for (const int n : {32, 64, 128, 256}) {
    const Measured m = measured({"shadow.density_map.resolution=" + std::to_string(n)});
    cells.push_back(n);
    errors.push_back(m.error);
    EXPECT_LT(m.error_bar, 0.2 * m.error) << n;
    EXPECT_GT(m.bytes, 0U);
    EXPECT_GE(m.ms.size(), 3U);
  }
  // NUMBERS.md "Shadows": from .078 at 32 cells to .022 at 256 is -.61.
  const double slope = slope_of(cells, errors);
  RecordProperty("slope", std::to_string(slope));
  EXPECT_GT(slope, -1.1) << ::testing::PrintToString(errors);
  EXPECT_LT(slope, -0.4) << ::testing::PrintToString(errors);
}

TEST_F(Transmittance, KnowsBetterMethodsFromWorseOnes) {
  const double corrected = measured({}).error;
  const Measured none = measured({"method=unshadowed"});
  EXPECT_LT(3 * corrected, none.error);
  EXPECT_GT(other(none, "bias"), 0.1);
  EXPECT_LE(none.error, other(none, "p99"));
  EXPECT_LE(other(none, "p99"), other(none, "max"));
  const double few = measured({"method=opacity-shadow", "shadow.opacity_map.slices=4"}).error;
  EXPECT_LT(measured({"method=opacity-shadow", "shadow.opacity_map.slices=64"}).error, few);
}

TEST_F(Transmittance, IsTheSameAgainAndForAnyMethodThatDrawsOtherwise) {
  const Measured a = measured({}), b = measure_transmittance(request_)->measure(request_.scene);
  EXPECT_EQ(a.error, b.error);
  EXPECT_EQ(a.others[0], b.others[0]);
  EXPECT_EQ(measured({"method=satf"}).error, a.error);
}

TEST_F(Transmittance, NeedsALightAndSaysSo) {
  MeasureRequest dark = request_;
  dark.scene.lights.clear();
  EXPECT_THROW(measure_transmittance(dark), UsageError);
  EXPECT_THROW(measured({"method=deep-opacity", "lights.0.position=[0,3,0]"}), std::exception);
}

class Records : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<test::TemporaryFolder>();
    Hairstyle style = fixtures::hand_made_style(3, 120, 5);
    style.division.plates = 24;
    save_hairstyle(style, *folder_ / "style.json");
    request_.scene.hair = *folder_ / "style.json";
    request_.scene.satf.records = RecordsFrom::database;
    request_.scene.satf.neighbours = 1;
    request_.scene.bake.views = 128;
    request_.scene.bake.lights = 8;
    request_.scene.bake.sectors = 150;
    request_.quick = true;
    measure_ = measure_records(request_);
  }
  static void TearDownTestSuite() {
    measure_.reset();
    folder_.reset();
  }
  static Measured measured(const Strings& settings) { return measure_->measure(with_values(request_.scene, settings)); }
  inline static std::unique_ptr<test::TemporaryFolder> folder_;
  inline static MeasureRequest request_;
  inline static std::unique_ptr<Measure> measure_;
};

TEST_F(Records, ErrorFallsWithRecordsOfTheHairstyle) {
  double before = 1;
  for (const int sectors : {15, 45, 150}) {
    const Measured m = measured({"bake.sectors=" + std::to_string(sectors)});
    EXPECT_LT(m.error, 0.95 * before) << sectors;
    EXPECT_GT(m.error_bar, 0);
    EXPECT_LT(m.error_bar, 0.25 * m.error);
    EXPECT_GT(m.prepare_ms, 0);
    EXPECT_GE(m.ms.size(), 3U);
    before = m.error;
  }
}

TEST_F(Records, LiteralKeyIsWorseThanInterpolatedAnglesAndDirectIsBest) {
  const Measured adapted = measured({}), literal = measured({"satf.records=literal-key"}),
                 own = measured({"satf.records=own-alpha"}), direct = measured({"satf.records=direct"});
  EXPECT_GT(literal.error, 1.05 * adapted.error);
  EXPECT_GT(literal.bytes, 2 * adapted.bytes);
  EXPECT_LT(own.error, adapted.error);
  EXPECT_LT(other(own, "alpha RMSE"), other(adapted, "alpha RMSE"));
  EXPECT_LT(direct.error, 0.6 * own.error);
  EXPECT_GT(direct.error, 0) << "the truth is traced finer";
  EXPECT_EQ(direct.prepare_ms, 0);
}

TEST_F(Records, ErrorFallsWithAngles) {
  // Tilted by one step of 32 views, a ray crosses a sector of height 1 by .2 from where it would: four strands' widths.
  const double coarse = measured({"bake.views=32"}).error;
  EXPECT_GT(coarse, 1.5 * measured({"bake.views=128"}).error);
  EXPECT_NEAR(measured({"bake.views=32", "bake.lights=32"}).error, coarse, 0.1 * coarse);
}

TEST_F(Records, AreTheSameAgainAndBakedOnce) {
  const Measured a = measured({}), b = measured({}), c = measure_records(request_)->measure(request_.scene);
  EXPECT_EQ(a.error, b.error);
  EXPECT_EQ(a.error, c.error);
  EXPECT_EQ(a.others[2], c.others[2]);
  EXPECT_THAT(measured({"satf.neighbours=4"}).error, ::testing::Ne(a.error));
}

TEST_F(Records, OfAnyHairAreWorseThanOfThisOne) {
  const Measured generic = measured({"database=generic"});
  EXPECT_GT(generic.error, 1.5 * measured({}).error);
}

}  // namespace
}  // namespace pelage::app
