// `pelage render` from outside: what it writes, and what it answers to wrong command lines, missing and unwritable
// files, Ctrl-C and a machine without OpenGL (hard cases 28, 30, 32).
#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>

#include <functional>
#include <nlohmann/json.hpp>

#include "child.h"
#include "pelage/image/image_file.h"

namespace pelage::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
namespace fs = std::filesystem;

class Render : public ::testing::Test {
 protected:
  /// render lock.scene.json, small and quick, with these options besides.
  std::vector<std::string> lock(const std::vector<std::string>& more) const {
    std::vector<std::string> all{"render", kExamples + "lock.scene.json", "--size", "64x48", "--bake-sectors", "60"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  Result render(const std::vector<std::string>& more, std::vector<std::string> environment = {}) const {
    return run(folder, lock(more), std::move(environment));
  }
  void expect_no_work(const Result& result) const {
    EXPECT_FALSE(fs::exists(folder / "cache")) << "nothing was baked before the mistake was found";
    EXPECT_EQ(result.out, "");
    EXPECT_THAT(result.err, StartsWith("pelage: "));
    EXPECT_EQ(result.err.find('\n'), result.err.size() - 1) << result.err;
  }
  TemporaryFolder folder;
};

double coverage(const Image& image) {
  std::size_t n = 0;
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) n += image.rgba[i] > 0.02F;
  return 4.0 * double(n) / double(image.rgba.size());
}

TEST_F(Render, WritesPngAndExrOfTheSamePicture) {
  const Result png = render({"-o", "@a.png"});
  if (png.code == 5) GTEST_SKIP() << png.err;
  ASSERT_EQ(png.code, 0) << png.err;
  EXPECT_EQ(png.out, (folder / "a.png").string() + "\n");
  EXPECT_THAT(png.err, HasSubstr("60 records baked"));
  const Result exr = render({"-o", "@a.exr"});
  ASSERT_EQ(exr.code, 0) << exr.err;
  EXPECT_THAT(exr.err, Not(HasSubstr("baked"))) << "the database is cached";
  const Image a = read_image(folder / "a.png"), b = read_image(folder / "a.exr");
  EXPECT_EQ(a.width, 64);
  EXPECT_EQ(a.height, 48);
  EXPECT_GT(coverage(b), 0.02);
  EXPECT_LT(coverage(b), 0.5);
  for (std::size_t i = 3; i < a.rgba.size(); i += 4) EXPECT_NEAR(a.rgba[i], b.rgba[i], 0.5F / 255 + 1e-3F);
}

TEST_F(Render, ExrCarriesTheResolvedConfiguration) {
  const Result result = render({"-o", "@a.exr", "--material", "blond", "--off", "drift"});
  if (result.code == 5) GTEST_SKIP() << result.err;
  ASSERT_EQ(result.code, 0) << result.err;
  const auto file = OIIO::ImageInput::open((folder / "a.exr").string());
  ASSERT_TRUE(file);
  const std::string text(file->spec().get_string_attribute("pelage:scene"));
  const auto scene = nlohmann::json::parse(text, nullptr, false);
  ASSERT_TRUE(scene.is_object()) << text;
  EXPECT_EQ(scene["image"]["width"], 64);
  EXPECT_EQ(scene["bake"]["sectors"], 60);
  EXPECT_EQ(scene["effects"]["drift"], "off");
  EXPECT_THAT(text, HasSubstr("blond"));
}

// Disabled: scene_options.cpp takes a scene with a "clusters" count for a hairstyle.
TEST_F(Render, ConfigurationOfAnExrRendersTheSamePicture) {
  const Result result = render({"-o", "@a.exr", "--material", "blond", "--off", "drift"});
  if (result.code == 5) GTEST_SKIP() << result.err;
  ASSERT_EQ(result.code, 0) << result.err;
  const auto file = OIIO::ImageInput::open((folder / "a.exr").string());
  ASSERT_TRUE(file);
  folder.write("again.scene.json", std::string(file->spec().get_string_attribute("pelage:scene")));
  const Result again = run(folder, {"render", "@again.scene.json", "-o", "@b.exr"});
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(read_image(folder / "a.exr").rgba, read_image(folder / "b.exr").rgba);
}

TEST_F(Render, StatsNameTheStages) {
  const Result result = render({"-o", "@a.png", "--stats", "--json"});
  if (result.code == 5) GTEST_SKIP() << result.err;
  ASSERT_EQ(result.code, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  std::string names;
  for (const auto& stage : json["stages"]) names += stage["name"].get<std::string>() + " ";
  for (const char* name : {"sectors", "index", "surfaces", "shadow map", "s-maps", "maps", "upload", "order", "draw"})
    EXPECT_THAT(names, HasSubstr(name));
  EXPECT_GT(json["searches"], 0);
}

using Options = std::vector<std::string>;

/// Each is refused in one line that names the option, before anything is baked.
void expect_refused(const TemporaryFolder& folder, const std::vector<Options>& wrong,
                    const std::function<void(const Result&)>& expect_no_work) {
  for (const Options& options : wrong) {
    const std::string named = options[0] + " " + options.back();
    Options all{"render", kExamples + "lock.scene.json", "-o", "@a.png"};
    all.insert(all.end(), options.begin(), options.end());
    const Result result = run(folder, all);
    EXPECT_EQ(result.code, 2) << named << ": " << result.err;
    EXPECT_THAT(result.err, HasSubstr(options[0] == "--material" ? "purple" : options[0])) << named;
    expect_no_work(result);
  }
  EXPECT_FALSE(fs::exists(folder / "a.png"));
}

TEST_F(Render, WrongOptionsAreUsageErrorsBeforeAnyWork) {
  expect_refused(folder,
                 {{"--size", "0x0"},
                  {"--size", "64"},
                  {"--size", "64x48x3"},
                  {"--size", "-1x4"},
                  {"--size", "nanxnan"},
                  {"--size", "16385x1"},
                  {"--light", "nan,0,1"},
                  {"--light", "0,0,0"},
                  {"--light", "1,inf,0"},
                  {"--light", "1,0"},
                  {"--light", "1,0,0,-1"},
                  {"--light", "1e39,0,0"},
                  {"--camera", "nan,0,1,0,0,0"},
                  {"--camera", "1,1,1,1,1,1"},
                  {"--camera", "0,0,1"},
                  {"--camera", "0,0,1,0,0,0,180"},
                  {"--material", "purple"},
                  {"--background", "#12"},
                  {"--off", "everything"},
                  {"--off", "drift", "--on", "drift"},
                  {"--order", "none"},
                  {"--self-shadow", "x"},
                  {"--records", "none"},
                  {"--frobnicate"}},
                 [&](const Result& r) { expect_no_work(r); });
}

// Disabled: scene_options.cpp checks no range of these yet (--supersampling 0 ends by SIGFPE).
TEST_F(Render, NumbersOutOfRangeAreUsageErrorsBeforeAnyWork) {
  expect_refused(folder,
                 {{"--exposure", "nan"},
                  {"--exposure", "inf"},
                  {"--exposure", "-1"},
                  {"--exposure", "0"},
                  {"--supersampling", "0"},
                  {"--supersampling", "9"},
                  {"--neighbours", "0"},
                  {"--neighbours", "9"},
                  {"--bake-sectors", "0"},
                  {"--bake-sectors", "-5"},
                  {"--layers", "0"},
                  {"--layers", "33"},
                  {"--sectors", "2"},
                  {"--plates", "1"},
                  {"--clusters", "0"}},
                 [&](const Result& r) { expect_no_work(r); });
}

TEST_F(Render, WhatAHairstyleHasDecidedIsNotIgnored) {
  for (const char* const option : {"--clusters", "--layers", "--sectors", "--plates"}) {
    const Result r = run(folder, {"render", kExamples + "lock.hairstyle.json", option, "4", "-o", "@a.png"});
    EXPECT_EQ(r.code, 2) << option;
    EXPECT_NE(r.err.find("is a hairstyle"), std::string::npos) << r.err;
  }
}

TEST_F(Render, MoreLightsThanAreDrawnAreRefusedBeforeAnyWork) {
  std::vector<std::string> arguments{"render", kExamples + "lock.hairstyle.json", "-o", "@a.png"};
  for (int i = 0; i < 5; ++i) {
    arguments.push_back("--light");
    arguments.push_back("1,1," + std::to_string(i + 1));
  }
  const Result r = run(folder, arguments);
  EXPECT_EQ(r.code, 2) << r.err;
  EXPECT_NE(r.err.find("5 lights"), std::string::npos) << r.err;
}

TEST_F(Render, MissingOutputOrInputIsSaid) {
  EXPECT_EQ(run(folder, {"render", kExamples + "lock.scene.json"}).code, 2) << "-o is required";
  EXPECT_EQ(run(folder, {"render", "-o", "@a.png"}).code, 2) << "input is required";
  const Result missing = run(folder, {"render", "@nowhere.hair", "-o", "@a.png"});
  EXPECT_EQ(missing.code, 4);
  EXPECT_THAT(missing.err, AllOf(HasSubstr("nowhere.hair"), HasSubstr("no such file")));
  expect_no_work(missing);
  const Result is_folder = run(folder, {"render", "@", "-o", "@a.png"});
  EXPECT_EQ(is_folder.code, 4);
  expect_no_work(is_folder);
  EXPECT_EQ(run(folder, {"render", folder.write("a.json", "{\"hair\":").string(), "-o", "@a.png"}).code, 4);
  EXPECT_EQ(run(folder, {"render", folder.write("a.hair", "HAIR").string(), "-o", "@a.png"}).code, 4);
  EXPECT_EQ(render({"-o", "@a.png", "--database", "@none.hrir"}).code, 4);
  EXPECT_EQ(render({"-o", "@a.png", "--head", "@none.obj"}).code, 4);
}

TEST_F(Render, OutputThatCannotBeWrittenFailsBeforeAnyWork) {
  fs::create_directory(folder / "folder.png");
  for (const char* name : {"@missing/a.png", "@folder.png"}) {
    const Result result = render({"-o", name});
    EXPECT_EQ(result.code, 1) << name << result.err;
    EXPECT_THAT(result.err, HasSubstr(std::string(name).substr(1)));
    expect_no_work(result);
  }
  const Result extension = render({"-o", "@a.jpg"});
  EXPECT_EQ(extension.code, 2);
  expect_no_work(extension);
  if (geteuid() == 0) GTEST_SKIP() << "root may write into a read-only folder";
  fs::create_directory(folder / "locked");
  fs::permissions(folder / "locked", fs::perms::owner_read | fs::perms::owner_exec);
  const Result locked = render({"-o", "@locked/a.png"});
  EXPECT_EQ(locked.code, 1);
  expect_no_work(locked);
}

TEST_F(Render, WithoutOpenGlExitsFiveWithAHint) {
  // libglvnd looks for drivers where this says, and finds none.
  const Result result = render({"-o", "@a.png"}, {"__EGL_VENDOR_LIBRARY_FILENAMES=/nonexistent.json"});
  EXPECT_EQ(result.code, 5) << result.err;
  EXPECT_THAT(result.err, AllOf(HasSubstr("no headless OpenGL"), HasSubstr("install libegl1")));
  EXPECT_FALSE(fs::exists(folder / "a.png"));
  expect_no_work(result);
}

TEST_F(Render, OpenGlThatIsTooOldExitsFiveWithAHint) {
  const Result result = render({"-o", "@a.png"}, {"MESA_GL_VERSION_OVERRIDE=3.3"});
  if (result.code == 0) GTEST_SKIP() << "this is not Mesa: its version cannot be lowered";
  EXPECT_EQ(result.code, 5) << result.err;
  EXPECT_THAT(result.err, AllOf(HasSubstr("no OpenGL 4.3 core context"), HasSubstr("install libegl1")));
  EXPECT_FALSE(fs::exists(folder / "a.png"));
  expect_no_work(result);
}

TEST_F(Render, APictureLargerThanMemoryIsASentence) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "the sanitizer reserves more memory than the limit";
#endif
  // 16384 x 16384 pixels are 4 GiB; 3 GB are to be had.
  folder.write("h.obj", "v 0 0 0\nv 0 0.1 0\nv 0 0.2 0\nl 1 2 3\n");
  folder.write("a.png", "earlier");
  for (const std::string method : {"truth", "unshadowed"}) {
    const std::string command = "ulimit -v 3000000; exec \"$0\" render \"$1\" --method " + method +
                                " --samples 1 --supersampling 1 --size 16384x16384 -o \"$2\"";
    const Result result = Child(folder, {"-c", command, PELAGE_PROGRAM, "@h.obj", "@a.png"}, {}, "/bin/sh").wait();
    if (result.code == 5) GTEST_SKIP() << result.err;
    EXPECT_EQ(result.code, 1) << method << ": " << result.err;
    EXPECT_THAT(result.err, HasSubstr("pelage: out of memory\n")) << method;
    EXPECT_EQ(text_of(folder / "a.png"), "earlier");
    EXPECT_EQ(folder.entries(), 4U) << "h.obj, a.png, stdout, stderr";
  }
}

TEST_F(Render, InterruptedBakeResumes) {
  // Records of 1/2 MB that take long to trace.
  nlohmann::json scene = {{"version", 1},
                          {"hair", kExamples + "lock.hairstyle.json"},
                          {"method", "satf"},
                          {"bake",
                           {{"sectors", 800},
                            {"views", 64},
                            {"lights", 64},
                            {"samples", 128},
                            {"grid", 128},
                            {"sigma", 0.02},
                            {"max_path", 16}}}};
  folder.write("slow.scene.json", scene.dump());
  folder.write("a.png", "earlier");
  const Options slow{"render", "@slow.scene.json", "-o", "@a.png", "--size", "64x48", "-j", "1"};
  const auto stored_bytes = [&]() -> std::uintmax_t {
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(folder / "cache", none))
      if (entry.path().extension() == ".partial") return entry.file_size(none);
    return 0;
  };
  // As long as it takes, however slow the machine and the build: the program ends, or ctest's time is up.
  const auto wait_for = [&](const Child& child, std::uintmax_t bytes, std::uintmax_t least) {
    while (child.is_running() && stored_bytes() < bytes) {
      if (stored_bytes() < least) return false;
      usleep(5'000);
    }
    return stored_bytes() >= bytes;
  };
  Child child(folder, slow);
  const bool baking = wait_for(child, 2'000'000, 0);
  child.signal(SIGINT);
  const Result result = child.wait();
  if (result.code == 5) GTEST_SKIP() << result.err;
  ASSERT_TRUE(baking);
  EXPECT_EQ(result.code, 130) << result.err;
  EXPECT_THAT(result.err, HasSubstr("interrupted"));
  EXPECT_EQ(text_of(folder / "a.png"), "earlier");
  const std::uintmax_t kept = stored_bytes();
  ASSERT_GE(kept, 2'000'000U) << "the work done is kept";
  Child again(folder, slow);
  EXPECT_TRUE(wait_for(again, kept + 2'000'000, kept)) << "goes on from there: never below what was kept";
  again.signal(SIGTERM);
  EXPECT_EQ(again.wait().code, 130);
  EXPECT_GT(stored_bytes(), kept);
}

TEST_F(Render, ACacheThatCannotBeWrittenIsNoReasonToStop) {
  fs::create_directory(folder / "tmp");
  folder.write("file", "");
  const std::string tmp = "TMPDIR=" + (folder / "tmp").string();
  const Result result = render({"-o", "@a.png"}, {"PELAGE_CACHE=" + (folder / "file" / "cache").string(), tmp});
  if (result.code == 5) GTEST_SKIP() << result.err;
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("the database is not kept"));
  EXPECT_GT(coverage(read_image(folder / "a.png")), 0.02);
  EXPECT_TRUE(fs::is_empty(folder / "tmp"));
}

}  // namespace
}  // namespace pelage::test
