// `pelage tradeoff` and the goals of `render`, as a user calls them.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "child.h"
#include "pelage/app/measure.h"
#include "pelage/data_schema/scene_values.h"
#include "pelage/hair/groom.h"
#include "pelage/hair/hair_file.h"
#include "pelage/image/image_file.h"
#include "pelage/render/gl_context.h"

namespace pelage::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

class TradeoffVerb : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_.emplace();
    ASSERT_EQ(run(*folder_, {"groom", "--strands", "200", "-o", "@groom.hair", "--head-out", "@head.obj"}).code, 0);
  }
  static void TearDownTestSuite() { folder_.reset(); }
  static Result tradeoff(std::vector<std::string> more) {
    std::vector<std::string> all{"tradeoff", "@groom.hair", "--head",     "@head.obj", "--quick",
                                 "--size",   "48x48",       "--progress", "never"};
    all.insert(all.end(), more.begin(), more.end());
    return run(*folder_, all);
  }
  static inline std::optional<TemporaryFolder> folder_;
};

TEST_F(TradeoffVerb, WritesPageTablesAndPointsThatCommandsShowAlone) {
  const Result r =
      tradeoff({"--only", "strands.order,density-map.threads,simulation.period.correction-1", "-o", "@out"});
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_THAT(r.out, HasSubstr("slope of simulation.period.correction-1"));
  const json t = json::parse(text_of(*folder_ / "out/tradeoff.json"));
  ASSERT_EQ(t["diagrams"].size(), 3U);
  EXPECT_TRUE(fs::exists(*folder_ / "out/index.html"));
  EXPECT_TRUE(fs::exists(*folder_ / "out/tradeoff.csv"));
  EXPECT_FALSE(fs::exists(*folder_ / "out/cache")) << "databases of a sweep go with it";
  for (const json& d : t["diagrams"]) {
    for (const json& row : d["rows"]) {
      EXPECT_EQ(row["failed"], "") << row["id"];
      EXPECT_EQ(row["origin"]["scene_hash"].get<std::string>().size(), 16U);
      EXPECT_GT(row["time"]["median_ms"], 0);
      EXPECT_LE(row["time"]["min_ms"], row["time"]["median_ms"]);
      EXPECT_LE(row["time"]["median_ms"], row["time"]["max_ms"]);
      EXPECT_THAT(row["command"], ::testing::StartsWith("pelage "));
    }
  }
}

TEST_F(TradeoffVerb, SameErrorsAgainWhateverTheThreads) {
  const auto errors_of = [&](const char* jobs, const std::string& out) {
    EXPECT_EQ(tradeoff({"--only", "strands.order,density-map.printed", "-j", jobs, "-o", "@" + out}).code, 0);
    std::string errors;
    const json t = json::parse(text_of(*folder_ / (out + "/tradeoff.json")));
    for (const json& d : t["diagrams"])
      for (const json& row : d["rows"])
        if (row["knob"] != "combined")
          errors += row["id"].get<std::string>() + row["error"].dump() + row["error_bar"].dump() + "\n";
    return errors;
  };
  const std::string one = errors_of("1", "one");
  EXPECT_EQ(one, errors_of("2", "two"));
  EXPECT_THAT(one, HasSubstr("strands.order-sorted"));
}

TEST_F(TradeoffVerb, SaysWhatIsWrong) {
  Result r = tradeoff({"--only", "strands.oder", "-o", "@bad"});
  EXPECT_EQ(r.code, 2);
  EXPECT_THAT(r.err, HasSubstr("strands.order"));
  EXPECT_FALSE(fs::exists(*folder_ / "bad"));
  r = tradeoff({});
  EXPECT_EQ(r.code, 2);
  EXPECT_THAT(r.err, HasSubstr("--out"));
  r = run(*folder_, {"tradeoff", "--list"});
  EXPECT_EQ(r.code, 0);
  EXPECT_THAT(r.out, HasSubstr("density-map.cells"));
}

TEST_F(TradeoffVerb, RenderMeetsAGoalAndPrintsHow) {
  const Result r = run(*folder_, {"render", "@groom.hair", "--head", "@head.obj", "--size", "64x64", "--target-error",
                                  "0.1", "-o", "@goal.png", "--json", "--progress", "never"});
  ASSERT_EQ(r.code, 0) << r.err;
  const json budget = json::parse(r.out)["budget"];
  EXPECT_EQ(budget["met"], true);
  EXPECT_LE(budget["achieved"]["error"], 0.12);
  EXPECT_GT(budget["predicted"]["ms"], 0);
  std::vector<std::string> again{"render", "@groom.hair", "--head", "@head.obj", "--size", "64x64", "-o", "@again.png"};
  for (const json& s : budget["settings"]) again.insert(again.end(), {"--set", s.get<std::string>()});
  ASSERT_EQ(run(*folder_, again).code, 0);
  EXPECT_EQ(read_image(*folder_ / "goal.png").rgba, read_image(*folder_ / "again.png").rgba)
      << "the options that it prints make its picture";
}

TEST_F(TradeoffVerb, RenderSaysThatNothingMeetsAGoal) {
  const Result r = run(*folder_, {"render", "@groom.hair", "--size", "48x48", "--budget-ms", "0.001", "-o", "@fast.png",
                                  "--progress", "never"});
  EXPECT_EQ(r.code, 3);
  EXPECT_THAT(r.out, HasSubstr("nothing meets it"));
  EXPECT_TRUE(fs::exists(*folder_ / "fast.png"));
}

/// Chords miss a curve by the square of their length.
TEST(MeasureCurve, ErrorOfChordsIsOfOrderTwo) {
  const TemporaryFolder folder;
  hair::GroomSettings groom;
  groom.strands = 60;
  hair::write_strands(hair::groom(groom), folder / "groom.hair");
  app::MeasureRequest request;
  request.scene.hair = folder / "groom.hair";
  request.scene.method = Method::truth;  // no OpenGL
  request.scene.image.width = request.scene.image.height = 8;
  request.scene.truth.samples = 1;
  const auto measure = app::measure_curve(request);
  const auto error = [&](int pieces) {
    return measure
        ->measure(with_values(request.scene, std::vector<std::string>{"strands.smoothing=" + std::to_string(pieces)}))
        .error;
  };
  const double one = error(1), two = error(2), four = error(4), eight = error(8);
  EXPECT_GT(one, 0.001);
  EXPECT_GT(one, 2.5 * two) << "of long chords, which also bend to both sides, nearly";
  EXPECT_NEAR(std::log2(two / four), 2, 0.1);
  EXPECT_NEAR(std::log2(four / eight), 2, 0.1);
}

/// The ray-traced picture at n rays per pixel against a truth of other rays: noise that falls as n^-1/2 or, with
/// well-spread rays, faster; and no error that stays.
TEST(MeasurePicture, MoreRaysLeaveLessNoiseAndNoBias) {
  const TemporaryFolder folder;
  hair::GroomSettings groom;
  groom.strands = 300;
  hair::write_strands(hair::groom(groom), folder / "groom.hair");
  app::MeasureRequest request;
  request.quick = true;
  request.scene.hair = folder / "groom.hair";
  request.scene.image.width = request.scene.image.height = 64;
  const auto measure = app::measure_picture(request);
  const auto at = [&](int samples) {
    return measure->measure(with_values(
        request.scene, std::vector<std::string>{"method=truth", "truth.samples=" + std::to_string(samples)}));
  };
  const double few = at(2).error, more = at(32).error;
  const double slope = std::log(more / few) / std::log(16.0);
  EXPECT_LT(slope, -0.4);
  EXPECT_GT(slope, -0.8);
  const app::Measured fine = at(256);
  EXPECT_LT(fine.error, 0.2 * few) << "the truth's own noise is not counted";
  EXPECT_GT(fine.error_bar, 0);
}

}  // namespace
}  // namespace pelage::test
