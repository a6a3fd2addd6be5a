// Every write of a bake fails once: disk full, I/O error, half a page written. A sentence comes out, the earlier file
// stays or the whole new one is there, no temporary is left, and the next bake resumes to the same bytes. The same
// where the process is killed at every write, but for the sentence and the temporary. HARD_CASES 16, 32.
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "../data_schema/temporary.h"
#include "../fuzz/tiny_database.h"
#include "faulty_vfs.h"
#include "pelage/bake/bake_pipeline.h"
#include "pelage/data_schema/errors.h"

namespace pelage {
namespace {

using faults::Kind;
using faults::Plan;
using test::TemporaryFolder;
using test::text_of;
namespace fs = std::filesystem;

constexpr const char* kEarlier = "an earlier file";

class DatabaseWrites : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    static const bool once = (faults::install(), true);
    static_cast<void>(once);
  }
  void TearDown() override { faults::arm({}); }
};
class DatabaseWritesThatFail : public DatabaseWrites, public testing::WithParamInterface<Plan> {};

std::vector<std::string> temporaries(const TemporaryFolder& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder / ""))
    if (const std::string name = entry.path().filename().string(); name != "x" && !name.starts_with("x.partial"))
      names.push_back(name);
  return names;
}

/// `bake` with the plan's k-th operation failing, then undisturbed.
template <class Bake>
void fail_and_resume(const Bake& bake, const Plan& plan, const std::string& expected) {
  const TemporaryFolder folder;
  const fs::path file = folder.write("x", kEarlier);
  faults::arm(plan);
  try {
    bake(file);
    EXPECT_TRUE(text_of(file) == expected) << "nothing was said and the file is another";
  } catch (const OutputError& e) {
    EXPECT_GT(std::string(e.what()).size(), 30U) << e.what();
    const std::string now = text_of(file);
    EXPECT_TRUE(now == kEarlier || now == expected)
        << "neither the earlier file nor the finished one, after: " << e.what();
  }  // any other exception fails the test
  faults::arm({});
  EXPECT_THAT(temporaries(folder), testing::IsEmpty());
  bake(file);
  EXPECT_TRUE(text_of(file) == expected) << "resumed to other bytes";
  EXPECT_EQ(folder.entries(), 1U);
}

/// Every `step`-th operation of `bake` fails.
template <class Bake>
void fail_each(const Bake& bake, Plan plan, long step) {
  const TemporaryFolder folder;
  faults::arm({});
  bake(folder / "x");
  const long operations = faults::operations();
  const std::string expected = text_of(folder / "x");
  ASSERT_GT(operations, 20);
  for (plan.fail_at = 1; plan.fail_at <= operations; plan.fail_at += step) {
    SCOPED_TRACE("operation " + std::to_string(plan.fail_at) + " of " + std::to_string(operations));
    ASSERT_NO_THROW(fail_and_resume(bake, plan, expected));
    if (testing::Test::HasFailure()) return;
  }
}

TEST_F(DatabaseWrites, EachMayBeTheLastOfAKilledProcess) {
  const BakeSettings settings = fuzz::tiny_settings(Storage::u8, 140);
  const TemporaryFolder folder;
  faults::arm({});
  fuzz::write_tiny_database(folder / "expected", settings);
  const long operations = faults::operations();
  const std::string expected = text_of(folder / "expected");
  for (Plan plan{1, Kind::killed}; plan.fail_at <= operations; ++plan.fail_at) {
    SCOPED_TRACE("operation " + std::to_string(plan.fail_at) + " of " + std::to_string(operations));
    const fs::path file = folder.write("x", kEarlier);
    const pid_t child = fork();
    if (child == 0) {
      faults::arm(plan);
      fuzz::write_tiny_database(file, settings);
      _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
    const std::string now = text_of(file);
    ASSERT_TRUE(now == kEarlier || now == expected);
    faults::arm({});
    ASSERT_NO_THROW(fuzz::write_tiny_database(file, settings));
    ASSERT_TRUE(text_of(file) == expected) << "resumed to other bytes";
    ASSERT_FALSE(fs::exists(folder / "x.partial"));
  }
}

TEST_P(DatabaseWritesThatFail, EachMayFail) {
  const BakeSettings settings = fuzz::tiny_settings(Storage::u8, 70);  // two transactions
  fail_each([&](const fs::path& file) { fuzz::write_tiny_database(file, settings); }, GetParam(), 1);
}

TEST_P(DatabaseWritesThatFail, SomeOfABakeMayFail) {
  const BakeSettings settings = fuzz::tiny_settings(Storage::half, 20);
  fail_each([&](const fs::path& file) { bake_database(settings, nullptr, file, {}); }, GetParam(), 5);
}

std::string name_of(const testing::TestParamInfo<Plan>& plan) {
  const char* kinds[] = {"DiskFull", "InputOutput", "ShortWrite"};
  return std::string(kinds[static_cast<int>(plan.param.kind)]) + (plan.param.stay_broken ? "FromThenOn" : "Once");
}

INSTANTIATE_TEST_SUITE_P(Plans, DatabaseWritesThatFail,
                         testing::Values(Plan{0, Kind::disk_full, true}, Plan{0, Kind::disk_full, false},
                                         Plan{0, Kind::input_output, true}, Plan{0, Kind::input_output, false},
                                         Plan{0, Kind::short_write, true}, Plan{0, Kind::short_write, false}),
                         name_of);

}  // namespace
}  // namespace pelage
