// Output files where the disk refuses: a limit on file sizes stands for a full disk in every writer, and paths that no
// one may write. Each time a sentence, the earlier file as it was, nothing left behind. HARD_CASES 32.
#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <functional>

#include "../app/child.h"
#include "../fuzz/tiny_database.h"
#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/hairstyle.h"
#include "pelage/data_schema/procedural_strands.h"
#include "pelage/hair/hair_file.h"
#include "pelage/hair/head.h"
#include "pelage/hair/mesh_obj.h"

namespace pelage {
namespace {

using test::TemporaryFolder;
using test::text_of;
using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr const char* kEarlier = "an earlier file";

/// What `action` says when it throws OutputError, run in a process of its own after `prepare`; "" when it succeeds.
std::string said_in_child(const std::function<void()>& prepare, const std::function<void()>& action) {
  int ends[2];
  if (pipe(ends) != 0) return "no pipe";
  const pid_t child = fork();
  if (child == 0) {
    prepare();
    std::string said;
    try {
      action();
    } catch (const OutputError& e) {
      said = e.what();
    } catch (const std::exception& e) {
      said = std::string("of another type: ") + e.what();
    }
    const bool written = write(ends[1], said.data(), said.size()) == static_cast<ssize_t>(said.size());
    _exit(written ? 0 : 1);
  }
  close(ends[1]);
  std::string said(4096, '\0');
  said.resize(static_cast<std::size_t>(std::max<ssize_t>(0, read(ends[0], said.data(), said.size()))));
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  return status == 0 ? said : "the process ended with status " + std::to_string(status);
}

void limit_file_size(std::size_t bytes) {
  const rlimit limit{bytes, bytes};
  setrlimit(RLIMIT_FSIZE, &limit);
  std::signal(SIGXFSZ, SIG_IGN);
}

Strands three_strands() {
  Strands s;
  for (int i = 0; i < 3; ++i)
    s.append(std::vector<glm::vec3>{{0.01F * static_cast<float>(i), 0, 0}, {0, 0.05F, 0}, {0, 0.1F, 0.01F}});
  return s;
}

struct Writer {
  std::string name;
  std::function<void(const fs::path&)> write;
};

std::vector<Writer> writers() {
  const Strands strands = three_strands();
  const Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}, {{0, 1, 2}}};
  const Hairstyle style = load_hairstyle(test::kExamples + "lock.hairstyle.json");
  return {
      {"x.hair", [=](const fs::path& file) { hair::write_hair(strands, file); }},
      {"x.obj", [=](const fs::path& file) { hair::write_obj(mesh, file); }},
      {"x.json", [=](const fs::path& file) { save_hairstyle(style, file); }},
      {"x.hrir", [](const fs::path& file) { fuzz::write_tiny_database(file, fuzz::tiny_settings(Storage::u8, 3)); }}};
}

TEST(FullDisk, EveryWriterKeepsTheEarlierFile) {
  for (const Writer& writer : writers()) {
    const TemporaryFolder folder;
    const fs::path file = folder / writer.name;
    writer.write(file);
    const std::string whole = text_of(file);
    for (const std::size_t limit : {std::size_t{0}, std::size_t{1}, whole.size() / 2, whole.size() - 1}) {
      SCOPED_TRACE(writer.name + ", limit of " + std::to_string(limit) + " of " + std::to_string(whole.size()));
      folder.write(writer.name, kEarlier);
      const std::string said = said_in_child([&] { limit_file_size(limit); }, [&] { writer.write(file); });
      EXPECT_THAT(said, HasSubstr(writer.name));
      EXPECT_THAT(said, testing::Not(HasSubstr("of another type")));
      EXPECT_EQ(text_of(file), kEarlier);
      fs::remove(file.string() + ".partial");  // what a bake resumes from; no more than that is there
      fs::remove(file.string() + ".partial-wal");
      EXPECT_EQ(folder.entries(), 1U);
    }
    writer.write(file);
    EXPECT_TRUE(text_of(file) == whole);
  }
}

TEST(Paths, ThatNobodyMayWriteAreRefused) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "sub");
  chmod((folder / "sub").c_str(), 0555);
  chmod((folder / "").c_str(), 0755);
  const auto as_nobody = [] {
    if (geteuid() == 0 && (setgid(65534) != 0 || setuid(65534) != 0)) _exit(2);
  };
  for (const Writer& writer : writers()) {
    SCOPED_TRACE(writer.name);
    const auto said = [&](const fs::path& path) { return said_in_child(as_nobody, [&] { writer.write(path); }); };
    EXPECT_THAT(said(folder / "missing" / writer.name), HasSubstr("there is no folder"));
    EXPECT_THAT(said(folder / "sub" / writer.name), HasSubstr("not writable"));
    EXPECT_THAT(said(folder / "sub"), HasSubstr("is a folder: name a file in it"));
    EXPECT_THAT(said(""), HasSubstr("the path is empty"));
    EXPECT_THAT(said("/dev/null"), HasSubstr("is a device"));
    EXPECT_THAT(said("/proc/" + writer.name), testing::Not(testing::IsEmpty()));
  }
  EXPECT_EQ(folder.entries(), 1U);
  EXPECT_TRUE(fs::is_empty(folder / "sub"));
}

TEST(Paths, TheProgramRefusesBeforeTheWork) {
  const TemporaryFolder folder;
  for (const char* path : {"@missing/x.hrir", "@", "/dev/null", "/proc/x.hrir"}) {
    const test::Result result = test::run(folder, {"build", "--sectors", "1000000", "-o", path});
    EXPECT_EQ(result.code, 1) << path;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  }
  EXPECT_EQ(folder.entries(), 2U) << "stdout and stderr";
}

}  // namespace
}  // namespace pelage
