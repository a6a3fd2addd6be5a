// Baking: the same bytes whatever happens on the way; the program's libraries; the ladder. HARD_CASES 16, 18.
#include "pelage/bake/bake_pipeline.h"

#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <chrono>
#include <memory>
#include <thread>

#include "fixtures.h"
#include "pelage/bake/verify.h"
#include "pelage/data_schema/errors.h"
#include "run_program.h"

namespace pelage {
namespace {

using namespace fixtures;
using testing::HasSubstr;

BakeSettings quick_settings() {
  BakeSettings s = small_settings();
  s.sectors = 150;
  return s;
}

TEST(BakePipeline, SameBytesForAnyNumberOfThreads) {
  const Folder folder;
  const Hairstyle style = hand_made_style(2, 40, 1);
  for (const Hairstyle* from : {static_cast<const Hairstyle*>(nullptr), &style}) {
    std::string first;
    for (const std::size_t threads : {1U, 2U, 3U, 8U}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      bake_database(quick_settings(), from, folder / "x.hrir", {});
      const std::string bytes = bytes_of(folder / "x.hrir");
      if (first.empty()) first = bytes;
      EXPECT_TRUE(bytes == first) << threads << " threads";
    }
  }
}

TEST(BakePipeline, InterruptedAndResumedIsAsUndisturbed) {
  const Folder folder;
  const Hairstyle style = hand_made_style(2, 40, 1);
  for (const Hairstyle* from : {static_cast<const Hairstyle*>(nullptr), &style}) {
    bake_database(quick_settings(), from, folder / "undisturbed", {});
    std::uint64_t last = 0;
    for (const std::uint64_t stop : {1U, 37U, 64U, 65U, 100U}) {
      EXPECT_THROW(bake_database(quick_settings(), from, folder / "x",
                                 [&](std::uint64_t done, std::uint64_t) {
                                   EXPECT_GT(done, last);
                                   if (done >= stop && done > last) throw Interrupted("stop");
                                 }),
                   Interrupted);
      last = 0;
    }
    const BakeResult result = bake_database(quick_settings(), from, folder / "x", {});
    EXPECT_GE(result.resumed, 100U);
    EXPECT_TRUE(bytes_of(folder / "x") == bytes_of(folder / "undisturbed"));
    EXPECT_FALSE(std::filesystem::exists(folder / "x.partial"));
  }
}

/// Returns when `file` has been seen to change `times` times, or after a minute.
void wait_for_writes(const std::filesystem::path& file, int times) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  std::error_code absent;
  auto last = std::filesystem::last_write_time(file, absent);
  while (times > 0 && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::microseconds(500));
    const auto now = std::filesystem::last_write_time(file, absent);
    if (now != last) --times;
    last = now;
  }
}

TEST(BakePipeline, KilledAndResumedIsAsUndisturbed) {
  const Folder folder;
  BakeSettings settings = quick_settings();
  settings.sectors = 3000;
  const auto x = folder / "x";
  // A program of its own: a fork of this one would lack TBB's threads.
  write_bytes(folder / "bake.json", to_json(settings));
  const std::string json = (folder / "bake.json").string();
  for (const int writes : {1, 4, 9}) {  // of some 47, one for every 64 sectors
    const pid_t child = fork();
    if (child == 0) {
      execl(PELAGE_BAKE, PELAGE_BAKE, "build", "--settings", json.c_str(), "--progress", "never", "-j", "2", "-o",
            x.c_str(), static_cast<char*>(nullptr));
      _exit(127);
    }
    wait_for_writes(folder / "x.partial-wal", writes);
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status)) << "it ended before it was killed: more sectors are needed";
  }
  EXPECT_FALSE(std::filesystem::exists(x));
  bake_database(settings, nullptr, x, {});
  bake_database(settings, nullptr, folder / "undisturbed", {});
  EXPECT_TRUE(bytes_of(x) == bytes_of(folder / "undisturbed"));
}

TEST(BakePipeline, RecordsDoNotDependOnHowManyAreBaked) {
  const Folder folder;
  BakeSettings settings = quick_settings();
  bake_database(settings, nullptr, folder / "many", {});
  settings.sectors = 9;
  bake_database(settings, nullptr, folder / "few", {});
  std::vector<StoredSector> many;
  DatabaseReader(folder / "many").for_each([&](std::uint64_t, const SectorView& s) { many.push_back(copy_of(s)); });
  DatabaseReader(folder / "few").for_each([&](std::uint64_t id, const SectorView& row) {
    const StoredSector s = copy_of(row);
    EXPECT_EQ(s.re.bytes, many[id].re.bytes);
    EXPECT_EQ(s.crossings, many[id].crossings);
  });
}

TEST(BakePipeline, AHairstyleHasNoMoreRecordsThanSectorsWithStrands) {
  const Folder folder;
  const Hairstyle style = hand_made_style(1, 3, 1);
  BakeSettings settings = small_settings();
  settings.sectors = 100000;
  const BakeResult result = bake_database(settings, &style, folder / "x", {});
  EXPECT_GT(result.records, 10U);
  EXPECT_LT(result.records, 1000U);
  const DatabaseReader reader(folder / "x");
  EXPECT_EQ(reader.metadata().source, "hairstyle");
  EXPECT_EQ(reader.metadata().source_name, "hand-made");
  EXPECT_EQ(reader.metadata().source_hash, hairstyle_hash(style));
  EXPECT_NE(hairstyle_hash(style), hairstyle_hash(hand_made_style(1, 3, 2)));
}

TEST(BakePipeline, AHairstyleWithoutStrandsIsRefused) {
  const Folder folder;
  const Hairstyle bald = hand_made_style(1, 0, 1);
  EXPECT_THAT(message_of<InputError>([&] { bake_database(small_settings(), &bald, folder / "x", {}); }),
              HasSubstr("nothing to bake"));
  EXPECT_FALSE(std::filesystem::exists(folder / "x.partial"));
}

TEST(Verify, RetracingFindsTheStoredRecords) {
  const Folder folder;
  for (const Storage storage : {Storage::u8, Storage::half}) {
    bake_database(small_settings(storage), nullptr, folder / "x", {});
    const RetraceResult result = retrace(DatabaseReader(folder / "x"), 5);
    EXPECT_EQ(result.records, 5U);
    EXPECT_LE(std::max(result.worst_tau, result.worst_re), 1.0);
    EXPECT_GT(std::min(result.worst_tau, result.worst_re), 0.5);  // rounding is there, so it was compared
  }
}

TEST(Verify, TheLadderEndsAtDirectAndADatabaseBeatsTheMean) {
  const Folder folder;
  const Hairstyle style = hand_made_style(2, 40, 1);
  bake_database(quick_settings(), &style, folder / "x", {});
  const auto ladder = accuracy_ladder(std::make_shared<const RecordBank>(folder / "x"), style, {200, 4});
  EXPECT_EQ(ladder.front().name, "predict the mean");
  EXPECT_EQ(ladder.back().name, "direct");
  EXPECT_EQ(ladder.back().radiance_rmse, 0);
  for (std::size_t i = 1; i + 1 < ladder.size(); ++i) {
    if (ladder[i].name.find("profile11") != std::string::npos) {
      EXPECT_LT(ladder[i].radiance_rmse, ladder.front().radiance_rmse) << ladder[i].name;
    }
    EXPECT_GT(ladder[i].radiance_rmse, 0) << ladder[i].name;
    // The sector's own opacity is what direct tracing sees, up to its grid and border.
    if (ladder[i].name.find("own alpha") != std::string::npos) {
      EXPECT_LT(ladder[i].alpha_rmse, 0.05) << ladder[i].name;
    }
  }
}

TEST(Program, RefusesSeedsThatJsonCannotHold) {
  const Folder folder;
  const std::string file = (folder / "x.hrir").string();
  const std::string build = PELAGE_BAKE " build --sectors 1 -o " + file + " --seed ";
  for (const char* bad : {"9007199254740992", "18446744073709551615", "-1"}) {
    const auto [text, code] = run_program(build + bad);
    EXPECT_THAT(text, HasSubstr(bad + std::string(" is out of range: give a number in [0, 9007199254740991]")));
    EXPECT_EQ(code, 2);
    EXPECT_FALSE(std::filesystem::exists(file));
  }
  EXPECT_EQ(run_program(build + "1.5").code, 2);
  EXPECT_EQ(run_program(build + "9007199254740991").code, 0);
  EXPECT_EQ(DatabaseReader(file).metadata().settings.seed, kLargestSeed);
}

TEST(Program, LinksNoOpenGlAndNoOpenImageIo) {
  const std::string needed = run_program("readelf -d " PELAGE_BAKE " | grep NEEDED").text;
  EXPECT_THAT(needed, HasSubstr("libsqlite3"));
  for (const char* library : {"GL", "epoxy", "glfw", "OpenImageIO", "embree", "hdf5", "mpi", "flann"}) {
    EXPECT_THAT(needed, testing::Not(HasSubstr(library)));
  }
}

}  // namespace
}  // namespace pelage
