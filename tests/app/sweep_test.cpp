// The sweep of `pelage tradeoff` over measures of our own, whose errors and times are known.
#include "pelage/app/sweep.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "pelage/app/all_knobs.h"
#include "pelage/app/tradeoff_files.h"
#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/scene_values.h"

namespace pelage::app {
namespace {

using testing::HasSubstr;
using testing::UnorderedElementsAre;

/// Error 1 / cells, time cells; blends of more records take longer for nothing; fewer layers are faster and a little
/// worse.
class FakeMeasure final : public Measure {
 public:
  explicit FakeMeasure(std::function<void()> each) : each_(std::move(each)) {}
  const MeasureFacts& facts() const override { return facts_; }
  std::pair<std::string, std::string> command() const override { return {"render", "-o picture.png"}; }
  Measured measure(const Scene& scene) override {
    each_();
    const double cells = scene.shadow.density_map.resolution, slow = scene.satf.neighbours,
                 layers = scene.division.layers;
    if (cells == 48) throw InputError("48", "cannot be built");
    Measured m;
    m.error = (scene.shadow.density_map.filter ? 1 : 4) / cells + 0.001 / layers;
    const double ms = cells * slow * (0.5 + layers / 6);
    m.ms = {ms, 1.5 * ms, 0.5 * ms};
    m.bytes = 7;
    m.others = {{"bias", -m.error}};
    m.picture = Image(2, 2);
    return m;
  }

 private:
  std::function<void()> each_;
  MeasureFacts facts_{"picture", "Pictures", "RMSE", "", "a frame", "known"};
};

std::vector<Knob> knobs() {
  const std::vector<std::string> base{"method=density-map"};
  return {{"map.cells", "Cells.", "cells", MeasureKind::picture, base,
           numbers("shadow.density_map.resolution", {16, 32, 48, 64, 96, 128, 192, 256})},
          {"map.filter", "Filter.", "", MeasureKind::picture, base,
           choices("shadow.density_map.filter", {"true", "false"})},
          {"map.layers", "Layers.", "layers", MeasureKind::picture, base, numbers("division.layers", {1, 2, 3})},
          {"map.slow", "For nothing.", "records", MeasureKind::picture, base, numbers("satf.neighbours", {2, 4})}};
}

class Sweep : public testing::Test {
 protected:
  Sweep() {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_ / "points");
    std::ofstream(folder_ / "a.hair") << "bytes";
  }
  ~Sweep() override { std::filesystem::remove_all(folder_); }

  SweepRequest request() {
    SweepRequest r;
    r.measure.scene.hair = (folder_ / "a.hair").string();
    r.measure.scene.satf.neighbours = 1;
    r.knobs = knobs();
    r.folder = folder_;
    r.name = "a";
    r.command = "pelage tradeoff a.hair";
    r.row_words = "a.hair";
    r.make_measure = [this](MeasureKind, const MeasureRequest&) {
      return std::make_unique<FakeMeasure>([this] {
        if (++calls_ == interrupt_at_) throw Interrupted("stopped");
      });
    };
    return r;
  }
  static const TradeoffRow& row(const Tradeoff& t, const std::string& id) {
    for (const TradeoffRow& r : t.diagrams.at(0).rows)
      if (r.id == id) return r;
    throw std::out_of_range(id);
  }

  std::filesystem::path folder_ = std::filesystem::temp_directory_path() / ("pelage-sweep-" + std::to_string(getpid()));
  int calls_ = 0, interrupt_at_ = 0;
};

TEST_F(Sweep, HasEveryValueOfEveryKnobAndTheDefault) {
  const Tradeoff t = sweep(request());
  ASSERT_EQ(t.diagrams.size(), 1U);
  std::set<std::string> ids;
  for (const TradeoffRow& r : t.diagrams[0].rows) EXPECT_TRUE(ids.insert(r.id).second) << r.id;
  for (const Knob& k : knobs())
    for (const KnobValue& v : k.values) EXPECT_EQ(ids.count(k.name + "-" + v.label), 1U) << k.name << v.label;
  EXPECT_EQ(ids.count("default"), 1U);
  const TradeoffRow& r = row(t, "map.cells-32");
  EXPECT_EQ(r.time.median_ms, 32);
  EXPECT_EQ(r.time.min_ms, 16);
  EXPECT_EQ(r.time.max_ms, 48);
  EXPECT_EQ(r.time.repeats, 3);
  EXPECT_EQ(r.amount, 32);
  EXPECT_EQ(r.bytes, 7U);
  EXPECT_EQ(r.origin.scene_hash.size(), 16U);
  EXPECT_THAT(r.command,
              HasSubstr("pelage render a.hair --set method=density-map --set shadow.density_map.resolution=32 "
                        "-o picture.png"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / r.picture));
}

TEST_F(Sweep, PlantedSlowAndWrongSettingsAreNotOnTheFront) {
  const Tradeoff t = sweep(request());
  EXPECT_FALSE(row(t, "map.slow-2").on_front);
  EXPECT_FALSE(row(t, "map.slow-4").on_front);
  EXPECT_FALSE(row(t, "map.filter-false").on_front);
  EXPECT_TRUE(row(t, "map.cells-256").on_front);
}

TEST_F(Sweep, SlopeIsThatOfTheMeasure) {
  const Tradeoff t = sweep(request());
  bool found = false;
  for (const Slope& s : t.diagrams[0].slopes) {
    if (s.knob != "map.cells" || s.against != "cells") continue;
    found = true;
    EXPECT_NEAR(s.slope, -1, .03);
    EXPECT_EQ(s.points, 7) << "the one that failed has no place";
  }
  EXPECT_TRUE(found);
}

TEST_F(Sweep, PointThatFailsIsListedWithItsReason) {
  const Tradeoff t = sweep(request());
  EXPECT_THAT(row(t, "map.cells-48").failed, HasSubstr("cannot be built"));
  EXPECT_FALSE(row(t, "map.cells-48").on_front);
  EXPECT_TRUE(row(t, "map.cells-64").failed.empty());
}

TEST_F(Sweep, MeasureThatCannotBeMadeFailsItsPointsAndNoOthers) {
  SweepRequest r = request();
  r.knobs.push_back(
      {"motion.step", "Step.", "s", MeasureKind::motion, {}, numbers("simulation.life.step_s", {0.004, 0.008})});
  int made = 0;
  r.make_measure = [&, whole = r.make_measure](MeasureKind kind, const MeasureRequest& m) -> std::unique_ptr<Measure> {
    if (kind == MeasureKind::picture) return whole(kind, m);
    ++made;
    throw InputError("a.hair", "has no strands");
  };
  const Tradeoff t = sweep(r);
  ASSERT_EQ(t.diagrams.size(), 2U);
  for (const TradeoffRow& row : t.diagrams[1].rows) EXPECT_THAT(row.failed, HasSubstr("has no strands"));
  EXPECT_THAT(t.diagrams[1].truth, HasSubstr("has no strands"));
  EXPECT_EQ(made, 1);
  EXPECT_TRUE(row(t, "map.cells-64").failed.empty());
}

TEST_F(Sweep, OneSceneIsMeasuredOnce) {
  const Tradeoff t = sweep(request());
  std::set<std::string> scenes;
  for (const TradeoffRow& r : t.diagrams[0].rows)
    scenes.insert(to_json(with_values(request().measure.scene, r.settings)));
  EXPECT_EQ(static_cast<std::size_t>(calls_), scenes.size());
  EXPECT_LT(scenes.size(), t.diagrams[0].rows.size()) << "defaults of knobs are one point";
}

TEST_F(Sweep, CombinationsOfKnobsAreMeasuredWhereTheyMayPay) {
  const Tradeoff t = sweep(request());
  int combined = 0, on_front = 0;
  for (const TradeoffRow& r : t.diagrams[0].rows) {
    if (r.knob != "combined") continue;
    ++combined;
    on_front += r.on_front ? 1 : 0;
    EXPECT_GE(r.settings.size(), 3U) << "base and two knobs";
  }
  EXPECT_GT(combined, 0);
  EXPECT_GT(on_front, 0);
  SweepRequest alone = request();
  alone.combine = false;
  const Tradeoff without = sweep(alone);
  for (const TradeoffRow& r : without.diagrams[0].rows) EXPECT_NE(r.knob, "combined");
}

TEST_F(Sweep, ResumedIsTheSameAsUndisturbed) {
  const std::string undisturbed = tradeoff_json(sweep(request())).dump();
  const int all = calls_;
  for (const int stop : {1, 2, 7, all - 1, all}) {
    std::filesystem::remove_all(folder_ / "points");
    std::filesystem::create_directories(folder_ / "points");
    calls_ = 0;
    interrupt_at_ = stop;
    EXPECT_THROW(sweep(request()), Interrupted);
    interrupt_at_ = 0;
    EXPECT_TRUE(tradeoff_json(sweep(request())).dump() == undisturbed) << stop;
    EXPECT_EQ(calls_, all + 1) << "only the point that was interrupted is begun twice; " << stop;
  }
}

TEST_F(Sweep, DamagedPointIsMeasuredAgain) {
  const std::string undisturbed = tradeoff_json(sweep(request())).dump();
  calls_ = 0;
  std::ofstream(folder_ / "points" / "picture.map.cells-32.json") << "{\"id\": ";
  std::filesystem::remove(folder_ / "points" / "picture.map.cells-96.png");
  EXPECT_TRUE(tradeoff_json(sweep(request())).dump() == undisturbed);
  EXPECT_EQ(calls_, 2);
}

TEST_F(Sweep, OtherSceneOtherSeedAndOtherDetailAreOtherPoints) {
  sweep(request());
  const int all = calls_;
  SweepRequest other = request();
  other.measure.seed = 2;
  calls_ = 0;
  sweep(other);
  EXPECT_EQ(calls_, all);
  other = request();
  other.measure.scene.lights[0].intensity = 2;
  calls_ = 0;
  sweep(other);
  EXPECT_EQ(calls_, all);
  std::ofstream(folder_ / "a.hair") << "other bytes";
  calls_ = 0;
  sweep(other);
  EXPECT_EQ(calls_, all);
}

TEST_F(Sweep, QuickKeepsBothEndsOfAKnob) {
  SweepRequest quick = request();
  quick.measure.quick = true;
  std::vector<double> cells;
  const Tradeoff t = sweep(quick);
  for (const TradeoffRow& r : t.diagrams[0].rows)
    if (r.knob == "map.cells") cells.push_back(r.amount);
  EXPECT_EQ(cells.size(), 5U);
  EXPECT_EQ(cells.front(), 16);
  EXPECT_EQ(cells.back(), 256);
}

TEST(AllKnobs, HaveNamesOfTheirOwnAndValuesThatAScenesKnows) {
  Scene scene;
  scene.hair = "a.hair";
  std::set<std::string> names;
  for (const Knob& k : all_knobs()) {
    EXPECT_TRUE(names.insert(k.name).second) << k.name;
    EXPECT_EQ(k.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789.-"), std::string::npos) << k.name;
    EXPECT_FALSE(k.what.empty());
    std::set<std::string> labels;
    for (const KnobValue& v : k.values) {
      EXPECT_TRUE(labels.insert(v.label).second) << k.name << " " << v.label;
      Scene with = with_values(scene, k.base);
      EXPECT_NO_THROW(with = with_values(with, v.settings)) << k.name << " " << v.label;
    }
  }
}

TEST(AllKnobs, AreChosenByNameOrByTheirFirstPart) {
  EXPECT_EQ(chosen_knobs({}).size(), all_knobs().size());
  EXPECT_EQ(chosen_knobs({"strands.order"}).size(), 1U);
  EXPECT_GT(chosen_knobs({"strands"}).size(), 3U);
  try {
    chosen_knobs({"strands.oder"});
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("strands.order"));
  }
}

}  // namespace
}  // namespace pelage::app
