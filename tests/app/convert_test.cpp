// pelage convert as a user runs it: what it prints, what it refuses, and that a failed run leaves the earlier output.
// And info and groom of hair files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "child.h"

namespace pelage::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const char* const kTwoStrands =
    "v 0 0 0 1 0.5 0\nv 0 0.1 0 1 0.5 0\nl 1 2\nv 1 0 0 0 0 0\nv 1 0.1 0 0 0 0\nv 1 0.2 0 0 0 0\nl 3 4 5\n"
    "v nan 0 0 0 0 0\nv 0 0 0 0 0 0\nl 6 7\nv 2 0 0 0 0 0\nv 2 0 0 0 0 0\nv 2 0.1 0 0 0 0\nl 8 9 10\n";

TEST(Convert, SaysWhatWasRepairedDroppedAndLost) {
  const TemporaryFolder folder;
  folder.write("a.obj", kTwoStrands);
  const Result text = run(folder, {"convert", "@a.obj", "@a.data"});
  EXPECT_EQ(text.code, 0) << text.err;
  for (const char* part : {"OBJ polylines -> ", "USC .data", "3 of 4 strands, 7 vertices; 1 dropped, 1 repaired",
                           "strand 2 dropped", "strand 3 repaired", "lost: colour"})
    EXPECT_THAT(text.out, HasSubstr(part));

  const Result json = run(folder, {"convert", "@a.obj", "@a.usda", "--json"});
  ASSERT_EQ(json.code, 0) << json.err;
  const nlohmann::json parsed = nlohmann::json::parse(json.out);
  EXPECT_EQ(parsed["output_format"], "USD text");
  EXPECT_EQ(parsed["strands"], 3);
  EXPECT_EQ(parsed["issues"][0]["strand"], 2);
  EXPECT_TRUE(parsed["lost"].empty());
}

TEST(Convert, SaysWhatTheReaderDidNotKeep) {
  const TemporaryFolder folder;
  folder.write("a.obj", "v 0 0 0 1 0 0\nv 0 0.1 0 0 0 0\nl 1 2\n");
  const std::string note = "per-point colours averaged to one per strand: they vary along 1 strand";
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"convert", "@a.obj", "@a.hair"}, {"info", "@a.obj"}}) {
    EXPECT_THAT(run(folder, arguments).out, HasSubstr("note: " + note));
    std::vector<std::string> as_json = arguments;
    as_json.push_back("--json");
    EXPECT_EQ(nlohmann::json::parse(run(folder, as_json).out)["notes"][0], note);
  }
}

TEST(Convert, CountsAllBadStrandsAndListsTheFirst) {
  const TemporaryFolder folder;
  std::string text = "v 0 0 0\nv 0 0.1 0\nl 1 2\n";
  for (int k = 0; k < 10'003; ++k) text += "o x\nl 1\n";
  folder.write("a.obj", text);
  const Result words = run(folder, {"convert", "@a.obj", "@a.hair"});
  EXPECT_THAT(words.out, HasSubstr("10003 dropped, 0 repaired"));
  EXPECT_THAT(words.out, HasSubstr("and 9993 more"));
  const nlohmann::json json = nlohmann::json::parse(run(folder, {"convert", "@a.obj", "@a.hair", "--json"}).out);
  EXPECT_EQ(json["dropped"], 10'003);
  EXPECT_EQ(json["repaired"], 0);
  EXPECT_EQ(json["issues"].size(), 10'000U);
  const Result info = run(folder, {"info", "@a.obj"});
  EXPECT_THAT(info.out, HasSubstr("dropped, repaired   10003, 0"));
  EXPECT_THAT(info.out, HasSubstr("and 9991 more"));
  EXPECT_EQ(nlohmann::json::parse(run(folder, {"info", "@a.obj", "--json"}).out)["dropped"], 10'003);
}

TEST(Convert, NamesDatabasesAndEmptyFiles) {
  const TemporaryFolder folder;
  folder.write("a.hrir", std::string("SQLite format 3\0", 16) + std::string(200, ' '));
  folder.write("empty.hrir", "");
  const Result database = run(folder, {"convert", "@a.hrir", "@a.hair"});
  EXPECT_EQ(database.code, 4);
  EXPECT_THAT(database.err, HasSubstr("HRIR database"));
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"convert", "@empty.hrir", "@a.hair"}, {"info", "@empty.hrir"}}) {
    const Result empty = run(folder, arguments);
    EXPECT_EQ(empty.code, 4);
    EXPECT_THAT(empty.err, HasSubstr("empty.hrir: the file is empty"));
  }
}

TEST(Convert, InPlaceOnlyWhenAsked) {
  const TemporaryFolder folder;
  const std::string hair = "v 0 0 0\nv 0 10 0\nl 1 2\n";
  folder.write("a.obj", hair);
  const Result not_asked = run(folder, {"convert", "@a.obj", "@./a.obj", "--unit", "cm"});
  EXPECT_EQ(not_asked.code, 2);
  EXPECT_THAT(not_asked.err, HasSubstr("would write over the input"));
  EXPECT_THAT(not_asked.err, HasSubstr("--in-place"));
  EXPECT_EQ(run(folder, {"convert", "@a.obj", "@b.obj", "--in-place"}).code, 2) << "another output and in place";
  EXPECT_THAT(run(folder, {"convert", "@a.obj"}).err, HasSubstr("output is required"));
  EXPECT_EQ(text_of(folder / "a.obj"), hair);

  std::filesystem::create_symlink("a.obj", folder / "link.obj");
  const Result asked =
      run(folder, {"convert", "@link.obj", "--in-place", "--unit", "cm", "--up", "z", "--resample", "3", "--json"});
  ASSERT_EQ(asked.code, 0) << asked.err;
  EXPECT_EQ(nlohmann::json::parse(asked.out)["vertices"], 3);
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.obj"));
  EXPECT_THAT(text_of(folder / "a.obj"), HasSubstr("v 0 0 -0.1\n")) << "10 cm along -Z of Y-up, as metres";
}

TEST(Convert, InPlaceThatFailsLeavesTheInput) {
  const TemporaryFolder folder;
  folder.write("cut.ply", "ply\nformat ascii 1.0\nelement vertex 9\n");
  EXPECT_EQ(run(folder, {"convert", "@cut.ply", "--in-place"}).code, 4);
  EXPECT_EQ(text_of(folder / "cut.ply"), "ply\nformat ascii 1.0\nelement vertex 9\n");
  ASSERT_EQ(run(folder, {"groom", "--strands", "20", "-o", "@a.obj"}).code, 0);
  const std::string before = text_of(folder / "a.obj");
  // 64 blocks are less than the strands want.
  const Result full = Child(folder,
                            {"-c", "trap '' XFSZ; ulimit -f 64; exec \"$0\" convert \"$1\" --in-place --resample 5000",
                             PELAGE_PROGRAM, "@a.obj"},
                            {}, "/bin/sh")
                          .wait();
  EXPECT_EQ(full.code, 1) << full.err;
  EXPECT_EQ(text_of(folder / "a.obj"), before);
}

TEST(Convert, MoreVerticesThanCanBeCountedAreRefused) {
  const TemporaryFolder folder;
  ASSERT_EQ(run(folder, {"groom", "--strands", "70000", "--vertices", "4", "-o", "@a.data"}).code, 0);
  const Result result = run(folder, {"convert", "@a.data", "@b.data", "--resample", "65536"});
  EXPECT_EQ(result.code, 2);
  EXPECT_THAT(result.err, HasSubstr("4587520000 vertices"));
}

TEST(Convert, TheUnitIsNamedWhereItIsTheTrouble) {
  const TemporaryFolder folder;
  folder.write("a.obj", kTwoStrands);
  const Result result = run(folder, {"convert", "@a.obj", "@a.hair", "--unit", "1e-300"});
  EXPECT_EQ(result.code, 2);
  EXPECT_THAT(result.err, HasSubstr("unit \"1e-300\""));
}

TEST(Groom, GrowsOnAGivenHeadAndSaysWhichOptionsBelongToIt) {
  const TemporaryFolder folder;
  ASSERT_EQ(run(folder, {"groom", "--strands", "3", "-o", "@a.hair", "--head-out", "@head.obj"}).code, 0);
  const std::vector<std::string> on{"groom", "--on", "@head.obj", "--strands", "50", "-o", "@b.hair"};
  const auto with = [&](std::vector<std::string> arguments, std::initializer_list<std::string> more) {
    arguments.insert(arguments.end(), more);
    return run(folder, arguments);
  };
  const Result grown = with(on, {"--length-m", "0.1", "--json"});
  ASSERT_EQ(grown.code, 0) << grown.err;
  EXPECT_EQ(nlohmann::json::parse(grown.out)["style"], "grown");
  EXPECT_EQ(nlohmann::json::parse(grown.out)["vertices"], 50 * 16);
  for (const auto& [option, value] : {std::pair<std::string, std::string>{"--style", "bob"},
                                      {"--length-scale", "2"},
                                      {"--head-out", "@c.obj"},
                                      {"--unit", "mm"},
                                      {"--face", "up"},
                                      {"--length-m", "nan"},
                                      {"--vertices", "1"},
                                      {"--head-height", "-1"},
                                      {"--output", "@head.obj"}}) {
    const Result refused =
        with(option == "--output" ? std::vector<std::string>{"groom", "--on", "@head.obj"} : on, {option, value});
    EXPECT_EQ(refused.code, 2) << option << refused.err;
  }
  for (const char* option : {"--length-m", "--unit", "--up", "--face"})
    EXPECT_THAT(run(folder, {"groom", option, "1", "-o", "@b.hair"}).err, HasSubstr("--on")) << option;
  EXPECT_EQ(run(folder, {"groom", "--style", "grown", "-o", "@b.hair"}).code, 2);
  EXPECT_EQ(run(folder, {"groom", "--on", "@missing.obj", "-o", "@b.hair"}).code, 4);
}

/// One bone, one strand whose weights sum to 0.5.
std::string small_bones() {
  std::string bytes;
  const auto add = [&](auto value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
  for (const std::int32_t i : {1, 0, 5}) add(i);
  bytes += std::string("head\0", 5);
  for (const std::int32_t i : {1, 0}) add(i);
  for (const float weight : {0.5F, 0.0F, 0.0F, 0.0F}) {
    add(std::int32_t{0});
    add(weight);
  }
  return bytes;
}

TEST(Info, ShowsBoneWeights) {
  const TemporaryFolder folder;
  folder.write("a.tfxbone", small_bones());
  const Result text = run(folder, {"info", "@a.tfxbone"});
  EXPECT_EQ(text.code, 0) << text.err;
  for (const char* part : {"bones               1", "strands             1", "0.5"})
    EXPECT_THAT(text.out, HasSubstr(part));
  const nlohmann::json json = nlohmann::json::parse(run(folder, {"info", "@a.tfxbone", "--json"}).out);
  EXPECT_EQ(json["bones"], nlohmann::json::array({"head"}));
  EXPECT_EQ(json["strands"], 1);
  EXPECT_EQ(json["weight_sum_farthest_from_1"], 0.5);
  folder.write("short.tfxbone", "abc");
  EXPECT_EQ(run(folder, {"info", "@short.tfxbone"}).code, 4);
}

TEST(Info, RefusesOptionsOfHairForAnythingElse) {
  const TemporaryFolder folder;
  folder.write("a.hrir", std::string("SQLite format 3\0", 16));
  folder.write("a.tfxbone", small_bones());
  for (const std::string& file :
       {kExamples + "three_locks.hairstyle.json", std::string("@a.hrir"), std::string("@a.tfxbone")}) {
    for (const std::vector<std::string>& option :
         {std::vector<std::string>{"--unit", "m"}, {"--up", "z"}, {"--curve", "bspline"}}) {
      const Result result = run(folder, {"info", file, option[0], option[1]});
      EXPECT_EQ(result.code, 2) << file;
      EXPECT_THAT(result.err, HasSubstr(option[0]));
    }
  }
}

TEST(Groom, RefusesSeedsAndCountsThatAreNone) {
  const TemporaryFolder folder;
  for (const char* option : {"--seed", "--strands"}) {
    for (const char* bad : {"-1", "1.5", "nan", "18446744073709551616"}) {
      const Result result = run(folder, {"groom", option, bad, "-o", "@a.hair"});
      EXPECT_EQ(result.code, 2) << option << bad << result.out;
      EXPECT_THAT(result.err, HasSubstr(option));
    }
  }
  const Result result = run(folder, {"groom", "--strands", "3", "--seed", "4294967296", "-o", "@a.hair", "--json"});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(nlohmann::json::parse(result.out)["seed"], 4294967296);
}

TEST(Groom, SaysWhichFileWasWritten) {
  const TemporaryFolder folder;
  const Result same = run(folder, {"groom", "--strands", "3", "-o", "@a.obj", "--head-out", "@./a.obj"});
  EXPECT_EQ(same.code, 2) << same.err;
  const std::vector<std::string> groom{
      "-c", "trap '' XFSZ; ulimit -f 64; exec \"$0\" groom --strands 3 -o \"$1\" --head-out \"$2\"", PELAGE_PROGRAM,
      "@a.hair", "@head.obj"};
  const Result full = Child(folder, groom, {}, "/bin/sh").wait();  // the head has more than 64 blocks
  EXPECT_EQ(full.code, 1);
  EXPECT_THAT(full.err, HasSubstr("head.obj"));
  EXPECT_THAT(full.err, HasSubstr("a.hair was written"));
  EXPECT_EQ(run(folder, {"info", "@a.hair"}).code, 0);
}

/// `from`, converted on and on: no step may say that it lost anything. Returns the last file's bytes.
std::string converted(const TemporaryFolder& folder, std::string from, const std::vector<std::string>& through) {
  for (const std::string& to : through) {
    const Result result = run(folder, {"convert", from, "@" + to});
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_THAT(result.out, Not(HasSubstr("lost"))) << to;
    from = "@" + to;
  }
  return text_of(folder / through.back());
}

TEST(Convert, AllRoundsTripToTheSameBytes) {
  const TemporaryFolder folder;
  // An OBJ has no diameters, and a TFX file one for each strand, which a groom's tapering strands do not fit in.
  ASSERT_EQ(run(folder, {"groom", "--strands", "200", "--vertices", "16", "-o", "@plain.obj"}).code, 0);
  const std::string plain = converted(folder, "@plain.obj", {"a.hair"});
  EXPECT_TRUE(converted(folder, "@a.hair", {"b.usda", "c.tfx", "d.ply", "e.usda", "f.hair"}) == plain);
  const Result info = run(folder, {"info", "@b.usda", "--json"});
  ASSERT_EQ(info.code, 0) << info.err;
  EXPECT_EQ(nlohmann::json::parse(info.out)["strands"], 200);
}

TEST(Convert, TaperingStrandsRoundTripToTheSameBytes) {
  const TemporaryFolder folder;
  ASSERT_EQ(run(folder, {"groom", "--strands", "200", "--vertices", "16", "-o", "@a.hair"}).code, 0);
  EXPECT_TRUE(converted(folder, "@a.hair", {"b.usda", "d.ply", "e.usda", "f.hair"}) == text_of(folder / "a.hair"));
  EXPECT_THAT(run(folder, {"convert", "@a.hair", "@c.tfx"}).out, HasSubstr("lost: diameter along"));
}

TEST(Convert, ReadsWithUnitAxisAndCurveAndResamples) {
  const TemporaryFolder folder;
  folder.write("a.obj", "v 0 0 0\nv 0 0 10\nv 0 0 20\nv 0 0 30\nl 1 2 3 4\n");
  EXPECT_THAT(run(folder, {"convert", "@a.obj", "@b.obj"}).err, HasSubstr("--unit cm"));
  ASSERT_EQ(run(folder, {"convert", "@a.obj", "@b.obj", "--unit", "cm", "--up", "z", "--resample", "3"}).code, 0);
  EXPECT_EQ(text_of(folder / "b.obj"), "# Pelage: metres, Y up\nv 0 0 -0\nv 0 0.15 0\nv 0 0.3 -0\nl 1 2 3\n");
  ASSERT_EQ(run(folder, {"convert", "@a.obj", "@c.obj", "--unit", "cm", "--up", "z", "--curve", "bspline"}).code, 0);
  EXPECT_THAT(text_of(folder / "c.obj"), HasSubstr("l 1 2 3 4 5 6 7 8"));
}

TEST(Convert, RefusesBeforeItWrites) {
  const TemporaryFolder folder;
  folder.write("a.obj", kTwoStrands);
  folder.write("old.tfx", "earlier");
  const Result uneven = run(folder, {"convert", "@a.obj", "@old.tfx"});
  EXPECT_EQ(uneven.code, 1);
  EXPECT_THAT(uneven.err, HasSubstr("--resample"));
  EXPECT_EQ(text_of(folder / "old.tfx"), "earlier");
  const std::size_t before = folder.entries();

  const Result unknown = run(folder, {"convert", "@a.obj", "@a.abc"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_THAT(unknown.err, HasSubstr(".usda"));
  EXPECT_EQ(run(folder, {"convert", "@none.obj", "@a.hair"}).code, 4);
  EXPECT_EQ(run(folder, {"convert", "@old.tfx", "@a.hair"}).code, 4);
  EXPECT_EQ(run(folder, {"convert", "@a.obj", "@no/folder.hair"}).code, 1);
  for (const char* bad : {"1", "65537", "nan"})
    EXPECT_EQ(run(folder, {"convert", "@a.obj", "@a.hair", "--resample", bad}).code, 2) << bad;
  EXPECT_EQ(run(folder, {"convert", "@a.obj", "@a.hair", "--unit", "nan"}).code, 2);
  EXPECT_EQ(folder.entries(), before);
}

}  // namespace
}  // namespace pelage::test
