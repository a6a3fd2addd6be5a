// The store: round trip, refusal of everything that is not what was written, resuming. HARD_CASES 16.
#include "pelage/db/database.h"

#include <gmock/gmock.h>
#include <signal.h>
#include <sqlite3.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <atomic>

#include "fixtures.h"
#include "pelage/data_schema/errors.h"
#include "pelage/db/record_bank.h"

namespace pelage {
namespace {

using namespace fixtures;
using testing::AllOf;
using testing::HasSubstr;

/// Runs SQL in a file, to damage it; nothing checks what it does.
void alter(const std::filesystem::path& file, const std::string& sql) {
  sqlite3* db = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &db), SQLITE_OK);
  char* error = nullptr;
  EXPECT_EQ(sqlite3_exec(db, ("PRAGMA ignore_check_constraints = ON;" + sql).c_str(), nullptr, nullptr, &error),
            SQLITE_OK)
      << (error == nullptr ? "" : error);
  sqlite3_free(error);
  sqlite3_close(db);
}

void read_all(const std::filesystem::path& file) {
  DatabaseReader(file).for_each([](std::uint64_t, const SectorView&) {});
}

/// Everything that a reader tells, as text: equal content, equal text.
std::string content_of(const std::filesystem::path& file) {
  const DatabaseReader reader(file);
  const DatabaseMetadata& m = reader.metadata();
  std::string all = to_json(m.settings) + m.source + m.source_name + m.source_hash + m.revision;
  const auto add = [&](const void* data, std::size_t size) { all.append(static_cast<const char*>(data), size); };
  add(reader.feature_scale().mean.data(), 8 * reader.feature_scale().mean.size());
  add(reader.feature_scale().inv_sigma.data(), 8 * reader.feature_scale().inv_sigma.size());
  reader.for_each([&](std::uint64_t, const SectorView& s) {
    add(s.features.data(), 4 * s.features.size());
    add(s.crossings.data(), 8 * s.crossings.size());
    for (const auto* a : {&s.tau, &s.re}) {
      add(&a->scale, 4);
      add(a->bytes.data(), a->bytes.size());
    }
  });
  return all;
}

TEST(Quantise, EightBitsRoundToHalfAStepOfTheMaximum) {
  const HrirRecord record = arbitrary_record(small_settings(), 3);
  const QuantisedArray q = quantise(record.re, Storage::u8, "re");
  const std::vector<float> back = dequantise(q, Storage::u8);
  ASSERT_EQ(back.size(), record.re.size());
  for (std::size_t i = 0; i < back.size(); ++i) {
    EXPECT_NEAR(back[i], record.re[i], q.scale / 510 * (1 + 1e-5F)) << i;  // 1e-5: float rounding of the product
  }
}

TEST(Quantise, HalfIsWithinItsUlp) {
  const HrirRecord record = arbitrary_record(small_settings(), 3);
  const std::vector<float> back = dequantise(quantise(record.tau, Storage::half, "tau"), Storage::half);
  for (std::size_t i = 0; i < back.size(); ++i) {
    EXPECT_NEAR(back[i], record.tau[i], record.tau[i] * 0x1p-11F + 0x1p-25F) << i;
  }
}

TEST(Quantise, EveryHalfSurvives) {
  for (unsigned h = 0; h < 0x10000; ++h) {
    const float value = float_from_half(static_cast<std::uint16_t>(h));
    if (std::isnan(value)) continue;
    ASSERT_EQ(half_from_float(value), h);
  }
}

TEST(Quantise, HalfRoundsToNearestEven) {
  EXPECT_EQ(half_from_float(1.0F + 0x1p-11F), half_from_float(1.0F));                // tie, down to even
  EXPECT_EQ(half_from_float(1.0F + 3 * 0x1p-11F), half_from_float(1.0F + 0x1p-9F));  // tie, up to even
  EXPECT_EQ(half_from_float(0x1p-25F), 0);                                           // tie at the smallest subnormal
  EXPECT_EQ(half_from_float(65519.0F), half_from_float(65504.0F));
}

TEST(Quantise, RefusesWhatCannotBeStored) {
  for (const float bad : {std::nanf(""), -1e-6F, INFINITY, 70000.0F}) {
    EXPECT_THAT(message_of<InputError>([&] {
                  quantise({0.0F, bad}, Storage::half, "sector 7, re");
                }),
                AllOf(HasSubstr("sector 7, re"), HasSubstr("value 1")));
  }
  EXPECT_EQ(quantise({0, 0}, Storage::u8, "").scale, 0.0F);
}

TEST(ChecksumTest, SeesEveryChangedByteAndTheLength) {
  std::string text(37, 'x');
  const auto of = [](const std::string& t) {
    Checksum sum;
    sum.add(t.data(), t.size());
    return sum.value();
  };
  const std::uint64_t original = of(text);
  for (std::size_t i = 0; i < text.size(); ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      std::string flipped = text;
      flipped[i] = static_cast<char>(flipped[i] ^ (1 << bit));
      EXPECT_NE(of(flipped), original);
    }
  }
  EXPECT_NE(of(std::string(5, '\0')), of(std::string(6, '\0')));
}

class DatabaseTest : public testing::TestWithParam<Storage> {
 protected:
  void SetUp() override {
    settings_ = small_settings(GetParam());
    sectors_ = arbitrary_sectors(settings_, settings_.sectors);
    write_database(file_, settings_, sectors_);
  }
  Folder folder_;
  std::filesystem::path file_ = folder_ / "hair.hrir";
  BakeSettings settings_;
  std::vector<StoredSector> sectors_;
};

INSTANTIATE_TEST_SUITE_P(Storages, DatabaseTest, testing::Values(Storage::u8, Storage::half),
                         [](const auto& storage) { return storage.param == Storage::u8 ? "u8" : "half"; });

TEST_P(DatabaseTest, ReadsWhatWasWritten) {
  const DatabaseReader reader(file_);
  EXPECT_EQ(reader.metadata().settings, settings_);
  EXPECT_EQ(reader.metadata().sectors, 12U);
  EXPECT_EQ(reader.feature_scale().mean, scale_of(sectors_).mean);
  std::uint64_t rows = 0;
  reader.for_each([&](std::uint64_t id, const SectorView& row) {
    const StoredSector s = copy_of(row);
    const StoredSector& ours = sectors_[id];
    EXPECT_EQ(id, rows++);
    EXPECT_EQ(s.features, ours.features);
    EXPECT_EQ(s.crossings, ours.crossings);
    EXPECT_EQ(s.tau.bytes, ours.tau.bytes);
    EXPECT_EQ(s.re.bytes, ours.re.bytes);
    EXPECT_EQ(s.re.scale, ours.re.scale);
  });
  EXPECT_EQ(rows, 12U);
}

TEST_P(DatabaseTest, LeavesOneFileThatIsNotInWalMode) {
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 1);
  const std::string bytes = bytes_of(file_);
  EXPECT_EQ(bytes.substr(0, 15), "SQLite format 3");
  EXPECT_EQ(bytes[18], 1);  // a WAL file cannot be read in a read-only folder
  EXPECT_EQ(bytes.substr(68, 4), "Plge");
}

TEST_P(DatabaseTest, BatchesAndInterruptionsLeaveNoTrace) {
  const auto again = folder_ / "again.hrir";
  for (const std::size_t stop : {0U, 1U, 5U, 5U, 11U}) {
    DatabaseWriter writer(again, metadata_of(settings_, sectors_.size()));
    while (writer.next_row() < stop) writer.append(sectors_[writer.next_row()]);
  }
  EXPECT_FALSE(std::filesystem::exists(again));
  write_database(again, settings_, sectors_);
  EXPECT_EQ(bytes_of(again), bytes_of(file_));
}

TEST_P(DatabaseTest, RefusesToResumeOtherSettings) {
  const auto other = folder_ / "other.hrir";
  { DatabaseWriter writer(other, metadata_of(settings_, 12)); }
  BakeSettings changed = settings_;
  changed.sigma = 0.04;
  EXPECT_THAT(message_of<InputError>([&] { DatabaseWriter(other, metadata_of(changed, 12)); }),
              AllOf(HasSubstr("sigma"), HasSubstr("0.05"), HasSubstr("0.04"), HasSubstr("delete it")));
  DatabaseMetadata style = metadata_of(settings_, 12);
  style.source = "hairstyle";
  EXPECT_THAT(message_of<InputError>([&] { DatabaseWriter(other, style); }), HasSubstr("source is 'random'"));
}

TEST_P(DatabaseTest, RefusesTruncation) {
  const std::string bytes = bytes_of(file_);
  const auto cut = folder_ / "cut.hrir";
  for (std::size_t size = 0; size < bytes.size(); size += size < 200 ? 7 : 509) {
    write_bytes(cut, bytes.substr(0, size));
    EXPECT_THROW(read_all(cut), InputError) << size << " bytes";
  }
  for (std::size_t size = 4096; size < bytes.size(); size += 4096) {
    write_bytes(cut, bytes.substr(0, size));
    EXPECT_THROW(read_all(cut), InputError) << size << " bytes";
  }
}

TEST_P(DatabaseTest, FlippedByteIsRefusedOrChangesNothing) {
  const std::string bytes = bytes_of(file_);
  const std::string content = content_of(file_);
  const auto damaged = folder_ / "damaged.hrir";
  std::mt19937 random(1);
  int refused = 0;
  for (int trial = 0; trial < 400; ++trial) {
    std::string copy = bytes;
    const std::size_t at = random() % (trial < 150 ? 100 : copy.size());
    copy[at] = static_cast<char>(copy[at] ^ (1 << random() % 8));
    write_bytes(damaged, copy);
    try {
      EXPECT_EQ(content_of(damaged), content) << "byte " << at;
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 100);
}

TEST_P(DatabaseTest, FlippedByteOfABlobIsFound) {
  const std::string bytes = bytes_of(file_);
  for (const StoredSector& s : {sectors_[0], sectors_[7]}) {
    const std::string start(s.re.bytes.begin(), s.re.bytes.begin() + 16);
    std::string copy = bytes;
    const std::size_t at = copy.find(start);
    ASSERT_NE(at, std::string::npos);
    copy[at] = static_cast<char>(copy[at] ^ 1);
    const auto damaged = folder_ / "damaged.hrir";
    write_bytes(damaged, copy);
    EXPECT_THAT(message_of<InputError>([&] { read_all(damaged); }), HasSubstr("checksum"));
  }
}

TEST_P(DatabaseTest, RefusesForeignAndNewerFiles) {
  struct Case {
    const char* sql;
    const char* says;
  };
  const Case cases[] = {
      {"PRAGMA application_id = 7", "not an HRIR database"},
      {"PRAGMA user_version = 3", "schema version 3, this build reads 2: bake it again"},
      {"DELETE FROM sector", "0 of 12 records"},
      {"DELETE FROM sector WHERE id = 4", "rows are missing"},
      {"UPDATE sector SET id = 50 WHERE id = 11", "holds rows 0 to 50, but is for rows 0 to 11"},
      {"DELETE FROM metadata", "no metadata"},
      {"UPDATE metadata SET sectors = 11", "checksum"},
      {"UPDATE metadata SET sectors = 0", "0 sectors"},
      {"UPDATE metadata SET sectors = 1000000", "1000000 sectors"},
      {"UPDATE metadata SET source_name = 'x'", "checksum"},
      {"UPDATE metadata SET settings = '{}'", "settings"},
      {"UPDATE metadata SET settings = 'rubbish'", "settings"},
      {"UPDATE metadata SET feature_scales = NULL", ""},
      {"UPDATE metadata SET feature_scales = zeroblob(16)", "checksum"},
      {"UPDATE sector SET tau = zeroblob(length(tau) - 1) WHERE id = 2", "sector 2: tau holds"},
      {"UPDATE sector SET re = zeroblob(length(re) + 2) WHERE id = 2", "sector 2: re holds"},
      {"UPDATE sector SET re = zeroblob(0) WHERE id = 2", "sector 2: re holds 0 bytes"},
      {"UPDATE sector SET tau_scale = 9e99 WHERE id = 3", "sector 3: scale"},
      {"UPDATE sector SET tau_scale = -1 WHERE id = 3", "sector 3: scale"},
      {"UPDATE sector SET features = zeroblob(4) WHERE id = 5", "sector 5: 1 features"},
      {"UPDATE sector SET features = CAST(x'0000C07F' || substr(features, 5) AS BLOB) WHERE id = 5",
       "sector 5: a feature is not a number within 1e6"},
      {"UPDATE sector SET crossings = x'0000C07F00000000' WHERE id = 6", "sector 6: a strand lies outside"},
      {"UPDATE sector SET crossings = x'0000404000000000' WHERE id = 6", "sector 6: a strand lies outside"},
      {"DROP TABLE sector", "its tables are not those"},
      {"DROP TABLE sector; CREATE VIEW sector AS WITH RECURSIVE r(n) AS (SELECT 1 UNION ALL SELECT n FROM r) SELECT * "
       "FROM r",
       "its tables are not those"},
      {"ALTER TABLE sector ADD COLUMN more INTEGER", "its tables are not those"},
  };
  const std::string bytes = bytes_of(file_);
  for (const Case& c : cases) {
    const auto altered = folder_ / "altered.hrir";
    write_bytes(altered, bytes);
    alter(altered, c.sql);
    EXPECT_THAT(message_of<InputError>([&] { read_all(altered); }), AllOf(HasSubstr("altered.hrir"), HasSubstr(c.says)))
        << c.sql;
  }
}

TEST(Database, ANaNInAHalfBlobIsRefused) {
  const Folder folder;
  const BakeSettings settings = small_settings(Storage::half);
  write_database(folder / "x", settings, arbitrary_sectors(settings, settings.sectors));
  alter(folder / "x", "UPDATE sector SET re = CAST(x'007E' || substr(re, 3) AS BLOB) WHERE id = 1");
  EXPECT_THAT(message_of<InputError>([&] { read_all(folder / "x"); }),
              HasSubstr("sector 1: a half is negative or not finite"));
}

TEST(Database, DamageIsNamedTheSameForAnyNumberOfThreads) {
  const Folder folder;
  BakeSettings settings = small_settings();
  settings.sectors = 90;
  write_database(folder / "x", settings, arbitrary_sectors(settings, 90));
  alter(folder / "x", "UPDATE sector SET tau_scale = tau_scale * 2 WHERE id IN (37, 80)");
  for (const std::size_t threads : {1U, 2U, 3U, 8U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    EXPECT_THAT(message_of<InputError>([&] { RecordBank(folder / "x"); }), HasSubstr("sector 37: does not match"));
  }
}

TEST(Database, ReadsTheSameConcurrently) {
  const Folder folder;
  BakeSettings settings = small_settings();
  settings.sectors = 90;
  const auto sectors = arbitrary_sectors(settings, 90);
  write_database(folder / "x", settings, sectors);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 8);
  std::vector<std::atomic<int>> seen(90);
  DatabaseReader(folder / "x").for_each_concurrently([&](std::uint64_t id, const SectorView& s) {
    ++seen[id];
    EXPECT_EQ(copy_of(s).re.bytes, sectors[id].re.bytes);
    EXPECT_EQ(copy_of(s).features, sectors[id].features);
  });
  for (const auto& times : seen) EXPECT_EQ(times, 1);
}

TEST(Database, RefusesFilesThatAreNone) {
  const Folder folder;
  EXPECT_THAT(message_of<InputError>([&] { DatabaseReader(folder / "absent"); }), HasSubstr("no such file"));
  EXPECT_THAT(message_of<InputError>([&] { DatabaseReader(folder.path()); }), HasSubstr("is a folder"));
  write_bytes(folder / "empty", "");
  EXPECT_THAT(message_of<InputError>([&] { DatabaseReader(folder / "empty"); }), HasSubstr("not an HRIR database"));
  write_bytes(folder / "text", std::string(5000, 'x'));
  EXPECT_THAT(message_of<InputError>([&] { DatabaseReader(folder / "text"); }), HasSubstr("not an HRIR database"));
  { DatabaseWriter writer(folder / "begun", metadata_of(small_settings(), 12)); }
  EXPECT_THAT(message_of<InputError>([&] { DatabaseReader(folder / "begun.partial"); }), HasSubstr("unfinished"));
}

TEST(Database, RefusesScalesThatAreNotThoseOfItsRows) {
  const Folder folder;
  const BakeSettings settings = small_settings();
  const auto sectors = arbitrary_sectors(settings, settings.sectors);
  write_database(folder / "a", settings, sectors);
  auto others = sectors;
  others[3].features[1] += 0.5F;
  write_database(folder / "b", settings, others);
  // The rows of one and the metadata of the other, with all checksums right.
  alter(folder / "a", "ATTACH '" + (folder / "b").string() +
                          "' AS b; DELETE FROM metadata; INSERT INTO metadata SELECT * FROM b.metadata");
  EXPECT_THAT(message_of<InputError>([&] { read_all(folder / "a"); }),
              HasSubstr("feature scales are not those of its records"));
  EXPECT_THAT(message_of<InputError>([&] { RecordBank(folder / "a"); }), HasSubstr("feature scales are not"));
}

TEST(Database, StructureIsCheckedEvenWhereAllRowsAreWhole) {
  const Folder folder;
  write_database(folder / "x", small_settings(), arbitrary_sectors(small_settings(), 12));
  std::string bytes = bytes_of(folder / "x");
  std::size_t leaf = 4096;
  while (leaf < bytes.size() && bytes[leaf] != 0x0D) leaf += 4096;
  ASSERT_LT(leaf, bytes.size());
  bytes[leaf + 7] = static_cast<char>(bytes[leaf + 7] ^ 5);  // its count of unused bytes, which no reader of rows needs
  write_bytes(folder / "x", bytes);
  EXPECT_THAT(message_of<InputError>([&] { read_all(folder / "x"); }), HasSubstr("quick_check says"));
  EXPECT_THAT(message_of<InputError>([&] { RecordBank(folder / "x"); }), HasSubstr("quick_check says"));
}

TEST(Database, NamesThatSqliteWouldReadOtherwiseAreFiles) {
  const Folder folder;
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  const BakeSettings settings = small_settings();
  for (const char* name : {"file:x.hrir", ":memory:", "file:y.hrir?mode=memory", "50% #1.hrir"}) {
    write_database(name, settings, arbitrary_sectors(settings, settings.sectors));
    read_all(name);
    EXPECT_TRUE(std::filesystem::exists(folder / name));
    EXPECT_FALSE(std::filesystem::exists(folder / (std::string(name) + ".partial")));
  }
  std::filesystem::current_path(before);
}

TEST(Database, DiscardsOnlyInterruptedBakes) {
  const Folder folder;
  const auto x = folder / "x", partial = folder / "x.partial";
  discard_partial(x);  // none: nothing to do
  { DatabaseWriter writer(x, metadata_of(small_settings(), 12)); }
  discard_partial(x);
  EXPECT_FALSE(std::filesystem::exists(partial));
  write_bytes(partial, "precious");
  EXPECT_THAT(message_of<InputError>([&] { discard_partial(x); }), HasSubstr("is no interrupted bake"));
  EXPECT_EQ(bytes_of(partial), "precious");
  std::filesystem::remove(partial);
  alter(partial, "CREATE TABLE mine (a); PRAGMA application_id = 7");
  EXPECT_THAT(message_of<InputError>([&] { discard_partial(x); }), HasSubstr("is no interrupted bake"));
  EXPECT_TRUE(std::filesystem::exists(partial));
}

TEST(Database, RefusesRecordsTooLargeForABlob) {
  BakeSettings s = small_settings();
  s.views = s.lights = s.samples = 128;
  EXPECT_THAT(message_of<InputError>([&] { record_shape(s); }), HasSubstr("below 1000000"));
}

TEST(Database, RefusesRowsOfAnotherShape) {
  const Folder folder;
  const BakeSettings s = small_settings();
  DatabaseWriter writer(folder / "x", metadata_of(s, 2));
  StoredSector row = arbitrary_sectors(s, 1).front();
  row.features[3] = std::nanf("");
  EXPECT_THAT(message_of<InputError>([&] { writer.append(row); }),
              HasSubstr("sector 0: a feature is not a number within 1e6"));
}

TEST(Database, SecondBakerIsToldToWait) {
  const Folder folder;
  const DatabaseMetadata m = metadata_of(small_settings(), 12);
  const DatabaseWriter writer(folder / "x", m);
  EXPECT_THAT(message_of<OutputError>([&] { DatabaseWriter(folder / "x", m); }),
              HasSubstr("another bake is writing it"));
}

TEST(Database, MissingFolderIsASentence) {
  const Folder folder;
  const DatabaseMetadata m = metadata_of(small_settings(), 12);
  EXPECT_THAT(message_of<OutputError>([&] { DatabaseWriter(folder / "absent/x", m); }), HasSubstr("absent"));
  EXPECT_THAT(message_of<OutputError>([&] { DatabaseWriter(folder.path(), m); }), HasSubstr(folder.path().string()));
}

/// Runs `body` in a child process and returns its exit status.
template <class Body>
int in_child(Body body) {
  const pid_t child = fork();
  if (child == 0) {
    body();
    _exit(99);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(Database, ReadOnlyFolderIsRefusedForWritingAndReadable) {
  const Folder folder;
  const BakeSettings s = small_settings();
  const auto sectors = arbitrary_sectors(s, 12);
  write_database(folder / "x.hrir", s, sectors);
  std::filesystem::permissions(folder.path(), std::filesystem::perms(0555));
  const int status = in_child([&] {
    if (geteuid() == 0 && setuid(65534) != 0) _exit(77);
    try {
      read_all(folder / "x.hrir");
      DatabaseWriter(folder / "y.hrir", metadata_of(s, 12));
    } catch (const OutputError&) {
      _exit(0);
    } catch (...) {
      _exit(1);
    }
  });
  std::filesystem::permissions(folder.path(), std::filesystem::perms(0755));
  if (status == 77) GTEST_SKIP() << "cannot give up root here";
  EXPECT_EQ(status, 0);
}

TEST(Database, FullDiskIsASentenceAndResumes) {
  const Folder folder;
  const BakeSettings s = small_settings();
  const auto sectors = arbitrary_sectors(s, 12);
  const auto x = folder / "x.hrir";
  const int status = in_child([&] {
    signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{24000, 24000};  // bytes per file: some rows fit, not all
    setrlimit(RLIMIT_FSIZE, &limit);
    try {
      write_database(x, s, sectors);
    } catch (const OutputError& error) {
      _exit(std::string(error.what()).find(x.filename().string()) != std::string::npos ? 0 : 2);
    } catch (...) {
      _exit(1);
    }
  });
  EXPECT_EQ(status, 0);
  EXPECT_FALSE(std::filesystem::exists(x));
  write_database(x, s, sectors);
  write_database(folder / "undisturbed", s, sectors);
  EXPECT_EQ(bytes_of(x), bytes_of(folder / "undisturbed"));
}

}  // namespace
}  // namespace pelage
