// A bake that is killed (kill -9) at any moment, again and again, and one that is interrupted (Ctrl-C): the next one
// goes on, and the file ends up with the bytes of an undisturbed bake. HARD_CASES 16, 32.
//
// Moments are drawn from a fixed seed and scaled to what an undisturbed bake took here: some anywhere in it, some in
// the middle of a write, which is short, and some while the finished file is made (VACUUM INTO a temporary file, then
// rename), which is short too. PELAGE_KILLS and PELAGE_KILL_SEED make a campaign of it (scripts/kill-campaign.sh).
#include <gmock/gmock.h>

#include <chrono>
#include <iostream>
#include <random>
#include <set>
#include <thread>

#include "../app/child.h"

namespace pelage {
namespace {

using test::Child;
using test::Result;
using test::TemporaryFolder;
using testing::HasSubstr;
using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;
namespace fs = std::filesystem;

constexpr const char* kSettings =
    R"({"version": 1, "sectors": 1500, "grid": 16, "views": 12, "lights": 32, "samples": 16})";

unsigned number_from(const char* variable, unsigned otherwise) {
  const char* text = std::getenv(variable);
  return text == nullptr ? otherwise : static_cast<unsigned>(std::stoul(text));
}

/// `pelage-bake build` of the same database, always in the same folder.
class Bake {
 public:
  Bake() {
    folder_.write("bake.json", kSettings);
    const Clock::time_point start = Clock::now();
    const Child child = begin();
    wait_for_finish(start + std::chrono::minutes(5));
    rows_s_ = Seconds(Clock::now() - start).count();
    const Result result = child.wait();
    finish_s_ = Seconds(Clock::now() - start).count() - rows_s_;
    EXPECT_EQ(result.code, 0) << result.err;
    undisturbed_ = test::text_of(file());
    remove();
  }

  Child begin() const {
    return {folder_, {"build", "--settings", "@bake.json", "--progress", "never", "-j", "2", "-o", "@x.hrir"}};
  }
  fs::path file() const { return folder_ / "x.hrir"; }
  void remove() const { fs::remove(file()); }
  double rows_s() const { return rows_s_; }
  double finish_s() const { return finish_s_; }
  bool is_as_undisturbed() const { return test::text_of(file()) == undisturbed_ && !undisturbed_.empty(); }
  bool has_partial() const { return fs::exists(folder_ / "x.hrir.partial"); }

  /// Returns when a file of the partial database has changed `times` times, or the finished one is being made.
  void wait_for_writes(int times) const {
    const auto change = [&] {
      // Not {}: libstdc++ counts file times from the year 2174, so that is later than any.
      std::pair<fs::file_time_type, std::uintmax_t> latest{fs::file_time_type::min(), 0};
      for (const char* suffix : {"", "-wal", "-journal"}) {
        std::error_code absent;
        const fs::path part = file().string() + ".partial" + suffix;
        latest = std::max(latest, {fs::last_write_time(part, absent), fs::file_size(part, absent) + 1});
      }
      return latest;
    };
    auto last = change();
    for (unsigned look = 1; times > 0 && (look % 64 != 0 || !finishing()); ++look) {
      const auto now = change();
      if (now != last) --times;
      last = now;
    }
  }

  /// Is the finished file being made, or made?
  bool finishing() const {
    std::error_code gone;
    for (const auto& entry : fs::directory_iterator(folder_ / "", gone)) {
      const std::string name = entry.path().filename().string();
      if (name == "x.hrir" || (name.starts_with(".x.hrir.") && !known_.contains(name))) return true;
    }
    return false;
  }
  void wait_for_finish(Clock::time_point until) const {
    while (Clock::now() < until && !finishing()) std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  /// Temporaries of killed bakes: nobody could remove them in time.
  void note_leftovers() {
    for (const auto& entry : fs::directory_iterator(folder_ / ""))
      if (const std::string name = entry.path().filename().string(); name.starts_with(".x.hrir.")) known_.insert(name);
  }
  std::size_t entries() const { return folder_.entries(); }

 private:
  TemporaryFolder folder_;
  std::set<std::string> known_;
  double rows_s_ = 0, finish_s_ = 0;
  std::string undisturbed_;
};

void sleep_for(double seconds) {
  std::this_thread::sleep_for(Seconds(seconds));
}

TEST(Killed, ResumesToTheSameBytes) {
  const unsigned kills = number_from("PELAGE_KILLS", 20);
  std::mt19937 random(number_from("PELAGE_KILL_SEED", 1));
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  Bake bake;
  unsigned killed = 0, while_writing = 0, while_finishing = 0, finished = 0;
  for (unsigned round = 0; killed < kills && round < 20 * kills; ++round) {
    const Child child = bake.begin();
    const double moment = unit(random), aim = unit(random);
    const bool finishing = aim < 0.3;
    bool writing = !finishing && aim < 0.6;
    if (finishing) {
      bake.wait_for_finish(Clock::now() + std::chrono::minutes(5));
      sleep_for(1.2 * moment * bake.finish_s());
    } else if (writing) {
      bake.wait_for_writes(1 + static_cast<int>(60 * moment));
      writing = !bake.finishing();  // else there were fewer
    } else {
      sleep_for(0.8 * moment * bake.rows_s());
    }
    child.signal(SIGKILL);
    const Result result = child.wait();
    ASSERT_TRUE(result.code == 0 || result.code == -SIGKILL) << "exit code " << result.code << ": " << result.err;
    if (result.code != 0) {
      ++killed;
      while_writing += writing;
      while_finishing += finishing;
    }
    if (!fs::exists(bake.file())) {
      ASSERT_NE(result.code, 0);
      bake.note_leftovers();
      continue;
    }
    // Renamed: whole, even where the kill came before the partial file was removed.
    ASSERT_TRUE(bake.is_as_undisturbed()) << "after " << killed << " kills";
    if (result.code == 0) {
      ASSERT_FALSE(bake.has_partial());
    }
    ++finished;
    bake.remove();
  }
  const Result last = bake.begin().wait();
  EXPECT_EQ(last.code, 0) << last.err;
  EXPECT_TRUE(bake.is_as_undisturbed());
  EXPECT_FALSE(bake.has_partial());
  std::cout << killed << " kills, " << while_writing << " of them at a write, " << while_finishing
            << " while the file was finished; " << finished + 1 << " databases completed, all the same\n";
  EXPECT_EQ(killed, kills) << "bakes ended before they were killed";
  EXPECT_GT(while_writing, 0U);
  EXPECT_GT(while_finishing, 0U);
  EXPECT_LT(while_writing + while_finishing, killed);
}

TEST(Interrupted, Exits130AndResumesToTheSameBytes) {
  const Bake bake;
  unsigned interrupted = 0;
  for (int round = 0; interrupted < 3 && round < 20; ++round) {
    const Child child = bake.begin();
    bake.wait_for_writes(3 + round % 4);
    child.signal(SIGINT);
    const Result result = child.wait();
    if (result.code == 0) {  // it was done before the signal came
      bake.remove();
      continue;
    }
    ++interrupted;
    EXPECT_EQ(result.code, 130) << result.err;
    EXPECT_THAT(result.err, HasSubstr("interrupted"));
    EXPECT_FALSE(fs::exists(bake.file()));
  }
  EXPECT_GT(interrupted, 0U);
  const Result last = bake.begin().wait();
  EXPECT_EQ(last.code, 0) << last.err;
  EXPECT_TRUE(bake.is_as_undisturbed());
  EXPECT_EQ(bake.entries(), 4U) << "settings, stdout, stderr, the database and nothing else";
}

/// What the system sends when a mapped file was cut off by somebody else.
TEST(CutFile, IsASentenceAndAnExitCode) {
  const Bake bake;
  Result result{0, "", ""};
  for (int round = 0; result.code == 0 && round < 20; ++round) {
    const Child child = bake.begin();
    bake.wait_for_writes(3);
    child.signal(SIGBUS);
    result = child.wait();
    if (result.code == 0) bake.remove();  // it was done before the signal came
  }
  EXPECT_EQ(result.code, 4);
  EXPECT_EQ(result.err, "a file was cut off or failed while it was being read: restore it and run again\n");
}

}  // namespace
}  // namespace pelage
