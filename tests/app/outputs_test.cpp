// Hard case 32 for every verb that writes, in both programs: outputs that cannot be, refused before the work with the
// remedy; Ctrl-C while it works.
#include <gmock/gmock.h>

#include "../fuzz/tiny_database.h"
#include "child.h"
#include "in_process.h"

namespace pelage::test {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;
using Words = std::vector<std::string>;

/// A way to write: what comes before the output's path, and what it may be called.
struct Way {
  std::string name;
  bool bake;           // by pelage-bake
  Words arguments;     // the output comes last
  std::string output;  // file name
  Words longer;        // options that let it take a second or more
  bool folder = false;
};

void PrintTo(const Way& way, std::ostream* out) {
  *out << way.name;
}

std::vector<Way> ways() {
  constexpr bool run = false, bake = true;
  const Words small{"--method", "unshadowed", "--size", "32x32"};
  const auto drawn = [&](Words words, const Words& more) {
    words.insert(words.end(), small.begin(), small.end());
    words.insert(words.end(), more.begin(), more.end());
    return words;
  };
  return {{"groom", run, {"groom", "--strands", "20", "-o"}, "x.hair", {"--strands", "30000"}},
          {"groom_head",
           run,
           {"groom", "--strands", "20", "-o", "@ok.hair", "--head-out"},
           "x.obj",
           {"--strands", "30000"}},
          {"convert", run, {"convert", "@h.obj"}, "x.usda", {"--resample", "60000"}},
          {"cluster", run, {"cluster", "@h.obj", "--clusters", "1", "-o"}, "x.json", {}},
          {"render", run, drawn({"render", "@h.obj"}, {"-o"}), "x.png", {"--size", "3000x3000"}},
          {"render_truth", run, {"render", "@h.obj", "--method", "truth", "-o"}, "x.exr", {"--size", "3000x3000"}},
          {"simulate", run, drawn({"simulate", "@h.obj"}, {"-o"}), "x", {"--seconds", "1000"}, true},
          {"simulate_hair", run, {"simulate", "@h.obj", "--hair-out"}, "x", {"--seconds", "1000"}, true},
          {"compare",
           run,
           {"compare", "@h.obj", "--methods", "density-map", "--size", "32x32", "-o"},
           "x",
           {"--size", "2000x2000"},
           true},
          {"figure", run, {"figure", "filter", "@h.obj", "-o"}, "x.png", {"--size", "2000x2000"}},
          {"info", run, {"info", "@d.hrir", "-o"}, "x.png", {}},
          {"build", bake, {"build", "--sectors", "4", "-o"}, "x.hrir", {"--sectors", "100000"}},
          {"merge", bake, {"merge", "@d.hrir", "-o"}, "x.hrir", {}}};
}

class Outputs : public ::testing::TestWithParam<Way> {
 protected:
  void SetUp() override {
    std::string hair;
    for (int s = 0; s < 40; ++s) hair += "v 0 0 0\nv 0 0.1 0\nv 0.01 0.2 0\nl -3 -2 -1\n";
    folder.write("h.obj", hair);
    fuzz::write_tiny_database(folder / "d.hrir", fuzz::tiny_settings(Storage::u8, 5));
  }
  /// The command line that writes there, with `more` in place of what is given already.
  Words words(const std::string& path, const Words& more = {}) const {
    Words all = GetParam().arguments;
    all.push_back(path);
    for (std::size_t i = 0; i + 1 < more.size(); i += 2) {
      const auto given = std::find(all.begin(), all.end(), more[i]);
      if (given == all.end())
        all.insert(all.end(), {more[i], more[i + 1]});
      else
        *std::next(given) = more[i + 1];
    }
    return all;
  }
  TemporaryFolder folder;
};

INSTANTIATE_TEST_SUITE_P(Verbs, Outputs, ::testing::ValuesIn(ways()), [](const auto& way) { return way.param.name; });

TEST_P(Outputs, ThatCannotBeAreRefused) {
  const Way& way = GetParam();
  fs::create_directory(folder / way.output);
  folder.write("file", "earlier");
  const auto expect = [&](const std::string& path, const auto& says) {
    const ResultHere result = run_here(way.bake ? kBake : kPelage, folder, words(path));
    EXPECT_EQ(result.code, 1) << path << ": " << result.err;
    EXPECT_THAT(result.err, says) << path;
    EXPECT_EQ(result.out, "") << path;
  };
  const std::string name = way.output;
  if (way.folder) {
    expect("@file/" + name, HasSubstr("file"));  // no folder can be made in a file
    expect("@file", HasSubstr("file"));
    expect("/proc/" + name, HasSubstr("/proc"));
  } else {
    expect("@missing/" + name, HasSubstr("there is no folder"));
    expect("@file/" + name, HasSubstr("there is no folder"));
    expect("@" + name, HasSubstr("is a folder: name a file in it"));
    expect("/proc/" + name, HasSubstr("/proc"));
  }
  EXPECT_EQ(text_of(folder / "file"), "earlier");
  EXPECT_TRUE(fs::is_empty(folder / way.output));
  fs::remove(folder / "ok.hair");
  EXPECT_EQ(folder.entries(), 4U) << "two inputs, x, file: nothing else is left";
}

TEST_P(Outputs, KeepTheEarlierOneWhenInterrupted) {
  const Way& way = GetParam();
  const std::string name = way.folder ? "x/frame_0000.txt" : way.output;
  if (way.folder) fs::create_directory(folder / "x");
  folder.write(name, "earlier");
  const Child child(folder, words("@" + way.output, way.longer), {}, way.bake ? PELAGE_BAKE : PELAGE_PROGRAM);
  while (child.is_running() && !child.catches(SIGINT)) usleep(500);
  child.signal(SIGINT);
  const Result result = child.wait();
  if (result.code == 0) GTEST_SKIP() << "it was done before the signal came";
  if (result.code == 5) GTEST_SKIP() << result.err;
  EXPECT_EQ(result.code, 130) << result.err;
  EXPECT_THAT(result.err, HasSubstr("interrupted"));
  EXPECT_EQ(text_of(folder / name), "earlier");
  for (const auto& entry : fs::recursive_directory_iterator(folder / "")) {
    const std::string file = entry.path().filename().string();
    EXPECT_FALSE(file.starts_with(".")) << file << " is a temporary";
    EXPECT_TRUE(file.find(".partial") == std::string::npos || way.name == "build" || way.name == "merge") << file;
  }
}

}  // namespace
}  // namespace pelage::test
