// `pelage compare`, from a small groom to pictures, JSON, CSV and exit codes.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "child.h"
#include "pelage/data_schema/validate.h"
#include "pelage/image/image_file.h"

namespace pelage::test {
namespace {

using nlohmann::json;
using ::testing::Contains;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

const std::string kStill = R"({"version": 1, "hair": "groom.hair", "bake": {"sectors": 150})";

class Compare : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_.emplace();
    ASSERT_EQ(run(*folder_, {"groom", "--strands", "300", "-o", "@groom.hair", "--head-out", "@head.obj"}).code, 0);
    folder_->write("scene.json", kStill + "}");
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static Result compare(const std::string& input, std::vector<std::string> more,
                        std::vector<std::string> environment = {}) {
    std::vector<std::string> all{"compare", input, "-o", "@out"};
    for (const auto& [option, value] :
         {std::pair("--size", "96x96"), std::pair("--samples", "8"), std::pair("--supersampling", "1"),
          std::pair("--clusters", "20"), std::pair("-j", "2"), std::pair("--progress", "never")})
      if (std::find(more.begin(), more.end(), option) == more.end()) all.insert(all.end(), {option, value});
    all.insert(all.end(), more.begin(), more.end());
    return run(*folder_, all, std::move(environment));
  }
  static json json_of(const Result& r) {
    EXPECT_EQ(r.code, 0) << r.err;
    return json::parse(r.out);
  }
  static std::vector<std::string> lines_of(const std::string& name) {
    std::istringstream in(text_of(*folder_ / name));
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
  }

  /// Of the scene as it is, all methods.
  static const json& whole() {
    static const json comparison = json_of(compare("@scene.json", {"--json"}));
    return comparison;
  }

  static inline std::optional<TemporaryFolder> folder_;
};

/// A line of a CSV file, fields without their quotes.
std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') quoted = !quoted;
    if (c == ',' && !quoted) fields.emplace_back();
    if (c != '"' && c != '\r' && (c != ',' || quoted)) fields.back() += c;
  }
  return fields;
}

std::map<std::string, json> rows_of(const json& comparison) {
  std::map<std::string, json> rows;
  for (const json& m : comparison.at("methods")) rows[m.at("id")] = m;
  return rows;
}

TEST_F(Compare, DrawsAndMeasuresEveryMethod) {
  const json& c = whole();
  EXPECT_EQ(c, json::parse(text_of(*folder_ / "out/comparison.json")));
  EXPECT_NO_THROW(validate(c.at("scene"), "scene", "comparison.json"));
  EXPECT_EQ(c.at("truth_samples"), 8);
  EXPECT_GT(c.at("truth_noise").at("rmse"), 0.001);
  ASSERT_EQ(c.at("methods").size(), 13U);
  EXPECT_EQ(c.at("methods").at(0).at("id"), "truth");
  for (const json& m : c.at("methods")) {
    SCOPED_TRACE(m.at("id").get<std::string>());
    ASSERT_FALSE(m.contains("failed")) << m.at("failed");
    const bool truth = m.at("id") == "truth";
    EXPECT_EQ(m.at("error").at("rmse") == 0, truth);
    EXPECT_EQ(m.at("error").at("psnr_db").is_null(), truth);
    EXPECT_LT(m.at("error").at("rmse"), 0.1);
    EXPECT_GT(m.at("first_ms"), 0);
    EXPECT_GT(m.at("again_ms"), 0);
    for (const char* const picture : {"picture", "error_map", "flip_map"})
      EXPECT_EQ(read_image(*folder_ / ("out/" + m.at(picture).get<std::string>())).width, 96);
    EXPECT_EQ(read_image(*folder_ / ("out/" + m.at("id").get<std::string>() + ".exr")).height, 96);
  }
  EXPECT_THAT(text_of(*folder_ / "out/index.html"), HasSubstr("<html"));

  const std::vector<std::string> lines = lines_of("out/comparison.csv");
  ASSERT_EQ(lines.size(), 14U);
  for (const std::string& line : lines) EXPECT_EQ(fields_of(line).size(), fields_of(lines[0]).size()) << line;
  EXPECT_EQ(fields_of(lines[3])[1], "SATF, adapted records");
  EXPECT_DOUBLE_EQ(std::stod(fields_of(lines[3])[2]), c.at("methods").at(2).at("error").at("rmse").get<double>());
}

/// A density map that casts no shadow, and nothing but its own row is another; what this test could not see, the same
/// row being wrong in both, is for the methods' own tests.
TEST_F(Compare, AMistakeShowsInItsRowAndNowhereElse) {
  folder_->write("mistake.json", kStill + R"(, "shadow": {"density_map": {"factor": 0}}})");
  const auto right = rows_of(whole());
  const auto wrong = rows_of(json_of(compare("@mistake.json", {"--json"})));
  ASSERT_EQ(right.size(), wrong.size());
  for (const auto& [id, row] : right) {
    const bool has_the_map = id == "density-map" || id == "density-map-mean";
    EXPECT_EQ(row.at("error") == wrong.at(id).at("error"), !has_the_map) << id;
  }
  EXPECT_EQ(wrong.at("density-map").at("error"), right.at("unshadowed").at("error"));
}

/// The truth's fibres are brighter towards the light; strands that are not have an error that is no matter of shadows.
TEST_F(Compare, LightAroundFibresBringsStrandsNearerToTheTruth) {
  const auto rows =
      rows_of(json_of(compare("@groom.hair", {"--json", "--head", "@head.obj", "--samples", "256", "--supersampling",
                                              "4", "--methods", "density-map,density-map-mean,unshadowed"})));
  const auto error = [&](const char* id, const char* metric) {
    return std::abs(rows.at(id).at("error").at(metric).get<double>());
  };
  // Measured: RMSE .57, FLIP .27, bias .04 of what they are without.
  EXPECT_LT(error("density-map", "rmse"), 0.75 * error("density-map-mean", "rmse"));
  EXPECT_LT(error("density-map", "flip"), 0.5 * error("density-map-mean", "flip"));
  EXPECT_LT(error("density-map", "bias"), 0.3 * error("density-map-mean", "bias"));
  EXPECT_LT(error("density-map", "rmse"), 0.75 * error("unshadowed", "rmse"));
}

TEST_F(Compare, ThresholdsDecideTheExitCode) {
  const std::vector<std::string> two{"--methods", "density-map,unshadowed"};
  const auto with = [&](std::vector<std::string> thresholds) {
    std::vector<std::string> all = two;
    for (const std::string& t : thresholds) all.insert(all.end(), {"--threshold", t});
    return compare("@scene.json", all);
  };
  EXPECT_EQ(with({"rmse=0.5", "density-map:psnr-db=5"}).code, 0);
  fs::remove(*folder_ / "out/comparison.csv");
  const Result above = with({"rmse=0", "unshadowed:psnr-db=200", "bias=1"});
  EXPECT_EQ(above.code, 3);
  EXPECT_THAT(above.err, HasSubstr("density-map: rmse is "));
  EXPECT_THAT(above.err, HasSubstr("unshadowed: psnr-db is "));
  EXPECT_THAT(above.err, testing::Not(HasSubstr("bias")));
  EXPECT_TRUE(fs::exists(*folder_ / "out/comparison.csv"));
  EXPECT_THAT(with({"rsme=1"}).err, HasSubstr("nearest is rmse"));
  EXPECT_THAT(with({"unshadwed:rmse=1"}).err, HasSubstr("nearest is unshadowed"));
  EXPECT_EQ(with({"rmse=nan"}).code, 2);
  EXPECT_EQ(with({"rmse"}).code, 2);
  EXPECT_THAT(with({"flicker=1"}).err, HasSubstr("--frames"));
}

TEST_F(Compare, RefusesWhatMakesNoSense) {
  const Result unknown = compare("@scene.json", {"--methods", "satf-adaptd"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("nearest is satf-adapted"));
  EXPECT_THAT(compare("@scene.json", {"--method", "satf"}).err, HasSubstr("--methods"));
  EXPECT_THAT(compare("@scene.json", {"--motion", "nod"}).err, HasSubstr("--frames"));
  EXPECT_EQ(compare("@missing.json", {}).code, 4);
  EXPECT_EQ(run(*folder_, {"compare", "@scene.json", "-o", "@no/such/folder"}).code, 1);
}

/// Opacity maps have no point lights.
TEST_F(Compare, AMethodThatFailsIsARow) {
  const Result r = compare("@scene.json", {"--methods", "deep-opacity,unshadowed", "--point-light", "0.5,0.5,1,1",
                                           "--threshold", "rmse=0.5"});
  EXPECT_EQ(r.code, 3) << "a threshold that cannot be held is not";
  const auto rows = rows_of(json::parse(text_of(*folder_ / "out/comparison.json")));
  EXPECT_THAT(rows.at("deep-opacity").at("failed"), HasSubstr("directional lights"));
  EXPECT_FALSE(rows.at("deep-opacity").contains("error"));
  EXPECT_GT(rows.at("unshadowed").at("error").at("rmse"), 0);
  const auto fields = fields_of(lines_of("out/comparison.csv")[2]);
  EXPECT_EQ(fields[2], "");
  EXPECT_EQ(fields.back(), rows.at("deep-opacity").at("failed"));
}

/// The command of a row draws the row's picture.
TEST_F(Compare, RowsSayHowTheyAreDrawn) {
  const auto rows = rows_of(json_of(compare(
      "@scene.json", {"--json", "--methods", "satf-paper-shadow,density-map-printed", "--light=-0.5,0.5,0.5"})));
  for (const char* const id : {"satf-paper-shadow", "density-map-printed"}) {
    std::istringstream in(rows.at(id).at("command").get<std::string>());
    std::vector<std::string> words;
    for (std::string word; in >> word;) words.push_back(word);
    ASSERT_EQ(words.at(0), "pelage");
    words.erase(words.begin());
    words.back() = "@again.png";
    const Result r = run(*folder_, words);
    ASSERT_EQ(r.code, 0) << r.err << rows.at(id).at("command");
    EXPECT_EQ(read_image(*folder_ / "again.png").rgba,
              read_image(*folder_ / ("out/" + rows.at(id).at("picture").get<std::string>())).rgba)
        << id;
  }
}

/// Strands drawn as curves are compared with a truth of these curves.
TEST_F(Compare, TheTruthIsOfTheSameCurves) {
  ASSERT_EQ(
      run(*folder_, {"groom", "--style", "curly", "--strands", "50", "--vertices", "14", "-o", "@curls.hair"}).code, 0);
  const auto truth = [](const std::vector<std::string>& more) {
    std::vector<std::string> words{"render", "@curls.hair", "--method", "truth",
                                   "--size", "64x64",       "--camera", "0.5,0,0.8,0,-0.05,0,30",
                                   "-o",     "@truth.exr"};
    words.insert(words.end(), more.begin(), more.end());
    const Result r = run(*folder_, words);
    EXPECT_EQ(r.code, 0) << r.err;
    return read_image(*folder_ / "truth.exr").rgba;
  };
  const auto segments = truth({}), curves = truth({"--smoothing", "8"});
  EXPECT_NE(curves, segments);
  EXPECT_EQ(truth({"--smoothing", "8", "--off", "smoothing"}), segments);
}

TEST_F(Compare, RowsGiveTheDrawingOrderWhereItIsTheirs) {
  const auto rows = rows_of(json_of(compare("@groom.hair", {"--json", "--methods", "satf-adapted,unshadowed",
                                                            "--bake-sectors", "150", "--order", "clusters"})));
  EXPECT_THAT(rows.at("satf-adapted").at("command"), HasSubstr("--order clusters"));
  EXPECT_THAT(rows.at("unshadowed").at("command"), testing::Not(HasSubstr("--order")));
  const auto of_strands = rows_of(
      json_of(compare("@scene.json", {"--json", "--methods", "satf-adapted,unshadowed", "--order", "weighted"})));
  EXPECT_THAT(of_strands.at("satf-adapted").at("command"), testing::Not(HasSubstr("--order")));
  EXPECT_THAT(of_strands.at("unshadowed").at("command"), HasSubstr("--order weighted"));
}

TEST_F(Compare, AnimatedComparesEveryFrame) {
  const std::vector<std::string> words{
      "--methods", "satf-adapted,density-map", "--frames", "2", "--settle", "0.1", "--head", "@head.obj"};
  std::vector<std::string> as_json = words;
  as_json.emplace_back("--json");
  const json c = json_of(compare("@scene.json", as_json));
  EXPECT_GT(c.at("flicker_noise"), 0);
  for (const auto& [id, row] : rows_of(c)) {
    ASSERT_EQ(row.at("frames").size(), 2U);
    EXPECT_EQ(row["frames"][0]["error"], row["error"]);
    EXPECT_EQ(row["frames"][0]["flicker"], 0);
    EXPECT_EQ(row["frames"][1]["flicker"], row["flicker"]);
    EXPECT_EQ(row["flicker"] == 0, id == "truth");
  }
  EXPECT_EQ(lines_of("out/comparison-frames.csv").size(), 7U);
  // A threshold holds in all frames: this one lies between the two.
  const json row = rows_of(c).at("density-map");
  const double first = row["frames"][0]["error"]["rmse"], second = row["frames"][1]["error"]["rmse"];
  std::vector<std::string> limited = words;
  limited.insert(limited.end(), {"--threshold", "density-map:rmse=" + std::to_string((first + second) / 2)});
  EXPECT_EQ(compare("@scene.json", limited).code, 3) << first << " " << second;
}

/// Of hair that moves far: figures of one frame against another's truth, and changes the wrong way round, are larger
/// than any method's error.
TEST_F(Compare, FramesAreComparedWithTheirOwnTruth) {
  const json c = json_of(compare("@scene.json", {"--json", "--methods", "density-map", "--frames", "3", "--fps", "5",
                                                 "--settle", "0.1", "--motion", "shake", "--size", "64x64"}));
  const json row = rows_of(c).at("density-map");
  const double first = row["frames"][0]["error"]["rmse"];
  for (const json& frame : row["frames"]) {
    EXPECT_LT(frame.at("error").at("rmse"), 1.3 * first);
    EXPECT_LT(frame.at("flicker"), 1.5 * first);
  }
  EXPECT_NE(row["frames"][1]["error"], row["frames"][0]["error"]);
}

/// Without what clocks say.
json timeless(json c) {
  for (const char* const key : {"command", "threads"}) c.erase(key);
  for (json& m : c.at("methods")) {
    for (const char* const key : {"prepare_ms", "first_ms", "again_ms"}) m.erase(key);
    for (json& stage : m.at("stages")) stage.erase("ms");
  }
  return c;
}

TEST_F(Compare, IsTheSameForAnyNumberOfThreadsAndEveryTime) {
  json first;
  std::map<std::string, std::vector<float>> pictures;
  for (const char* const threads : {"1", "1", "2", "3"}) {
    const json c = json_of(compare("@scene.json", {"--json", "--methods", "satf-adapted,density-map,deep-opacity", "-j",
                                                   threads, "--size", "40x40", "--samples", "7"}));
    EXPECT_EQ(c.at("truth_samples"), 8) << "halves are of one size";
    if (first.is_null()) first = timeless(c);
    EXPECT_EQ(timeless(c), first) << threads << " threads";
    for (const json& m : c.at("methods"))
      for (const char* const suffix : {".png", ".exr", "-error.png", "-flip.png"}) {
        const std::string name = m.at("id").get<std::string>() + suffix;
        const auto known = pictures.emplace(name, read_image(*folder_ / ("out/" + name)).rgba).first;
        EXPECT_EQ(known->second, read_image(*folder_ / ("out/" + name)).rgba) << name << ", " << threads;
      }
  }
  EXPECT_EQ(pictures.size(), 16U);
}

TEST_F(Compare, CtrlCLeavesTheEarlierComparison) {
  ASSERT_EQ(compare("@scene.json", {"--methods", "unshadowed"}).code, 0);
  const std::string before = text_of(*folder_ / "out/comparison.json");
  const Child child(*folder_, {"compare", "@scene.json", "-o", "@out", "--size", "900x900", "--samples", "4096"});
  while (child.is_running() && child.err().find("tracing") == std::string::npos) usleep(100'000);
  child.signal(SIGINT);
  EXPECT_EQ(child.wait().code, 130);
  EXPECT_EQ(text_of(*folder_ / "out/comparison.json"), before);
  for (const auto& entry : fs::directory_iterator(*folder_ / "out"))
    EXPECT_TRUE(entry.is_regular_file()) << entry.path();
}

}  // namespace
}  // namespace pelage::test
