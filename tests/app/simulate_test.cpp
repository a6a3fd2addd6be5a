// `pelage simulate`, from a groom to pictures, hair files and a call of ffmpeg. Pictures are small, strands few.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "child.h"
#include "pelage/data_schema/strands.h"
#include "pelage/hair/hair_file.h"
#include "pelage/image/image_file.h"

namespace pelage::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

class Simulate : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_.emplace();
    const Result grown = run(
        *folder_, {"groom", "--style", "straight", "--strands", "64", "-o", "@lock.hair", "--head-out", "@head.obj"});
    EXPECT_EQ(grown.code, 0) << grown.err;
  }
  static void TearDownTestSuite() { folder_.reset(); }
  Result simulate(std::vector<std::string> more, std::vector<std::string> environment = {}) const {
    std::vector<std::string> all{"simulate",   "@lock.hair", "--head", "@head.obj",       "--method",
                                 "unshadowed", "--size",     "64x64",  "--supersampling", "1"};
    all.insert(all.end(), more.begin(), more.end());
    return run(*folder_, all, std::move(environment));
  }
  Strands hair(const std::string& file) const { return hair::read_hair(*folder_ / file); }

  static inline std::optional<TemporaryFolder> folder_;  // of all tests: growing takes a second
};

float farthest_apart(const Strands& a, const Strands& b) {
  EXPECT_EQ(a.vertices.size(), b.vertices.size());
  float most = 0;
  for (std::size_t v = 0; v < std::min(a.vertices.size(), b.vertices.size()); ++v) {
    const glm::vec3 d = a.vertices[v] - b.vertices[v];
    most = std::max(most, std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z));
  }
  return most;
}

/// Nothing is drawn: the method does not matter.
TEST_F(Simulate, WithoutPicturesMovesTheStrandsThemselves) {
  const Result r =
      run(*folder_, {"simulate", "@lock.hair", "--preset", "curly", "--hair-out", "@hair", "--seconds", "0.1"});
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(hair("hair/frame_0002.hair").count(), 64U);
}

/// Off is as if there were none, to the bit: wind that is off keeps no strand awake either.
TEST_F(Simulate, WindThatIsOffIsNoWind) {
  const auto frames = [&](std::vector<std::string> more) {
    std::vector<std::string> words{"--motion", "none", "--seconds", "1.5", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return nlohmann::json::parse(simulate(words).out).at("frames");
  };
  const nlohmann::json calm = frames({});
  EXPECT_GT(calm.back().at("asleep"), 0);
  EXPECT_EQ(frames({"--wind", "4,0,1", "--off", "wind"}), calm);
}

/// How far hair moves is told of what is drawn, curls and detail too, whose vertices are not those of the simulation.
TEST_F(Simulate, ExplainsWhatEachEffectMoves) {
  const Result r = simulate({"--preset", "curly", "--vertices", "4", "--seconds", "0.1", "--settle", "0", "--off",
                             "friction", "--explain", "--json"});
  ASSERT_EQ(r.code, 0) << r.err;
  std::map<std::string, nlohmann::json> effects;
  const nlohmann::json ledger = nlohmann::json::parse(r.out).at("effects");
  for (const nlohmann::json& e : ledger) effects[e.at("effect")] = e;
  for (const char* const name : {"detail", "curls"}) {
    EXPECT_TRUE(effects.at(name).at("runs")) << name;
    EXPECT_GT(effects.at(name).at("moves_mm"), 0.1) << name;
  }
  EXPECT_EQ(effects.at("friction").at("asked"), "off");
  EXPECT_FALSE(effects.at("friction").at("runs"));
  EXPECT_TRUE(effects.at("friction").at("called_for"));
  EXPECT_FALSE(effects.at("chains").contains("saves_ms")) << "a pass";
  EXPECT_FALSE(effects.at("wind").contains("moves_mm")) << "nothing to run";
  for (const auto& [name, e] : effects) EXPECT_FALSE(e.at("why").get<std::string>().empty()) << name;
}

TEST_F(Simulate, SaysWhenNothingIsAskedFor) {
  const Result r = simulate({});
  EXPECT_EQ(r.code, 2);
  EXPECT_THAT(r.err, HasSubstr("--hair-out"));
}

TEST_F(Simulate, ABadSceneLeavesNoFolder) {
  const Result r = simulate({"--preset", "curls", "-o", "@frames"});
  EXPECT_EQ(r.code, 2);
  EXPECT_THAT(r.err, HasSubstr("\"curly\""));
  EXPECT_FALSE(fs::exists(*folder_ / "frames"));
}

/// Three frames a second would otherwise be longer than catch_up_s, and the head would cut corners.
TEST_F(Simulate, FrameRateDoesNotChangeTheMotion) {
  for (const char* const fps : {"3", "60"})
    ASSERT_EQ(
        simulate({"--fps", fps, "--hair-out", std::string("@at") + fps, "--seconds", "1.4", "--settle", "0"}).code, 0);
  const float apart = farthest_apart(hair("at3/frame_0003.hair"), hair("at60/frame_0060.hair"));
  EXPECT_LT(apart, 1e-4F);  // rounding of times, grown; tips move 0.1 m
  EXPECT_GT(farthest_apart(hair("at3/frame_0003.hair"), hair("at3/frame_0000.hair")), 0.02F);
}

TEST_F(Simulate, BeginsInTheFirstKeysPose) {
  folder_->write("keys.json", R"({"version": 1, "hair": "lock.hair", "simulation": {"motion": {"kind": "keyframes",
    "keys": [{"time_s": 0, "position_m": [1, 0, 0]}, {"time_s": 1, "position_m": [1, 0, 0]}]}}})");
  ASSERT_EQ(run(*folder_, {"simulate", "@keys.json", "--settle", "0", "--seconds", "0.1", "--hair-out", "@h"}).code, 0);
  const Strands rest = hair("lock.hair"), first = hair("h/frame_0000.hair");
  EXPECT_NEAR(first.vertices[0].x, rest.vertices[0].x + 1, 1e-4F);
  EXPECT_LT(farthest_apart(first, hair("h/frame_0002.hair")), 0.02F);
}

/// A sphere that flies through all of the hair arrives with the first frame, however long hair settles before.
TEST_F(Simulate, MovingCollidersAreWhereTheSceneSaysAtTheFirstFrame) {
  folder_->write("ball.json", R"({"version": 1, "hair": "lock.hair", "simulation": {"motion": {"kind": "none"},
    "life": {"settle_s": 0.5}, "shape": {"hold_rad_s": 0, "sag_free": false},
    "collision": {"capsules": [{"from": [-2, 0, 0], "to": [-2, 0, 0], "radius_m": 0.3, "velocity_m_s": [4, 0, 0]}]}}})");
  const Result r = run(*folder_, {"simulate", "@ball.json", "--seconds", "0.6", "--json"});
  ASSERT_EQ(r.code, 0) << r.err;
  const nlohmann::json frames = nlohmann::json::parse(r.out).at("frames");
  EXPECT_LT(frames[9].at("fastest_m_s").get<float>(), 1.0F);
  EXPECT_GT(frames[17].at("fastest_m_s").get<float>(), 2.0F);
}

TEST_F(Simulate, PicturesShowAllOfTheHair) {
  ASSERT_EQ(run(*folder_, {"groom", "--style", "straight", "--strands", "2000", "-o", "@full.hair"}).code, 0);
  const Result r = run(*folder_, {"simulate", "@full.hair", "--method", "unshadowed", "--size", "64x64", "--motion",
                                  "none", "--seconds", "0.03", "--settle", "0", "-o", "@all"});
  ASSERT_EQ(r.code, 0) << r.err;
  const Image picture = read_image(*folder_ / "all/frame_0000.png");
  float darkest = 1;
  for (int x = 0; x < picture.width; ++x)
    for (const int y : {0, picture.height - 1}) darkest = std::min(darkest, picture.pixel(x, y)[0]);
  EXPECT_GT(darkest, 0.7F) << "hair at the border";
}

TEST_F(Simulate, FfmpegGetsTheFramesOfThisSequenceOnly) {
  folder_->write("ffmpeg",
                 "#!/bin/sh\necho \"$@\" > \"${0%/*}/arguments\"\nfor last; do :; done\necho video > \"$last\"\n");
  fs::permissions(*folder_ / "ffmpeg", fs::perms::owner_all);
  const std::string path = "PATH=" + (*folder_ / "").string() + ":" + std::getenv("PATH");
  ASSERT_EQ(simulate({"-o", "@50%d", "--seconds", "0.2"}).code, 0);
  const Result r = simulate({"-o", "@50%d", "--seconds", "0.1", "--video", "@v.mp4"}, {path});
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_THAT(r.err, HasSubstr("frame_0003.png"));  // of the longer sequence before
  EXPECT_THAT(text_of(*folder_ / "arguments"), AllOf(HasSubstr("-frames:v 3 "), HasSubstr("/50%%d/frame_%04d.png ")));
  EXPECT_EQ(text_of(*folder_ / "v.mp4"), "video\n");
}

TEST_F(Simulate, SaysThatThereIsNoFfmpeg) {
  const Result r = simulate({"-o", "@p", "--video", "@v.mp4"}, {"PATH=/nowhere"});
  EXPECT_EQ(r.code, 2);
  EXPECT_THAT(r.err, HasSubstr("apt install ffmpeg"));
}

/// HARD_CASES 32.
TEST_F(Simulate, InterruptedLeavesWholePictures) {
  std::vector<std::string> all{"simulate", "@lock.hair", "--method", "unshadowed", "--size",    "64x64",
                               "--motion", "dance",      "-o",       "@i",         "--seconds", "1000"};
  const Child child(*folder_, all);
  while (child.is_running() && !fs::exists(*folder_ / "i/frame_0002.png")) usleep(20'000);
  child.signal(SIGINT);
  EXPECT_EQ(child.wait().code, 130);
  for (const auto& entry : fs::directory_iterator(*folder_ / "i")) {
    EXPECT_EQ(entry.path().extension(), ".png");
    EXPECT_EQ(read_image(entry.path()).width, 64);
  }
}

}  // namespace
}  // namespace pelage::test
