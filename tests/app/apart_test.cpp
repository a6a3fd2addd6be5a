// Hard case 34: an output that is an input, by any spelling of the path, is refused before any work. Every verb of both
// programs, each of its outputs against each of its inputs.
#include <gmock/gmock.h>

#include <map>
#include <set>

#include "help.h"
#include "in_process.h"

namespace pelage::test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsSubsetOf;
namespace fs = std::filesystem;
using Words = std::vector<std::string>;

/// A file of a command line.
struct File {
  std::string option;  // as --help lists it; empty: named by the scene file
  std::string path;
  std::string written = {};  // of an output that is a folder: a file that is written there
};

/// A verb with all files that it reads and writes. One that cannot have them all at once is there more than once.
struct Command {
  const Program* program;
  Words words;
  std::vector<File> inputs, outputs;

  Words with(const std::vector<File>& its_inputs, const std::vector<File>& its_outputs) const {
    Words line = words;
    for (const auto* files : {&its_inputs, &its_outputs}) {
      for (const File& file : *files) {
        if (file.option.starts_with('-')) line.push_back(file.option);
        if (!file.option.empty()) line.push_back(file.path);
      }
    }
    return line;
  }
};

std::vector<Command> commands() {
  const Program *const run = &kPelage, *const bake = &kBake;
  const std::vector<File> of_scenes{
      {"input", "h.obj"}, {"--head", "head.obj"}, {"--database", "d.hrir"}, {"--material", "m.json"}};
  const std::vector<File> scene{{"input", "scene.json"}, {"", "h.obj"}, {"", "head.obj"}, {"", "d.hrir"}};
  const std::vector<File> frames{{"--out", "f", "frame_0003.png"}, {"--hair-out", "g", "frame_12345.hair"}},
      picture{{"--out", "x.png"}};
  const std::vector<File> video{{"--out", "f", "frame_0000.png"}, {"--video", "x.mp4"}};
  std::vector<Command> all{
      {run, {"info"}, {{"file", "d.hrir"}, {"--against", "s.json"}}, {{"--output", "x.png"}}},
      {run, {"groom"}, {{"--on", "head.obj"}}, {{"--output", "x.hair"}}},
      {run, {"groom"}, {}, {{"--output", "x.hair"}, {"--head-out", "x.obj"}}},
      {run, {"convert"}, {{"input", "h.obj"}}, {{"output", "x.hair"}}},
      {run, {"cluster"}, {{"input", "h.obj"}}, {{"--output", "x.json"}}},
      {run, {"simulate"}, of_scenes, frames},
      {run, {"simulate"}, of_scenes, video},
      {run, {"simulate"}, scene, frames},
      {run, {"view"}, of_scenes, {}},
      {run, {"shadow-error"}, of_scenes, {}},
      {run, {"render", "--set", "head=head.obj"}, {{"input", "h.obj"}, {"", "head.obj"}}, picture},
      {bake, {"build"}, {{"--from", "s.json"}, {"--settings", "b.json"}}, {{"--output", "x.hrir"}}},
      {bake, {"merge"}, {{"shards", "d.hrir"}}, {{"--output", "x.hrir"}}},
      {bake, {"info"}, {{"database", "d.hrir"}}, {}},
      {bake, {"query"}, {{"database", "d.hrir"}}, {}},
      {bake, {"verify"}, {{"database", "d.hrir"}, {"--against", "s.json"}}, {}}};
  for (const std::vector<File>& inputs : {of_scenes, scene}) {
    all.push_back({run, {"render"}, inputs, picture});
    all.push_back({run, {"figure", "filter"}, inputs, picture});
    for (const char* const name : {"index.html", "comparison.json", "comparison-frames.csv", "truth.exr"})
      all.push_back({run, {"compare"}, inputs, {{"--out", "f", name}}});
    for (const char* const name : {"index.html", "tradeoff.csv", "points/any.json", "cache/any.hrir"})
      all.push_back({run, {"tradeoff"}, inputs, {{"--out", "f", name}}});
  }
  return all;
}

/// Options that take text which is no path.
const std::set<std::string> kNoPaths{
    "--auto",      "--background",  "--camera",      "--curve",   "--density-map", "--face",
    "--features",  "--light",       "--lighting",    "--lobes",   "--log-level",   "--method",
    "--methods",   "--motion",      "--off",         "--on",      "--only",        "--order",
    "--preset",    "--progress",    "--point-light", "--records", "--set",         "--shadow-at",
    "--shape",     "--shard",       "--size",        "--solver",  "--storage",     "--style",
    "--threshold", "--self-shadow", "--unit",        "--up",      "--wind",        "figure"};

/// Everything in a folder: kind, last change, and content or where a link leads.
std::map<std::string, std::string> everything_in(const fs::path& folder) {
  std::map<std::string, std::string> all;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    std::string& what = all[entry.path().string()];
    if (entry.is_symlink()) {
      what = "-> " + fs::read_symlink(entry).string();
      continue;
    }
    what = std::to_string(entry.last_write_time().time_since_epoch().count());
    if (entry.is_regular_file()) what += " " + text_of(entry.path());
  }
  return all;
}

/// A folder with inputs, worked in; `linked` beside it leads to it.
class Apart : public ::testing::Test {
 protected:
  Apart() {
    fs::create_directories(work() / "x");
    for (const char* const name : {"head.obj", "d.hrir", "m.json", "s.json", "b.json"})
      folder_.write("place/" + std::string(name), std::string("content of ") + name);
    folder_.write("place/h.obj", "v 0 0 0\nv 0 0.1 0\nv 0.01 0.2 0\nl 1 2 3\n");
    folder_.write("place/scene.json", R"({"version": 1, "hair": "h.obj", "head": "head.obj", "database": "d.hrir"})");
    fs::create_directory_symlink("place", folder_ / "linked");
    fs::current_path(work());
  }
  ~Apart() override { fs::current_path(before_); }
  fs::path work() const { return folder_ / "place"; }

  void expect_refused(const Program& program, const Words& words, const std::vector<std::string>& says) {
    const std::map<std::string, std::string> before = everything_in(folder_ / "");
    const ResultHere result = run_here(program, folder_, words);
    const std::string line = ::testing::PrintToString(words) + ": " + result.err;
    EXPECT_EQ(result.code, 2) << line;
    for (const std::string& part : says) EXPECT_THAT(result.err, HasSubstr(part)) << line;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << line;
    EXPECT_EQ(result.out, "") << line;
    EXPECT_EQ(everything_in(folder_ / ""), before) << line;
    ++refused_;
  }

  TemporaryFolder folder_;
  int refused_ = 0;

 private:
  fs::path before_ = fs::current_path();
};

/// Every way to spell a file of the folder, and a name whose extension is `like`'s.
class Spellings {
 public:
  Spellings(const std::string& file, const std::string& like) {
    const std::string end = fs::path(like).extension();
    soft_ = "soft" + end;
    hard_ = "hard" + end;
    fs::create_symlink(file, soft_);
    fs::create_hard_link(file, hard_);
    all = {file,
           "./x/../" + file,
           "../place/" + file,
           fs::absolute(file),
           "../linked/" + file,
           "../linked/x/../" + file,
           soft_,
           "../linked/" + soft_,
           hard_};
  }
  ~Spellings() {
    fs::remove(soft_);
    fs::remove(hard_);
  }
  Spellings(const Spellings&) = delete;
  Spellings& operator=(const Spellings&) = delete;
  Words all;
  bool is_link(const std::string& spelling) const { return spelling.ends_with(soft_) || spelling == hard_; }

 private:
  std::string soft_, hard_;
};

TEST_F(Apart, NoOutputIsAnInput) {
  for (const Command& command : commands()) {
    for (std::size_t o = 0; o < command.outputs.size(); ++o) {
      if (!command.outputs[o].written.empty()) continue;
      for (const File& input : command.inputs) {
        const Spellings spellings(input.path, command.outputs[o].path);
        for (const std::string& spelling : spellings.all) {
          std::vector<File> outputs = command.outputs;
          outputs[o].path = spelling;
          // What the scene file names is looked at after the output's extension.
          const bool said = !input.option.empty() || spellings.is_link(spelling);
          expect_refused(
              *command.program, command.with(command.inputs, outputs),
              said ? Words{spelling + ": ", "would write over", input.path, ": name another file"} : Words{});
        }
      }
    }
  }
  std::printf("%d command lines refused\n", refused_);
  EXPECT_GT(refused_, 200);
}

TEST_F(Apart, NoOutputFolderReceivesAnInput) {
  for (const Command& command : commands()) {
    for (std::size_t o = 0; o < command.outputs.size(); ++o) {
      const File& folder = command.outputs[o];
      if (folder.written.empty()) continue;
      const fs::path place = fs::path(folder.path) / folder.written;
      for (std::size_t i = 0; i < command.inputs.size(); ++i) {
        const auto expect = [&](const std::string& given) {
          std::vector<File> outputs = command.outputs, inputs = command.inputs;
          outputs[o].path = given;
          if (!fs::exists(inputs[i].path)) inputs[i].path = "x/../" + place.string();  // it was moved there
          expect_refused(
              *command.program, command.with(inputs, outputs),
              {folder.written + ": ", folder.option + " would write over", inputs[i].path, ": name another folder"});
        };
        const auto expect_spellings = [&] {
          for (const std::string& given :
               {folder.path, "./x/../" + folder.path, fs::absolute(folder.path).string(), "../linked/" + folder.path})
            expect(given);
          fs::create_directory_symlink(folder.path, "soft");
          expect("soft");
          fs::remove("soft");
        };
        const fs::path input = command.inputs[i].path;
        fs::create_directories(place.parent_path());
        fs::create_symlink(fs::absolute(input), place);
        expect_spellings();
        fs::remove(place);
        fs::create_hard_link(input, place);
        expect_spellings();
        if (!command.inputs[i].option.empty()) {
          fs::remove(input);
          expect_spellings();
          fs::create_hard_link(place, input);
        }
        fs::remove_all(folder.path);
      }
    }
  }
  std::printf("%d command lines refused\n", refused_);
  EXPECT_GT(refused_, 400);
}

TEST_F(Apart, NoOutputIsAnotherOutput) {
  const auto groom = [&](const std::string& hair, const std::string& head) {
    expect_refused(kPelage, {"groom", "-o", hair, "--head-out", head},
                   {head, hair, "--head-out would write over --output"});
  };
  fs::create_symlink("dangling.obj", "soft.obj");
  folder_.write("place/there.obj", "earlier");
  fs::create_hard_link("there.obj", "hard.obj");
  for (const char* const other :
       {"new.obj", "./new.obj", "x/../new.obj", "../linked/new.obj", "../linked/x/../new.obj"})
    groom("new.obj", other);
  groom("dangling.obj", "soft.obj");
  groom("there.obj", "hard.obj");
  const auto video = [&](const std::string& frames, const std::string& file) {
    expect_refused(kPelage, {"simulate", "h.obj", "-o", frames, "--video", file}, {"--video would write over --out"});
  };
  video("new", "new");
  video("new", "new/frame_0000.png");
  video("new", "./x/../new/frame_123456.png");
  video("../linked/new", fs::absolute("new/frame_0000.png"));
}

TEST_F(Apart, WhatABakeWritesBesideItsOutputIsNoInput) {
  for (const char* const option : {"--from", "--settings"}) {
    folder_.write("place/y.hrir.partial", "precious");
    expect_refused(kBake, {"build", option, "x/../y.hrir.partial", "--no-resume", "-o", "y.hrir"},
                   {"y.hrir.partial: --output would write over " + std::string(option) + " (x/../y.hrir.partial)"});
  }
  expect_refused(kBake, {"merge", "d.hrir", "y.hrir.partial", "-o", "y.hrir"}, {"would write over the shards"});
}

TEST_F(Apart, WhatIsApartIsLeftAlone) {
  const auto good = [&](const Program& program, const Words& words) {
    const ResultHere result = run_here(program, folder_, words);
    EXPECT_EQ(result.code, 0) << ::testing::PrintToString(words) << result.err;
  };
  folder_.write("place/old.hair", "earlier");
  fs::create_symlink("old.hair", "soft.hair");
  good(kPelage, {"convert", "h.obj", "soft.hair"});
  EXPECT_NE(text_of("old.hair"), "earlier") << "an output that was there, and is no input, is replaced";
  EXPECT_TRUE(fs::is_symlink("soft.hair"));
  // An input in the folder, under a name that is not written; one frame earlier, replaced.
  fs::create_directory("f");
  fs::copy("h.obj", "f/frame_1.obj");
  fs::copy("h.obj", "f/frame_0000.png");
  folder_.write("place/f/frame_0000.hair", "earlier");
  good(kPelage, {"simulate", "f/frame_1.obj", "--hair-out", "f", "--seconds", "0.05", "--settle", "0"});
  EXPECT_NE(text_of("f/frame_0000.hair"), "earlier");
  // A bake over the earlier one, and shards put together over another database.
  fs::remove("d.hrir");
  for (int twice = 0; twice < 2; ++twice) good(kBake, {"build", "--sectors", "2", "-o", "d.hrir"});
  for (const char* const part : {"1", "2"})
    good(kBake, {"build", "--sectors", "2", "--shard", part + std::string("/2"), "-o", part + std::string(".hrir")});
  good(kBake, {"merge", "1.hrir", "2.hrir", "-o", "d.hrir"});
}

/// One that is not in commands() fails here until it is.
TEST(Commands, NameEveryOptionThatTakesAPath) {
  const TemporaryFolder folder;
  std::map<std::pair<std::string, std::string>, std::set<std::string>> listed;
  for (const Command& command : commands())
    for (const auto* files : {&command.inputs, &command.outputs})
      for (const File& file : *files)
        if (!file.option.empty()) listed[{command.program->name, command.words.front()}].insert(file.option);
  for (const Program* const program : {&kPelage, &kBake}) {
    const Words verbs = verbs_of(*program, folder);
    EXPECT_GE(verbs.size(), 5U);
    for (const std::string& verb : verbs) {
      std::set<std::string> paths, texts;
      for (const Option& option : options_of(*program, folder, verb)) {
        if (option.kind == "FILE" || option.kind == "FOLDER") paths.insert(option.name);
        if (option.kind == "TEXT") texts.insert(option.name);
      }
      const std::set<std::string> expected = listed[{program->name, verb}];
      EXPECT_EQ(paths, expected) << program->name << " " << verb;
      EXPECT_THAT(texts, IsSubsetOf(kNoPaths))
          << program->name << " " << verb << ": a path is declared by add_input or add_output";
    }
  }
}

}  // namespace
}  // namespace pelage::test
