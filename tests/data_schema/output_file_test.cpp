// Hard cases 32 and 34: an output path that is missing, not writable, a folder or an input; an interrupted writer.
#include "pelage/data_schema/output_file.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include "pelage/data_schema/errors.h"
#include "temporary.h"

namespace pelage {
namespace {

using test::message_of;
using test::TemporaryFolder;
using test::text_of;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

TEST(OutputFile, PathThatCannotBeWrittenIsRefusedWithTheRemedy) {
  const test::TemporaryFolder folder;
  const auto message = [](const fs::path& path) { return message_of<OutputError>([&] { check_writable(path); }); };
  EXPECT_THAT(message(folder / "missing/out.png"), HasSubstr("create it first"));
  EXPECT_THAT(message(folder / ""), HasSubstr("is a folder: name a file in it"));
  EXPECT_THAT(message(folder / "."), HasSubstr("is a folder"));
  EXPECT_THAT(message("/dev/null"), HasSubstr("is a device"));
  EXPECT_THAT(message(""), HasSubstr("the path is empty"));
  EXPECT_THAT(message(folder.write("file", "x") / "out.png"), HasSubstr("there is no folder"));
  EXPECT_NO_THROW(check_writable(folder / "out.png"));
  EXPECT_EQ(folder.entries(), 1U) << "checking leaves nothing behind";
}

TEST(OutputFile, ReadOnlyFileAndFolderAreRefused) {
  if (geteuid() == 0) GTEST_SKIP() << "root may write anywhere";
  const test::TemporaryFolder folder;
  const fs::path file = folder.write("out.png", "old");
  chmod(file.c_str(), 0444);
  EXPECT_THAT(message_of<OutputError>([&] { check_writable(file); }), HasSubstr("is not writable"));
  chmod((folder / "").c_str(), 0555);
  EXPECT_THAT(message_of<OutputError>([&] { check_writable(folder / "new"); }), HasSubstr("folder is not writable"));
  chmod((folder / "").c_str(), 0755);
}

TEST(OutputFile, OverAnInputIsRefusedWithBothSpellings) {
  const test::TemporaryFolder folder;
  const fs::path in = folder.write("in.json", "x"), out = folder / "out.json", here = folder / ".";
  const auto message = [&](const Output& output, const fs::path& input) {
    return message_of<UsageError>([&] { check_apart(std::vector{output}, std::vector<NamedFile>{{"--head", input}}); });
  };
  const std::string nothing = "nothing was thrown";
  EXPECT_EQ(message({"-o", in, ""}, here / "in.json"),
            in.string() + ": -o would write over --head (" + (here / "in.json").string() + "): name another file");
  EXPECT_EQ(message({"-o", in, ""}, in), in.string() + ": -o would write over --head: name another file");
  EXPECT_EQ(message({"-o", out, ""}, in), nothing);
  EXPECT_EQ(message({"-o", out, ""}, out), nothing) << "its reader says that it is not there";
  fs::create_symlink("loop", folder / "loop");
  EXPECT_EQ(message({"-o", folder / "loop", ""}, in), nothing) << "check_writable says so";
  EXPECT_EQ(message({"-o", out, ""}, folder / "loop"), nothing);
  EXPECT_THAT(message({"-o", here, R"(i\w\.json)"}, in), HasSubstr("/in.json: -o would write over --head"));
  EXPECT_EQ(message({"-o", here, R"(i\w)"}, in), nothing) << "another name";
  EXPECT_EQ(message({"-o", out, ".*"}, in), nothing) << "another folder";
}

TEST(OutputFile, FileAppearsWholeOnCommit) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.write("out.json", "old");
  AtomicFile out(file);
  out.write("new");
  EXPECT_EQ(test::text_of(file), "old");
  EXPECT_EQ(out.temporary().extension(), ".json") << "libraries choose the format by it";
  out.commit();
  EXPECT_EQ(test::text_of(file), "new");
  EXPECT_EQ(folder.entries(), 1U);
}

TEST(OutputFile, WhatALibraryLeavesBesideTheTemporaryGoesToo) {
  const test::TemporaryFolder folder;
  {
    const AtomicFile out(folder / "out.hrir");
    std::ofstream(out.temporary().string() + "-journal") << "x";
    EXPECT_EQ(folder.entries(), 1U);
  }
  EXPECT_EQ(folder.entries(), 0U);
}

TEST(OutputFile, AbandonedWriteKeepsTheOldFileAndNoTemporary) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.write("out.json", "old");
  EXPECT_THROW(
      {
        AtomicFile out(file);
        out.write("half");
        throw Interrupted("interrupted");
      },
      Interrupted);
  EXPECT_EQ(test::text_of(file), "old");
  EXPECT_EQ(folder.entries(), 1U);
}

TEST(OutputFile, SymbolicLinkStaysALink) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.write("real", "old");
  fs::create_symlink("real", folder / "link");
  AtomicFile out(folder / "link");
  out.write("new");
  out.commit();
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(test::text_of(file), "new");
}

TEST(OutputFile, FullDiskIsReported) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  const test::TemporaryFolder folder;
  AtomicFile out(folder / "out");
  fs::remove(out.temporary());
  fs::create_symlink("/dev/full", out.temporary());
  EXPECT_THAT(message_of<OutputError>([&] { out.write("x"); }), HasSubstr("cannot write: No space left"));
}

TEST(OutputFile, AChainOfLinksToNothingYetMakesItsEnd) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "sub");
  std::filesystem::create_symlink("sub/b", folder / "a");
  std::filesystem::create_symlink("c", folder / "sub" / "b");
  AtomicFile out(folder / "a");
  out.write("text");
  out.commit();
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "a"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "sub" / "b"));
  EXPECT_EQ(text_of(folder / "sub" / "c"), "text");
  std::filesystem::create_symlink("loop", folder / "loop");
  EXPECT_THROW(AtomicFile(folder / "loop").commit(), OutputError);
}

TEST(OutputFile, StaleTemporariesGoAndNothingElse) {
  const TemporaryFolder folder;
  for (const char* stale : {".a.hrir.123-0.part", ".a.hrir.9-12.part"}) {
    std::filesystem::create_directory(folder / stale);
    std::ofstream(folder / stale / "a.hrir") << "left";
  }
  for (const char* other : {".b.hrir.123-0.part", ".a.hrir.mine.part", "a.hrir.123-0.part", ".a.hrir.123-0"})
    std::filesystem::create_directory(folder / other);
  folder.write("a.hrir", "kept");
  remove_stale_temporaries(folder / "a.hrir");
  EXPECT_EQ(folder.entries(), 5U);
  EXPECT_EQ(text_of(folder / "a.hrir"), "kept");
  remove_stale_temporaries(folder / "absent" / "a.hrir");
}

}  // namespace
}  // namespace pelage
