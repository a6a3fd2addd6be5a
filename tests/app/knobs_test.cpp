// Knobs as data: every value sets places that scenes have, names are unique, papers' values are what they print.
#include "pelage/data_schema/knob.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <regex>
#include <set>

#include "pelage/bake/knobs.h"
#include "pelage/data_schema/scene_values.h"
#include "pelage/satf/knobs.h"
#include "pelage/shadow/knobs.h"

namespace pelage {
namespace {

std::vector<Knob> all_knobs() {
  std::vector<Knob> all;
  for (const std::span<const Knob> of : {shadow_knobs(), bake_knobs(), satf_knobs()})
    all.insert(all.end(), of.begin(), of.end());
  return all;
}

const Knob& knob(const std::string& name) {
  static const std::vector<Knob> all = all_knobs();
  for (const Knob& k : all)
    if (k.name == name) return k;
  throw std::out_of_range(name);
}

/// Labels of the values that a paper prints.
std::vector<std::string> printed(const std::string& name, const std::string& paper) {
  std::vector<std::string> labels;
  for (const KnobValue& v : knob(name).values)
    if (v.paper == paper) labels.push_back(v.label);
  return labels;
}

Scene plain() {
  Scene scene;
  scene.hair = "a.hair";
  return scene;
}

Scene set(const Knob& k, const KnobValue& v) {
  return with_values(with_values(plain(), k.base), v.settings);
}

TEST(Knobs, AreAcceptedByScenesAndTellTheirValuesApart) {
  for (const Knob& k : all_knobs()) {
    std::set<std::string> labels;
    for (const KnobValue& v : k.values) {
      SCOPED_TRACE(k.name + " " + v.label);
      EXPECT_TRUE(labels.insert(v.label).second);
      ASSERT_NO_THROW(set(k, v));
      for (const KnobValue& w : k.values)
        EXPECT_TRUE(&v == &w || to_json(set(k, v)) != to_json(set(k, w)) || v.threads != w.threads) << w.label;
    }
    EXPECT_GE(k.values.size(), 2U) << k.name;
  }
}

TEST(Knobs, HaveNamesOfTheirOwnAndSentences) {
  std::set<std::string> names;
  for (const Knob& k : all_knobs()) {
    EXPECT_TRUE(names.insert(k.name).second) << k.name;
    EXPECT_TRUE(std::regex_match(k.name, std::regex("[a-z0-9-]+(\\.[a-z0-9-]+)*"))) << k.name;
    EXPECT_GT(k.what.size(), 20U) << k.name;
  }
}

TEST(Knobs, GoFromCoarseToFine) {
  for (const Knob& k : all_knobs()) {
    std::vector<double> amounts;
    for (const KnobValue& v : k.values)
      if (std::isfinite(v.amount)) amounts.push_back(v.amount);
    for (std::size_t i = 1; i < amounts.size(); ++i) EXPECT_LT(amounts[i - 1], amounts[i]) << k.name;
    EXPECT_TRUE(amounts.empty() || !k.unit.empty()) << k.name;
  }
}

TEST(ShadowKnobs, HaveWhatPapersPrint) {
  EXPECT_THAT(printed("density-map.printed", "Bertails2005"), ::testing::ElementsAre("32", "64", "128", "256"));
  EXPECT_THAT(printed("deep-opacity.layers", "Yuksel2008"), ::testing::ElementsAre("3"));
  EXPECT_THAT(printed("opacity-shadow.slices", "Yuksel2008"), ::testing::ElementsAre("16", "128"));
  const Knob& k = knob("density-map.printed");
  DensityMapSettings as_printed = DensityMapSettings::printed();
  as_printed.resolution = 128;
  EXPECT_EQ(set(k, k.values[3]).shadow.density_map, as_printed);
}

TEST(RecordKnobs, HaveWhatThePaperPrints) {
  using ::testing::ElementsAre;
  EXPECT_THAT(printed("bake.from", "Xu2006"), ElementsAre("literal-key"));
  EXPECT_THAT(printed("bake.features", "Xu2006"), ElementsAre("paper3"));
  EXPECT_THAT(printed("satf.records", "Xu2006"), ElementsAre("literal-key"));
  EXPECT_THAT(printed("satf.self-shadow", "Xu2006"), ElementsAre("paper"));
  EXPECT_THAT(printed("satf.layers", "Xu2006"), ElementsAre("10", "15"));
  EXPECT_THAT(printed("satf.drift", "Xu2006"), ElementsAre("false"));
}

TEST(RecordKnobs, NameWhereRecordsComeFrom) {
  for (const char* const name : {"bake.from", "satf.records"}) {
    const Knob& k = knob(name);
    ASSERT_EQ(k.values.size(), 5U);
    for (const KnobValue& v : k.values) {
      const Scene scene = set(k, v);
      EXPECT_EQ(scene.database, v.label == "generic" ? kGenericDatabase : "") << v.label;
      const RecordsFrom expected = v.label == "literal-key" ? RecordsFrom::literal_key
                                   : v.label == "own-alpha" ? RecordsFrom::own_alpha
                                   : v.label == "direct"    ? RecordsFrom::direct
                                                            : RecordsFrom::database;
      EXPECT_EQ(scene.satf.records, expected) << v.label;
    }
  }
}

TEST(RecordKnobs, AnglesGoTogether) {
  for (const KnobValue& v : knob("bake.angles").values) {
    const BakeSettings bake = set(knob("bake.angles"), v).bake;
    EXPECT_EQ(bake.views, bake.lights);
    EXPECT_EQ(bake.views, v.amount);
  }
}

/// The program's own settings are a point of each curve that is worth a default.
TEST(Knobs, PassThroughTheDefaults) {
  for (const Knob& k : all_knobs()) {
    if (k.measure == MeasureKind::transmittance) continue;
    if (k.name.find("-generic") != std::string::npos) continue;
    if (k.name == "bake.angles") continue;  // as many views as lights; views are worth more
    bool there = false;
    Scene own = plain();
    if (k.name.find("satf.") == 0) own.method = Method::satf;
    for (const KnobValue& v : k.values) there |= to_json(set(k, v)) == to_json(own);
    EXPECT_TRUE(there) << k.name;
  }
  const Knob& cells = knob("density-map.cells");
  EXPECT_TRUE(std::any_of(cells.values.begin(), cells.values.end(),
                          [&](const KnobValue& v) { return set(cells, v).shadow == ShadowSettings{}; }));
}

TEST(ShadowKnobs, SwitchOffOneCorrectionEach) {
  for (const Knob& k : shadow_knobs()) {
    EXPECT_EQ(k.measure, MeasureKind::transmittance);
    if (k.name.find("density-map.cells-") != 0) continue;
    Scene other = plain();
    other.method = Method::satf;
    EXPECT_EQ(changed_values(other, with_values(other, k.base)).size(), 2U) << k.name;  // the method and it
  }
}

}  // namespace
}  // namespace pelage
