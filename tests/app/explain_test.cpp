// `--explain`: the ledger says what ran, what it took and what would be lost, and says it again; effects switched on
// the command line are those of a scene file.
#include "pelage/app/explain.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "../render/strands.h"
#include "../simulate/moving.h"
#include "child.h"
#include "pelage/app/clip.h"
#include "pelage/app/explain_motion.h"
#include "pelage/image/image_file.h"

namespace pelage::app {
namespace {

using nlohmann::json;
using test::Result;
using test::TemporaryFolder;
using ::testing::HasSubstr;

const LedgerLine& row(const std::vector<LedgerLine>& ledger, const std::string& name) {
  for (const LedgerLine& line : ledger)
    if (line.name == name) return line;
  throw std::out_of_range(name);
}

TEST(Ledger, SavingsAreTheLeastTimesAndAreThoseOfTheEffectWhicheverWayItWasSwitched) {
  LedgerLine line;
  line.runs = true;
  set_savings(line, {12, 10}, {7, 4});  // with it, without it
  EXPECT_EQ(line.saves_ms, 6);
  EXPECT_EQ(line.spread_ms, 3);
  line.runs = false;
  set_savings(line, {7, 4}, {12, 10});
  EXPECT_EQ(line.saves_ms, 6);
  EXPECT_EQ(line.spread_ms, 3);
}

TEST(Ledger, ChargesWhatStagesOfItsOwnTook) {
  Effect effect;
  effect.stages = {"fill", "filter"};
  LedgerLine line;
  charge(line, effect, {{"fill", 2, 100, 3}, {"draw", 50, 1000, 1}, {"filter", 0.5, 10, 1}, {"fill", 0, 7, 0}});
  EXPECT_EQ(line.ms, 2.5);
  EXPECT_EQ(line.bytes, 110U);  // a stage that did not run in this frame still holds the bytes of another
  EXPECT_EQ(line.calls, 4U);
}

TEST(Ledger, DifferencesAreOfColoursOnly) {
  Image a(2, 1), b(2, 1);
  b.rgba = {0.3F, 0, 0, 1, 0, 0.4F, 0, 0};
  EXPECT_NEAR(rms_difference(a, b), std::sqrt((0.09 + 0.16) / 6), 1e-8);
  EXPECT_EQ(rms_difference({}, {}), 0);
}

class Explained : public test::WithOpenGl {
 protected:
  void SetUp() override {
    WithOpenGl::SetUp();
    if (IsSkipped()) return;
    scene_.method = Method::density_map;
    scene_.shadow.density_map.resolution = 32;
    scene_.lights.push_back({{-1, 0.5F, 0.2F}, {}, {1, 0.8F, 0.5F}, 0.6F});
    scene_.image.width = scene_.image.height = 48;
    scene_.image.supersampling = 1;
    scene_.image.exposure = 1.5F;
    scene_.image.background = glm::vec3(0.85F);
    drawing_ = make_strand_drawing(scene_.method, {"lock", test::strand_lock(100), 0.6F}, test::wall());
  }
  std::vector<LedgerLine> explain() { return explain_picture(*drawing_, scene_, camera_); }
  Image seen(const Scene& scene) {
    Image image = drawing_->render(scene, camera_);
    expose(image, scene.image.exposure);
    compose_over(image, scene.image.background);
    return image;
  }

  Scene scene_;
  Camera camera_{{0, 0, 0.6F}, {0, 0, 0}};
  std::unique_ptr<Drawing> drawing_;
};

TEST_F(Explained, EveryEffectIsARowWithTheCallsOfOneFrame) {
  for (int k = 0; k < 3; ++k) drawing_->render(scene_, camera_);  // calls of other frames are not the frame's
  const std::vector<LedgerLine> ledger = explain();
  const std::vector<Effect> effects = picture_effects(scene_);
  ASSERT_EQ(ledger.size(), effects.size());
  drawing_->render(scene_, camera_);
  drawing_->refresh();
  std::map<std::string, std::uint64_t> calls;
  for (const Stage& s : drawing_->ledger().stages()) calls[s.name] = -s.calls;
  drawing_->render(scene_, camera_);
  for (const Stage& s : drawing_->ledger().stages()) calls[s.name] += s.calls;
  for (std::size_t i = 0; i < effects.size(); ++i) {
    std::uint64_t of_stages = 0;
    for (const std::string& stage : effects[i].stages) of_stages += calls[stage];
    EXPECT_EQ(ledger[i].name, effects[i].name);
    EXPECT_EQ(ledger[i].calls, of_stages) << ledger[i].name;
    EXPECT_EQ(ledger[i].calls > 0, ledger[i].ms > 0) << ledger[i].name;
    EXPECT_NE(ledger[i].why, "") << ledger[i].name;
  }
  EXPECT_EQ(row(ledger, "shadow-map").calls, 4U) << "filled and summed once for each light";
  EXPECT_EQ(row(ledger, "geometry").calls, 2U);
}

TEST_F(Explained, WhatIsLostIsTheDifferenceOfTheTwoPictures) {
  const std::vector<LedgerLine> ledger = explain();
  for (const char* const name : {"self-shadow", "shadow-filter", "diffuse", "secondary-highlight", "ambient"}) {
    Scene without = scene_;
    without.effects[name] = EffectState::off;
    const double lost = rms_difference(seen(scene_), seen(without));
    EXPECT_EQ(row(ledger, name).rmse, lost) << name;
    EXPECT_GT(lost, 1e-4) << name;
  }
}

TEST_F(Explained, WhatIsOffDoesNotRunAndSaysWhatItWouldAdd) {
  const std::vector<LedgerLine> with = explain();
  scene_.effects["self-shadow"] = EffectState::off;
  const std::vector<LedgerLine> without = explain();
  const LedgerLine& off = row(without, "self-shadow");
  EXPECT_EQ(off.asked, EffectState::off);
  EXPECT_FALSE(off.runs);
  EXPECT_TRUE(off.called_for);
  EXPECT_EQ(off.calls, 0U);
  EXPECT_EQ(off.bytes, 0U);
  EXPECT_EQ(off.ms, 0);
  EXPECT_EQ(off.rmse, row(with, "self-shadow").rmse);
  EXPECT_TRUE(off.saves_ms);
  EXPECT_FALSE(row(without, "shadow-map").runs);
  EXPECT_EQ(row(without, "shadow-map").calls, 0U);
  EXPECT_EQ(row(without, "shadow-map").why, "nothing that runs needs it");
}

TEST_F(Explained, WhatHasNothingToRunIsNotCompared) {
  scene_.material.secondary = 0;
  const std::vector<LedgerLine> ledger = explain();
  EXPECT_FALSE(row(ledger, "secondary-highlight").runs);
  EXPECT_FALSE(row(ledger, "secondary-highlight").rmse);
  EXPECT_FALSE(row(ledger, "secondary-highlight").saves_ms);
  EXPECT_EQ(row(ledger, "secondary-highlight").why, "the material has none");
  for (const LedgerLine& line : ledger) EXPECT_TRUE(!line.pass || !line.rmse) << line.name;
}

TEST_F(Explained, SwitchingWhatNothingTakesChangesNothing) {
  drawing_ = make_strand_drawing(scene_.method, {"lock", test::strand_lock(100), 0.6F}, {});
  for (const char* const lobe : {"diffuse", "primary-highlight", "secondary-highlight"})
    scene_.effects[lobe] = EffectState::off;
  const std::vector<LedgerLine> ledger = explain();
  EXPECT_FALSE(row(ledger, "self-shadow").runs);
  EXPECT_EQ(row(ledger, "self-shadow").rmse, 0);
  EXPECT_EQ(row(ledger, "self-shadow").saves_ms, 0);
  EXPECT_GT(*row(ledger, "ambient").rmse, 0);
}

class ExplainedMotion : public ::testing::Test {
 protected:
  std::vector<LedgerLine> explain() const { return explain_motion(subject_, scene_, 30, 0.1, nullptr, {}); }
  Strands hair_at_the_end(const SimulationSettings& settings) const {
    Clip clip(subject_.hair.strands, subject_.head, settings, 30, 0.1);
    clip.begin();
    for (int k = 0; k < clip.frames(); ++k) clip.advance(k);
    return clip.hair().hair();
  }
  static Scene small() {
    Scene s;
    s.simulation = simulation_preset("loose");
    s.simulation.life.settle_s = 0.05;
    return s;
  }

  Subject subject_{{"ball", ball_of_hair(40, 8), 0.6F}, {}};
  Scene scene_ = small();
};

TEST_F(ExplainedMotion, EveryEffectIsARowWithTheCallsOfTheSequence) {
  const std::vector<LedgerLine> ledger = explain();
  const std::vector<Effect> effects = motion_effects(scene_);
  ASSERT_EQ(ledger.size(), effects.size());
  for (std::size_t i = 0; i < effects.size(); ++i) EXPECT_EQ(ledger[i].name, effects[i].name);
  // Three frames at 30 per second; the first does not move anything.
  const auto steps = static_cast<std::uint64_t>(std::lround(2.0 / 30 / scene_.simulation.life.step_s));
  EXPECT_EQ(row(ledger, "chains").calls, steps);
  EXPECT_EQ(row(ledger, "voxel-grid").calls, steps);
  EXPECT_EQ(row(ledger, "strands").calls, 3U);
  for (const char* const pass : {"chains", "voxel-grid", "strands"}) {
    EXPECT_GT(row(ledger, pass).ms, 0) << pass;
    EXPECT_GT(row(ledger, pass).bytes, 0U) << pass;
  }
}

TEST_F(ExplainedMotion, WhatIsLostIsTheDistanceOfTheDrawnHair) {
  const std::vector<LedgerLine> ledger = explain();
  for (const char* const name : {"friction", "damping"}) {
    Scene without = scene_;
    without.effects[name] = EffectState::off;
    const HairFacts facts{&subject_.hair.strands, nullptr, &subject_.head, 0.6F};
    const Strands a = hair_at_the_end(plan_effects(scene_, facts, Task::motion).scene.simulation),
                  b = hair_at_the_end(plan_effects(without, facts, Task::motion).scene.simulation);
    double squares = 0;
    for (std::size_t v = 0; v < a.vertices.size(); ++v) {
      const glm::dvec3 d = glm::dvec3(a.vertices[v]) - glm::dvec3(b.vertices[v]);
      squares += d.x * d.x + d.y * d.y + d.z * d.z;
    }
    const double mm = 1000 * std::sqrt(squares / static_cast<double>(a.vertices.size()));
    EXPECT_GT(mm, 1e-4) << name;
    ASSERT_TRUE(row(ledger, name).moves_mm) << name;
    EXPECT_NEAR(*row(ledger, name).moves_mm, mm, 1e-7 * mm) << name << ": of distances in float";
    EXPECT_FALSE(row(ledger, name).rmse) << "no picture was asked for";
  }
}

TEST_F(ExplainedMotion, WhatIsOffIsNotCalled) {
  scene_.simulation.wind.velocity_m_s = {3, 0, 0};  // wind that nothing shelters from is applied without a grid
  scene_.simulation.wind.shelter = 0;
  const std::vector<LedgerLine> with = explain();
  for (const char* const name : {"friction", "repulsion"}) scene_.effects[name] = EffectState::off;
  const std::vector<LedgerLine> ledger = explain();
  EXPECT_EQ(row(ledger, "chains").bytes, row(with, "chains").bytes);
  EXPECT_FALSE(row(ledger, "voxel-grid").runs);
  EXPECT_EQ(row(ledger, "voxel-grid").calls, 0U);
  EXPECT_EQ(row(ledger, "voxel-grid").bytes, 0U);
  EXPECT_FALSE(row(ledger, "friction").runs);
  EXPECT_GT(*row(ledger, "friction").moves_mm, 0) << "against the same with it";
}

TEST_F(ExplainedMotion, HairAsleepCallsForNothingFrameAfterFrame) {
  scene_.simulation.chain.gravity = glm::vec3(0);
  scene_.simulation.motion.kind = MotionKind::none;
  scene_.simulation.life.sleep_m_s = 0.01F;
  scene_.simulation.life.sleep_after_s = 0.02F;
  for (const char* const name : {"friction", "repulsion"}) scene_.effects[name] = EffectState::off;
  const std::vector<LedgerLine> ledger = explain();
  EXPECT_EQ(row(ledger, "chains").calls, 0U);
  EXPECT_EQ(row(ledger, "strands").calls, 1U) << "made once, for the first frame";
}

/// `pelage` on a small groom.
class Explain : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_.emplace();
    ASSERT_EQ(run(*folder_, {"groom", "--strands", "120", "-o", "@g.hair"}).code, 0);
  }
  static void TearDownTestSuite() { folder_.reset(); }
  static Result render(std::vector<std::string> more, const std::string& input = "@g.hair") {
    std::vector<std::string> all{"render", input,       "--size", "40x40",  "--supersampling", "1",
                                 "--off",  "smoothing", "-o",     "@a.png", "--progress",      "never"};
    if (input == "@g.hair") all.insert(all.end(), {"--method", "density-map", "--shadow-resolution", "24"});
    all.insert(all.end(), more.begin(), more.end());
    return run(*folder_, all);
  }
  static std::map<std::string, json> rows_of(const Result& r) {
    EXPECT_EQ(r.code, 0) << r.err;
    std::map<std::string, json> rows;
    const json answer = json::parse(r.out);
    for (const json& effect : answer.at("effects")) rows[effect.at("effect")] = effect;
    return rows;
  }
  static std::vector<float> picture() { return read_image(*folder_ / "a.png").rgba; }

  static inline std::optional<TemporaryFolder> folder_;
};

/// What clocks say is another's each time.
void forget_times(std::map<std::string, json>& rows) {
  for (auto& [name, each] : rows)
    for (const char* const time : {"ms", "saves_ms", "spread_ms"}) each.erase(time);
}

TEST_F(Explain, PrintsEveryEffectOfTheScene) {
  const Result json_result = render({"--explain", "--json", "--off", "self-shadow"});
  if (json_result.code == 5) GTEST_SKIP() << json_result.err;
  const auto rows = rows_of(json_result);
  Scene scene;
  scene.method = Method::density_map;
  std::vector<std::string> names;
  for (const Effect& e : picture_effects(scene)) names.push_back(e.name);
  ASSERT_EQ(rows.size(), names.size());
  for (const std::string& name : names) {
    ASSERT_TRUE(rows.contains(name)) << name;
    EXPECT_NE(rows.at(name).at("why"), "") << name;
  }
  const json& off = rows.at("self-shadow");
  EXPECT_EQ(off.at("asked"), "off");
  EXPECT_EQ(off.at("runs"), false);
  EXPECT_EQ(off.at("called_for"), true);
  EXPECT_EQ(off.at("calls"), 0);
  EXPECT_EQ(off.at("bytes"), 0);
  EXPECT_GT(off.at("rmse"), 1e-4);
  EXPECT_EQ(rows.at("diffuse").at("asked"), "auto");
  EXPECT_EQ(rows.at("draw").at("pass"), true);
  const Result table = render({"--explain"});
  for (const std::string& name : names) EXPECT_THAT(table.out, HasSubstr("\n" + name + " ")) << table.out;
  EXPECT_THAT(table.out, HasSubstr("needed by self-shadow\n"));
}

TEST_F(Explain, SaysTheSameForAnyNumberOfThreadsAndEveryTime) {
  std::map<std::string, json> first;
  std::vector<float> first_picture;
  for (const char* const threads : {"1", "1", "2", "3"}) {
    const Result r = render({"--explain", "--json", "-j", threads});
    if (r.code == 5) GTEST_SKIP() << r.err;
    auto rows = rows_of(r);
    forget_times(rows);
    if (first.empty()) first = rows, first_picture = picture();
    EXPECT_EQ(rows, first) << threads << " threads";
    EXPECT_EQ(picture(), first_picture) << threads << " threads";
  }
}

TEST_F(Explain, SimulatePrintsEveryEffectOfTheMotionAndTheSameForAnyThreads) {
  std::map<std::string, json> first;
  for (const char* const threads : {"1", "1", "3"}) {
    const Result r =
        run(*folder_, {"simulate",  "@g.hair", "--preset", "wavy",  "--explain",  "--json",  "--off",    "damping",
                       "--seconds", "0.07",    "--settle", "0.03",  "-o",         "@frames", "--method", "unshadowed",
                       "--size",    "32x32",   "-j",       threads, "--progress", "never"});
    if (r.code == 5) GTEST_SKIP() << r.err;
    auto rows = rows_of(r);
    forget_times(rows);
    if (first.empty()) first = rows;
    EXPECT_EQ(rows, first) << threads << " threads";
  }
  EXPECT_EQ(first.size(), motion_effects(Scene{}).size());
  EXPECT_EQ(first.at("damping").at("runs"), false);
  EXPECT_GT(first.at("damping").at("moves_mm"), 0);
  EXPECT_GT(first.at("damping").at("rmse"), 0) << "of the last frame's picture";
  EXPECT_GT(first.at("chains").at("calls"), 0);
}

TEST_F(Explain, SwitchesOnTheCommandLineAreThoseOfAScene) {
  const std::string scene = R"({"version": 1, "hair": "g.hair", "method": "density-map",
    "shadow": {"density_map": {"resolution": 24}, "opacity_map": {"resolution": 24}}, "effects": )";
  const std::vector<std::pair<std::vector<std::string>, std::string>> same{
      {{"--off", "self-shadow"}, R"({"self-shadow": "off"})"},
      {{"--off", "diffuse", "secondary-highlight"}, R"({"diffuse": "off", "secondary-highlight": "off"})"},
      {{"--on", "secondary-highlight", "--off", "ambient"}, R"({"secondary-highlight": "on", "ambient": "off"})"},
      {{"--auto", "diffuse"}, R"({"diffuse": "auto"})"}};
  std::vector<std::vector<float>> pictures;
  for (const auto& [options, effects] : same) {
    const Result r = render(options);
    if (r.code == 5) GTEST_SKIP() << r.err;
    ASSERT_EQ(r.code, 0) << r.err;
    const std::vector<float> by_options = picture();
    folder_->write("s.json", scene + effects + "}");
    const Result by_scene = render({}, "@s.json");
    ASSERT_EQ(by_scene.code, 0) << by_scene.err;
    EXPECT_EQ(by_options, picture()) << effects;
    for (const auto& other : pictures) EXPECT_NE(other, by_options) << effects << " does nothing";
    pictures.push_back(by_options);
  }
  // The command line wins over the scene, a name over "all".
  folder_->write("s.json", scene + R"({"self-shadow": "off"}})");
  ASSERT_EQ(render({"--auto", "self-shadow"}, "@s.json").code, 0);
  EXPECT_EQ(picture(), pictures.back());
  ASSERT_EQ(render({"--on", "all", "--off", "self-shadow"}).code, 0);
  EXPECT_EQ(picture(), pictures.front());
}

}  // namespace
}  // namespace pelage::app
