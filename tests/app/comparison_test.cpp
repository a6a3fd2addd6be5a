// A comparison's thresholds and files, on numbers made up so that each can be told from the others.
#include "pelage/app/comparison.h"

#include <gmock/gmock.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "pelage/app/compare_thresholds.h"
#include "pelage/app/comparison_files.h"

namespace pelage::app {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

ComparedMethod method(const std::string& id) {
  ComparedMethod m;
  m.id = id;
  m.title = "Title, \"quoted\"";
  m.error.rmse = 0.5;
  m.error.bias = -0.25;
  m.error.rel_mse = 0.125;
  m.error.psnr_db = 30;
  m.error.flip = 0.0625;
  m.error.max = 2;
  m.error.rmse_covered = 0.75;
  m.first_ms = 8;
  m.again_ms = 4;
  m.prepare_ms = 16;
  m.bytes = 1024;
  m.flicker = 0.375;
  return m;
}

Comparison comparison() {
  Comparison c;
  c.scene = R"({"version": 1})";
  c.methods = {method("truth"), method("density-map")};
  c.methods[0].error = {};
  c.methods[0].error.psnr_db = std::numeric_limits<double>::infinity();
  return c;
}

std::vector<std::string> broken(const Comparison& c, const std::string& text) {
  const auto known = known_methods("");
  const std::vector<Threshold> one{parse_threshold(text, known, true)};
  return violations(c, one);
}

TEST(Thresholds, HoldUpToTheValueItself) {
  const Comparison c = comparison();
  for (const char* const held :
       {"rmse=0.5", "bias=0.25", "rel-mse=0.125", "psnr-db=30", "flip=0.0625", "max=2", "ms=8", "flicker=0.375"})
    EXPECT_THAT(broken(c, held), IsEmpty()) << held;
  for (const char* const too_much :
       {"rmse=0.49", "bias=0.24", "rel-mse=0.12", "psnr-db=30.1", "flip=0.06", "max=1.9", "ms=7.9", "flicker=0.37"})
    EXPECT_THAT(broken(c, too_much), ElementsAre(HasSubstr("density-map: "))) << too_much;
  EXPECT_THAT(broken(c, "psnr-db=40"), ElementsAre("density-map: psnr-db is 30, below 40"));
  EXPECT_THAT(broken(c, "rmse=0.1"), ElementsAre("density-map: rmse is 0.5, above 0.1"));
}

TEST(Thresholds, AreForEveryMethodButTheTruthOrForTheOneNamed) {
  Comparison c = comparison();
  c.methods[0].error.rmse = 9;
  EXPECT_THAT(broken(c, "rmse=0.6"), IsEmpty());
  EXPECT_THAT(broken(c, "truth:rmse=0.6"), ElementsAre(HasSubstr("truth: rmse is 9")));
  c.methods.push_back(method("unshadowed"));
  c.methods[2].error.rmse = 0.7;
  EXPECT_THAT(broken(c, "density-map:rmse=0.6"), IsEmpty());
  EXPECT_THAT(broken(c, "rmse=0.6"), ElementsAre(HasSubstr("unshadowed: ")));
}

TEST(Thresholds, OfAnAnimationHoldInEveryFrame) {
  Comparison c = comparison();
  c.fps = 30;
  ComparedMethod& m = c.methods[1];
  m.frames.resize(4, {m.error, 0, 1});
  m.frames[1].error.rmse = 0.7, m.frames[1].error.psnr_db = 40;
  m.frames[2].error.rmse = 0.8, m.frames[2].error.psnr_db = 20;
  EXPECT_THAT(broken(c, "rmse=0.8"), IsEmpty());
  EXPECT_THAT(broken(c, "rmse=0.75"), ElementsAre("density-map: rmse is 0.8 in frame 2, above 0.75"));
  EXPECT_THAT(broken(c, "psnr-db=25"), ElementsAre("density-map: psnr-db is 20 in frame 2, below 25"));
  m.frames[1].error.rmse = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(broken(c, "rmse=1e9").size(), 1U);
}

TEST(Thresholds, AreNotHeldByWhatIsNoNumberOrNoPicture) {
  Comparison c = comparison();
  c.methods[1].error.rmse = c.methods[1].error.psnr_db = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(broken(c, "rmse=1e9").size(), 1U);
  EXPECT_EQ(broken(c, "psnr-db=0").size(), 1U);
  c.methods[1].failed = "no light";
  EXPECT_THAT(broken(c, "max=1e9"), ElementsAre(HasSubstr("there is no picture: no light")));
}

std::vector<std::string> fields_of_line(const std::string& csv, std::size_t number) {
  std::vector<std::string> lines(1), fields(1);
  for (const char c : csv) c == '\n' ? lines.emplace_back() : lines.back() += c;
  bool quoted = false;
  for (const char c : lines.at(number)) {
    if (c == '"') quoted = !quoted;
    if (c == ',' && !quoted)
      fields.emplace_back();
    else if (c != '\r')
      fields.back() += c;
  }
  return fields;
}

TEST(ComparisonFiles, CsvHasEachFigureUnderItsName) {
  Comparison c = comparison();
  c.fps = 30;
  c.methods.push_back(method("deep-opacity"));
  c.methods[2].failed = "two, \"parts\"";
  const std::string csv = comparison_csv(c);
  EXPECT_THAT(csv, HasSubstr(R"("Title, ""quoted""")")) << "[RFC 4180]";
  EXPECT_THAT(csv, HasSubstr("\"two, \"\"parts\"\"\"\r\n"));
  const auto names = fields_of_line(csv, 0), truth = fields_of_line(csv, 1), fields = fields_of_line(csv, 2);
  ASSERT_EQ(fields.size(), names.size());
  EXPECT_EQ(fields_of_line(csv, 3).size(), names.size()) << "nothing but a reason";
  std::map<std::string, std::string> by_name;
  for (std::size_t i = 0; i < names.size(); ++i) by_name[names[i]] = fields[i];
  const std::map<std::string, std::string> wanted{
      {"id", "density-map"}, {"rmse", "0.5"},   {"bias", "-0.25"},        {"rel_mse", "0.125"}, {"psnr_db", "30"},
      {"flip", "0.0625"},    {"max", "2"},      {"rmse_covered", "0.75"}, {"flicker", "0.375"}, {"prepare_ms", "16"},
      {"first_ms", "8"},     {"again_ms", "4"}, {"bytes", "1024"},        {"failed", ""}};
  for (const auto& [name, value] : wanted) EXPECT_EQ(by_name[name], value) << name;
  EXPECT_EQ(truth[static_cast<std::size_t>(std::find(names.begin(), names.end(), "psnr_db") - names.begin())], "inf");
  c.fps = 0;
  EXPECT_EQ(fields_of_line(comparison_csv(c), 2)[9], "") << "a still does not flicker";
}

TEST(ComparisonFiles, JsonHasEachFigureUnderItsName) {
  Comparison c = comparison();
  const auto still = comparison_json(c);
  EXPECT_FALSE(still.contains("fps"));
  EXPECT_FALSE(still.at("methods")[1].contains("frames"));
  EXPECT_TRUE(still.at("methods")[0].at("error").at("psnr_db").is_null());
  c.fps = 24;
  c.flicker_noise = 0.01;
  c.methods[1].frames = {{c.methods[1].error, 0, 5}, {{}, 0.375, 6}};
  c.methods[1].frames[1].error.rmse = 0.875;
  const auto json = comparison_json(c);
  EXPECT_EQ(json.at("fps"), 24);
  EXPECT_EQ(json.at("flicker_noise"), 0.01);
  const auto& m = json.at("methods")[1];
  const std::map<std::string, double> wanted{{"rmse", 0.5},    {"bias", -0.25}, {"rel_mse", 0.125},    {"psnr_db", 30},
                                             {"flip", 0.0625}, {"max", 2},      {"rmse_covered", 0.75}};
  for (const auto& [name, value] : wanted) EXPECT_EQ(m.at("error").at(name), value) << name;
  EXPECT_EQ(m.at("first_ms"), 8);
  EXPECT_EQ(m.at("again_ms"), 4);
  EXPECT_EQ(m.at("flicker"), 0.375);
  EXPECT_EQ(m.at("frames")[1].at("error").at("rmse"), 0.875);
  EXPECT_EQ(m.at("frames")[1].at("ms"), 6);
  EXPECT_THAT(comparison_frames_csv(c), HasSubstr("density-map,1,0.875,"));
  EXPECT_THAT(comparison_frames_csv(c), HasSubstr(",0.375,6\r\n"));
}

}  // namespace
}  // namespace pelage::app
