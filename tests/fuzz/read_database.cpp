// Harness of the database reader: a whole HRIR file, starting from tiny databases and a shard of this very version. A
// file that differs from one of them by a few bytes, by its end or by bytes after its end must be refused or answer as
// it does; any other may be a database that somebody else made, and its answers keep within their ranges.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "harness.h"
#include "pelage/db/database.h"
#include "pelage/db/record_bank.h"
#include "tiny_database.h"

namespace pelage::fuzz {
namespace {

constexpr int kRecords = 3;
/// A checksum is 8 bytes: fewer changed bytes cannot fit it to other content, other than by a chance of 2^-64.
constexpr std::ptrdiff_t kFewBytes = 4;

std::string tiny_database(Storage storage) {
  const std::filesystem::path file = scratch("seed.hrir");
  write_tiny_database(file, tiny_settings(storage, kRecords));
  return bytes_of(file);
}

std::string tiny_shard() {
  const BakeSettings settings = tiny_settings(Storage::u8, kRecords);
  const std::filesystem::path file = scratch("seed.shard");
  DatabaseWriter writer(file, {settings, "random", "", "", "tiny", kRecords}, {1, kRecords});
  while (writer.next_row() < kRecords) writer.append(tiny_sector(settings, static_cast<int>(writer.next_row())));
  writer.finish();
  return bytes_of(file);
}

/// Bytes one after the other, to compare what a database says.
class Digest {
 public:
  void add(const std::string& text) { text_ += std::to_string(text.size()) + ':' + text; }
  template <class T>
  void add(std::span<const T> values) {
    add(std::string(reinterpret_cast<const char*>(values.data()), values.size_bytes()));
  }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

template <class T>
bool all_finite(std::span<const T> values) {
  return std::ranges::all_of(values, [](auto v) { return std::isfinite(v); });
}

void check(const DatabaseReader& reader, const SectorView& s) {
  const Storage storage = reader.metadata().settings.storage;
  require(static_cast<int>(s.features.size()) == dimension(reader.metadata().settings.features) &&
              all_finite<float>(s.features),
          "features are finite");
  for (const glm::vec2& p : s.crossings) require(std::isfinite(p.x) && std::isfinite(p.y), "crossings are finite");
  const std::vector<float> tau = dequantise(s.tau, storage), re = dequantise(s.re, storage);
  require(tau.size() == reader.shape().tau_size() && re.size() == reader.shape().re_size(), "records have their shape");
  for (const std::vector<float>* values : {&tau, &re})
    for (const float v : *values) require(v >= 0 && v <= 1e6F, "values are in [0, 1e6]");
}

void check(const RecordBank& bank) {
  const auto samples = static_cast<std::size_t>(bank.shape().samples);
  std::vector<float> tau(samples), re(samples);
  constexpr SatfAngles angles{-1.0F, 4.0F, 0.5F, 7.0F};
  for (std::size_t record = 0; record < bank.size(); ++record) {
    bank.lookup(record, 0.3F, angles, tau, re);
    require(all_finite<float>(tau) && all_finite<float>(re), "looked-up values are finite");
  }
}

std::string answers(const std::filesystem::path& file) {
  const DatabaseReader reader(file, Accept::unfinished);
  const DatabaseMetadata& m = reader.metadata();
  Digest digest;
  for (const std::string& text : {to_json(m.settings), m.source, m.source_name, m.source_hash, m.revision})
    digest.add(text);
  for (const std::vector<double>& scale : {reader.feature_scale().mean, reader.feature_scale().inv_sigma}) {
    require(all_finite<double>(scale), "feature scales are finite");
    digest.add<double>(scale);
  }
  std::uint64_t next = reader.rows().first;
  reader.for_each([&](std::uint64_t id, const SectorView& s) {
    require(id == next++, "rows come in order");
    check(reader, s);
    digest.add<float>(s.features);
    digest.add<glm::vec2>(s.crossings);
    digest.add<float>(std::array{s.tau.scale, s.re.scale});
    digest.add<std::uint8_t>(s.tau.bytes);
    digest.add<std::uint8_t>(s.re.bytes);
  });
  require(next == reader.rows().end && next <= m.sectors, "all rows are there");
  if (!reader.feature_scale().mean.empty()) check(RecordBank(file));
  return digest.take();
}

struct Original {
  std::string bytes, answers;
};

const std::vector<Original>& originals() {
  static const std::vector<Original> all = [] {
    std::vector<Original> made;
    for (const std::string& bytes : database_seeds()) made.push_back({bytes, answers(scratch("original.hrir", bytes))});
    return made;
  }();
  return all;
}

/// Cut off, continued, or a few bytes changed.
bool damaged(std::string_view bytes, std::string_view original) {
  if (bytes.starts_with(original) || original.starts_with(bytes)) return true;
  if (bytes.size() != original.size()) return false;
  std::ptrdiff_t differ = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) differ += bytes[i] != original[i];
  return differ <= kFewBytes;
}

}  // namespace

std::vector<std::string> database_seeds() {
  return {tiny_database(Storage::u8), tiny_database(Storage::half), tiny_shard()};
}

void read_database(std::string_view bytes) {
  const std::vector<Original>& all = originals();
  const std::filesystem::path file = scratch("fuzz.hrir", bytes);
  const auto said = accepted([&] { return answers(file); });
  if (!said) return;
  for (const Original& original : all)
    if (damaged(bytes, original.bytes))
      require(*said == original.answers, "a damaged file is refused or answers as before");
}

}  // namespace pelage::fuzz
