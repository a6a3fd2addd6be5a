// pelage convert as a user runs it: what it prints, what it refuses, and that a failed run leaves the earlier output.
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

TEST(Convert, AllRoundsTripToTheSameBytes) {
  const TemporaryFolder folder;
  ASSERT_EQ(run(folder, {"groom", "--strands", "200", "--vertices", "16", "-o", "@a.hair"}).code, 0);
  const std::string whole = text_of(folder / "a.hair");
  std::string from = "@a.hair";
  for (const char* to : {"@b.usda", "@c.tfx", "@d.ply", "@e.usda", "@f.hair"}) {
    const Result result = run(folder, {"convert", from, to});
    ASSERT_EQ(result.code, 0) << result.err;
    EXPECT_THAT(result.out, Not(HasSubstr("lost"))) << to;
    from = to;
  }
  EXPECT_TRUE(text_of(folder / "f.hair") == whole);
  const Result info = run(folder, {"info", "@b.usda", "--json"});
  ASSERT_EQ(info.code, 0) << info.err;
  EXPECT_EQ(nlohmann::json::parse(info.out)["strands"], 200);
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
