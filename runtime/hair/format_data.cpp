// USC-HairSalon .data: i32 strand count; per strand an i32 point count, then x y z as float32. CT2Hair .bin: the same
// with seven floats per point (normal and label follow the position; read, not used). Neither has a magic: a file is
// one of them if the counts lead exactly to its end.
#include <limits>

#include "pelage/data_schema/errors.h"
#include "pelage/hair/hair_formats.h"

namespace pelage::hair {
namespace {

/// Where the counts lead, with `stride` bytes per point.
struct Walk {
  std::int64_t strands = 0;
  std::uint64_t points = 0, end = 0;  // end: byte after the last strand, or of the count that leads nowhere
  bool good = false;                  // ends exactly with the file
  std::int64_t bad_strand = -1;       // the one whose points do not fit, or -1
};

Walk walk(Bytes bytes, std::uint64_t stride) {
  Walk w;
  if (bytes.size() < 4) return w;
  w.strands = load<std::int32_t>(bytes, 0);
  w.end = 4;
  for (std::int64_t i = 0; i < w.strands; ++i) {
    w.bad_strand = i;
    if (bytes.size() - w.end < 4) return w;
    const std::int64_t n = load<std::int32_t>(bytes, w.end);
    if (n < 0 || static_cast<std::uint64_t>(n) * stride > bytes.size() - w.end - 4) return w;
    w.points += static_cast<std::uint64_t>(n);
    w.end += 4 + static_cast<std::uint64_t>(n) * stride;
  }
  w.bad_strand = -1;
  w.good = w.strands >= 0 && w.end == bytes.size();
  return w;
}

[[noreturn]] void refuse(const Walk& w, Bytes bytes, const std::string& where) {
  std::string what = "the counts of its " + std::to_string(w.strands) + " strands end at byte " +
                     std::to_string(w.end) + " of " + std::to_string(bytes.size());
  if (w.bad_strand >= 0) {
    what = "strand " + std::to_string(w.bad_strand) + " of " + std::to_string(w.strands) + ", at byte " +
           std::to_string(w.end) + ", does not fit into the file of " + std::to_string(bytes.size()) + " bytes";
  }
  throw InputError(where, what + ": another format, truncated or damaged; fetch or export it again");
}

RawHair decode(Bytes bytes, std::uint64_t stride, const std::string& where) {
  const Walk w = walk(bytes, stride);
  if (!w.good) refuse(w, bytes, where);
  RawHair raw;
  raw.points.reserve(w.points);
  std::uint64_t at = 4;
  for (std::int64_t i = 0; i < w.strands; ++i) {
    const auto n = static_cast<std::uint64_t>(load<std::int32_t>(bytes, at));
    for (std::uint64_t k = 0; k < n; ++k) raw.points.push_back(load<glm::vec3>(bytes, at + 4 + k * stride));
    at += 4 + n * stride;
    end_strand(raw, where);
  }
  return raw;
}

constexpr std::uint64_t kDataStride = 12, kCt2Stride = 28;  // bytes per point

}  // namespace

RawHair decode_data(Bytes bytes, const std::string& where) {
  if (!walk(bytes, kDataStride).good && walk(bytes, kCt2Stride).good)
    throw InputError(where, "holds seven numbers per point, as CT2Hair's .bin does: give it the extension .bin");
  RawHair raw = decode(bytes, kDataStride, where);
  raw.format = "USC .data";
  return raw;
}

RawHair decode_ct2hair(Bytes bytes, const std::string& where) {
  RawHair raw = decode(bytes, kCt2Stride, where);
  raw.format = "CT2Hair .bin";
  return raw;
}

std::string encode_data(const Strands& strands, Output& output) {
  constexpr std::size_t kMost = std::numeric_limits<std::int32_t>::max();
  if (strands.count() > kMost) throw OutputError(output.where, "more strands than a .data file counts: split the hair");
  std::string bytes;
  append_bytes(bytes, static_cast<std::int32_t>(strands.count()));
  for (std::size_t i = 0; i < strands.count(); ++i) {
    const std::span<const glm::vec3> strand = strands.strand(i);
    if (strand.size() > kMost) {
      throw OutputError(output.where, "strand " + std::to_string(i) + " has more vertices than a .data file counts");
    }
    append_bytes(bytes, static_cast<std::int32_t>(strand.size()));
    bytes.append(reinterpret_cast<const char*>(strand.data()), strand.size_bytes());
  }
  return bytes;
}

}  // namespace pelage::hair
