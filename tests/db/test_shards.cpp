// Shards: baked apart, merged to the bytes of one bake; every way to merge what does not belong together is refused.
#include <gmock/gmock.h>

#include "fixtures.h"
#include "pelage/bake/bake_pipeline.h"
#include "pelage/data_schema/errors.h"
#include "run_program.h"

namespace pelage {
namespace {

using namespace fixtures;
using testing::AllOf;
using testing::HasSubstr;

BakeSettings quick_settings() {
  BakeSettings s = small_settings();
  s.sectors = 137;
  return s;
}

using Files = std::vector<std::filesystem::path>;

class ShardTest : public testing::Test {
 protected:
  Files bake_shards(int count, const BakeSettings& settings = quick_settings(), const Hairstyle* style = nullptr,
                    const std::string& name = "shard") {
    Files files;
    for (int i = 1; i <= count; ++i) {
      files.push_back(folder_ / (name + std::to_string(i) + "of" + std::to_string(count)));
      bake_database(settings, style, files.back(), {}, Shard{i, count});
    }
    return files;
  }
  std::string merge_error(const Files& files) {
    return message_of<InputError>([&] { merge_shards(files, folder_ / "merged", {}); });
  }
  Folder folder_;
};

TEST_F(ShardTest, AnyNumberOfThemMergesToTheBytesOfOneBake) {
  const Hairstyle style = hand_made_style(2, 40, 1);
  for (const Hairstyle* from : {static_cast<const Hairstyle*>(nullptr), &style}) {
    bake_database(quick_settings(), from, folder_ / "whole", {});
    for (const int count : {1, 2, 5}) {
      Files shards = bake_shards(count, quick_settings(), from);
      std::reverse(shards.begin(), shards.end());
      std::uint64_t last = 0;
      merge_shards(shards, folder_ / "merged", [&](std::uint64_t done, std::uint64_t) { last = done; });
      EXPECT_TRUE(bytes_of(folder_ / "merged") == bytes_of(folder_ / "whole")) << count << " shards";
      EXPECT_EQ(last, DatabaseReader(folder_ / "whole").metadata().sectors);
      EXPECT_FALSE(std::filesystem::exists(folder_ / "merged.partial"));
    }
  }
}

TEST_F(ShardTest, RangesCoverAllRowsEvenly) {
  for (const std::uint64_t rows : {1U, 7U, 2000U}) {
    for (int n = 1; n <= static_cast<int>(std::min<std::uint64_t>(rows, 40)); ++n) {
      std::uint64_t next = 0;
      for (int i = 1; i <= n; ++i) {
        const RowRange range = shard_of(rows, i, n);
        EXPECT_EQ(range.first, next);
        EXPECT_GE(range.size(), rows / static_cast<std::uint64_t>(n));
        EXPECT_LE(range.size(), rows / static_cast<std::uint64_t>(n) + 1);
        next = range.end;
      }
      EXPECT_EQ(next, rows);
    }
  }
  EXPECT_THAT(message_of<UsageError>([] { shard_of(10, 0, 3); }), HasSubstr("shard 0/3: give i/n"));
  EXPECT_THAT(message_of<UsageError>([] { shard_of(10, 4, 3); }), HasSubstr("1 <= i <= n"));
  EXPECT_THAT(message_of<UsageError>([] { shard_of(2, 1, 3); }), HasSubstr("only 2 records"));
}

TEST_F(ShardTest, AShardAloneIsRefusedWithTheRemedy) {
  const Files shards = bake_shards(2);
  EXPECT_THAT(message_of<InputError>([&] { DatabaseReader{shards[1]}; }),
              AllOf(HasSubstr("is a shard, records 68 to 136 of 137"), HasSubstr("pelage-bake merge")));
  EXPECT_EQ(DatabaseReader(shards[1], Accept::unfinished).rows(), (RowRange{68, 137}));
}

TEST_F(ShardTest, MissingAndRepeatedRowsAreNamed) {
  const Files shards = bake_shards(5);
  EXPECT_THAT(merge_error({shards[0], shards[1], shards[3], shards[4]}),
              HasSubstr("records 54 to 81 are in none of the shards"));
  EXPECT_THAT(merge_error({shards[1], shards[2]}), HasSubstr("records 0 to 26 are in none"));
  EXPECT_THAT(merge_error({shards[0], shards[1], shards[2], shards[3]}), HasSubstr("records 109 to 136 are in none"));
  EXPECT_THAT(merge_error({shards[0], shards[0], shards[1]}),
              AllOf(HasSubstr("records 0 to 26 are also in"), HasSubstr("name each shard once")));
  EXPECT_THAT(message_of<UsageError>([&] { merge_shards({}, folder_ / "merged", {}); }),
              HasSubstr("name at least one"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "merged"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "merged.partial"));
}

TEST_F(ShardTest, WhatDiffersIsNamed) {
  const Files shards = bake_shards(2);
  BakeSettings other = quick_settings();
  other.phong.exponent = 9;
  const Files others = bake_shards(2, other, nullptr, "other");
  EXPECT_THAT(merge_error({shards[0], others[1]}), AllOf(HasSubstr("is of another bake"), HasSubstr("exponent"),
                                                         HasSubstr("shard1of2"), HasSubstr("other2of2")));
  const Hairstyle a = hand_made_style(2, 40, 1), b = hand_made_style(2, 40, 2);
  const Files of_a = bake_shards(2, quick_settings(), &a, "a"), of_b = bake_shards(2, quick_settings(), &b, "b");
  EXPECT_THAT(merge_error({of_a[0], of_b[1]}), HasSubstr("hairstyle hash"));
  EXPECT_THAT(merge_error({shards[0], of_b[1]}), HasSubstr("source is 'random' in"));
  DatabaseMetadata m = DatabaseReader(shards[1], Accept::unfinished).metadata();
  m.revision = "another build";
  {
    DatabaseWriter writer(folder_ / "rebuilt", m, {68, 137});
    DatabaseReader(shards[1], Accept::unfinished).for_each([&](std::uint64_t, const SectorView& s) {
      writer.append(s);
    });
    writer.finish();
  }
  EXPECT_THAT(merge_error({shards[0], folder_ / "rebuilt"}),
              AllOf(HasSubstr("program is '"), HasSubstr("'another build' in")));
}

TEST_F(ShardTest, DamageInAShardStopsTheMergeAndTheRestResumes) {
  const Files shards = bake_shards(2);
  bake_database(quick_settings(), nullptr, folder_ / "whole", {});
  const std::string good = bytes_of(shards[1]);
  std::string bad = good;
  bad[bad.size() - 3000] = static_cast<char>(bad[bad.size() - 3000] ^ 4);
  write_bytes(shards[1], bad);
  EXPECT_THAT(merge_error(shards), HasSubstr("shard2of2"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "merged"));
  write_bytes(shards[1], good);
  merge_shards(shards, folder_ / "merged", {});
  EXPECT_TRUE(bytes_of(folder_ / "merged") == bytes_of(folder_ / "whole"));
}

TEST_F(ShardTest, InterruptedShardAndMergeResume) {
  bake_database(quick_settings(), nullptr, folder_ / "whole", {});
  const auto stop_at = [](std::uint64_t at) {
    return [at](std::uint64_t done, std::uint64_t) {
      if (done >= at) throw Interrupted("stop");
    };
  };
  const auto shard2 = folder_ / "shard2of2";
  EXPECT_THROW(bake_database(quick_settings(), nullptr, shard2, stop_at(40), Shard{2, 2}), Interrupted);
  EXPECT_THAT(message_of<InputError>([&] {
                bake_database(quick_settings(), nullptr, shard2, {}, Shard{1, 2});
              }),
              HasSubstr("the part of the 137 records is 68 to 136 in the file, 0 to 67 now"));
  EXPECT_GE(bake_database(quick_settings(), nullptr, shard2, {}, Shard{2, 2}).resumed, 30U);
  const Files shards = bake_shards(2);
  EXPECT_THROW(merge_shards(shards, folder_ / "merged", stop_at(100)), Interrupted);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "merged.partial"));
  std::uint64_t first = 0;
  merge_shards(shards, folder_ / "merged",
               [&](std::uint64_t done, std::uint64_t) { first = first == 0 ? done : first; });
  EXPECT_GT(first, 60U);
  EXPECT_TRUE(bytes_of(folder_ / "merged") == bytes_of(folder_ / "whole"));
}

TEST_F(ShardTest, AnInterruptedShardMergesOnlyWhenItIsComplete) {
  const Files shards = bake_shards(2);
  const auto partial = folder_ / "x.partial";
  EXPECT_THROW(bake_database(
                   quick_settings(), nullptr, folder_ / "x",
                   [](std::uint64_t done, std::uint64_t) {
                     if (done > 30) throw Interrupted("stop");
                   },
                   Shard{1, 2}),
               Interrupted);
  EXPECT_THAT(merge_error({partial, shards[1]}), HasSubstr("is unfinished: it holds the records 0 to"));
}

// --- the program -----------------------------------------------------------------------------------------------------

class BakeProgram : public ShardTest {
 protected:
  void SetUp() override { write_bytes(folder_ / "bake.json", to_json(quick_settings())); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  Ran bake(const std::string& arguments) const { return run_program(PELAGE_BAKE " " + arguments); }
  std::string build() const { return "build --settings " + path("bake.json") + " -o " + path("x.hrir"); }
};

TEST_F(BakeProgram, ShardsAndMerges) {
  bake_database(quick_settings(), nullptr, folder_ / "whole", {});
  for (const char* i : {"1", "2", "3"}) {
    const Ran ran =
        bake("build --settings " + path("bake.json") + " --shard " + i + "/3 -o " + path("part" + std::string(i)));
    EXPECT_EQ(ran.code, 0) << ran.text;
    EXPECT_THAT(ran.text, HasSubstr("shard of records "));
  }
  EXPECT_THAT(bake("info " + path("part2")).text, HasSubstr("shard: records 45 to 90 of 137"));
  EXPECT_THAT(bake("verify " + path("part2")).text, HasSubstr("all 46 records pass"));
  const Ran gap = bake("merge " + path("part1") + " " + path("part3") + " -o " + path("merged"));
  EXPECT_EQ(gap.code, 4);
  EXPECT_THAT(gap.text, HasSubstr("records 45 to 90 are in none"));
  const Ran ran = bake("merge " + path("part3") + " " + path("part1") + " " + path("part2") + " -o " + path("merged"));
  EXPECT_EQ(ran.code, 0) << ran.text;
  EXPECT_TRUE(bytes_of(folder_ / "merged") == bytes_of(folder_ / "whole"));
}

/// libm and the vectorised loops choose their variants by the CPU; with fewer features seen, libm takes others.
TEST_F(BakeProgram, SameBytesWithoutFmaAndAvx) {
  ASSERT_EQ(bake(build()).code, 0);
  const std::string bytes = bytes_of(folder_ / "x.hrir");
  for (const char* hidden :
       {"-AVX512F", "-AVX512F,-AVX2,-AVX2_Usable,-FMA,-FMA_Usable", "-AVX512F,-AVX2,-FMA,-AVX,-SSE4_1"}) {
    const Ran ran =
        run_program(std::string("GLIBC_TUNABLES=glibc.cpu.hwcaps=") + hidden + " " PELAGE_BAKE " " + build());
    ASSERT_EQ(ran.code, 0) << ran.text;
    EXPECT_TRUE(bytes_of(folder_ / "x.hrir") == bytes) << hidden;
  }
}

TEST_F(BakeProgram, CleansUpBehindABakeThatWasKilledWhileFinishing) {
  std::filesystem::create_directory(folder_ / ".x.hrir.12345-0.part");
  write_bytes(folder_ / ".x.hrir.12345-0.part/x.hrir", "half a database");
  ASSERT_EQ(bake(build()).code, 0);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 2);  // x.hrir, bake.json
}

TEST_F(BakeProgram, TextThatIsNotUtf8DoesNotBreakJson) {
  DatabaseMetadata m = metadata_of(quick_settings(), 12);
  m.source = "hairstyle";
  m.source_name = "bad \xC3\x28 name";
  {
    DatabaseWriter writer(folder_ / "x.hrir", m);
    for (const StoredSector& s : arbitrary_sectors(quick_settings(), 12)) writer.append(s);
    writer.finish();
  }
  const Ran ran = bake("info --json " + path("x.hrir"));
  EXPECT_EQ(ran.code, 0) << ran.text;
  EXPECT_THAT(ran.text, HasSubstr("bad \xEF\xBF\xBD( name"));
}

TEST_F(BakeProgram, RefusesShardsThatThereAreNot) {
  for (const char* bad : {"0/3", "4/3", "1", "1/", "/3", "1/3x", "-1/3", "1/0", "1/200"}) {
    const Ran ran = bake(build() + " --shard " + bad);
    EXPECT_EQ(ran.code, 2) << bad;
    EXPECT_THAT(ran.text, HasSubstr("shard")) << bad;
  }
}

TEST_F(BakeProgram, ResumesOnDemandOrNever) {
  EXPECT_THAT(bake(build() + " --resume").text, HasSubstr("there is no interrupted bake"));
  const auto interrupt = [&] {
    EXPECT_THROW(bake_database(quick_settings(), nullptr, folder_ / "x.hrir",
                               [](std::uint64_t done, std::uint64_t) {
                                 if (done > 80) throw Interrupted("stop");
                               }),
                 Interrupted);
  };
  interrupt();
  const Ran other = bake("build --sectors 10 -o " + path("x.hrir"));
  EXPECT_EQ(other.code, 4);
  EXPECT_THAT(other.text, HasSubstr("begun with other settings"));
  const Ran resumed = bake("build --resume -o " + path("x.hrir"));  // its settings, without being told
  EXPECT_EQ(resumed.code, 0) << resumed.text;
  EXPECT_THAT(resumed.text, HasSubstr("137 records (81 of them from the interrupted bake)"));
  const std::string bytes = bytes_of(folder_ / "x.hrir");
  interrupt();
  const Ran anew = bake(build() + " --no-resume");
  EXPECT_EQ(anew.code, 0) << anew.text;
  EXPECT_THAT(anew.text, testing::Not(HasSubstr("interrupted bake")));
  EXPECT_TRUE(bytes_of(folder_ / "x.hrir") == bytes);
  EXPECT_EQ(bake(build() + " --resume --no-resume").code, 2);
}

TEST_F(BakeProgram, ResumesAShardWithoutBeingToldWhich) {
  bake_database(quick_settings(), nullptr, folder_ / "undisturbed", {}, Shard{2, 3});
  const auto interrupt = [&] {
    EXPECT_THROW(bake_database(
                     quick_settings(), nullptr, folder_ / "x.hrir",
                     [](std::uint64_t done, std::uint64_t) {
                       if (done > 20) throw Interrupted("stop");
                     },
                     Shard{2, 3}),
                 Interrupted);
  };
  interrupt();
  EXPECT_THAT(bake("info " + path("x.hrir.partial")).text, HasSubstr("unfinished: records 45 to 65 of 45 to 90"));
  for (const char* other : {"", " --shard 1/3", " --shard 2/4"}) {
    const Ran ran = bake(build() + other);
    EXPECT_EQ(ran.code, 4);
    EXPECT_THAT(ran.text, HasSubstr("is 45 to 90 in the file"));
  }
  const Ran ran = bake("build --resume -o " + path("x.hrir"));
  EXPECT_EQ(ran.code, 0);
  EXPECT_THAT(ran.text, HasSubstr("shard of records 45 to 90, 46 records (21 of them"));
  EXPECT_TRUE(bytes_of(folder_ / "x.hrir") == bytes_of(folder_ / "undisturbed"));
}

TEST_F(BakeProgram, MergesIntoNoneOfItsShards) {
  bake_shards(2);
  const std::string bytes = bytes_of(folder_ / "shard1of2");
  const Ran ran = bake("merge " + path("shard1of2") + " " + path("shard2of2") + " -o " + path("shard1of2"));
  EXPECT_EQ(ran.code, 2);
  EXPECT_THAT(ran.text, HasSubstr("would write over the shards"));
  EXPECT_TRUE(bytes_of(folder_ / "shard1of2") == bytes);
}

TEST_F(BakeProgram, DoesNotDiscardWhatAnotherBakeIsWriting) {
  const DatabaseWriter writer(folder_ / "x.hrir", metadata_of(quick_settings(), 137));
  const Ran ran = bake(build() + " --no-resume");
  EXPECT_EQ(ran.code, 1);
  EXPECT_THAT(ran.text, HasSubstr("another bake is writing it"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "x.hrir.partial"));
}

}  // namespace
}  // namespace pelage
