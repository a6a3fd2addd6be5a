// HAIR writer: the arrays that the strands call for and no others.
#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <string>

#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/output_file.h"
#include "pelage/hair/hair_file.h"

namespace pelage::hair {
namespace {

constexpr std::size_t kMaxSegments = 65'535;  // u16

template <class T>
void put(std::array<char, 128>& header, std::size_t offset, T value) {
  std::memcpy(header.data() + offset, &value, sizeof value);
}

template <class T>
void append_array(std::string& out, const std::vector<T>& values) {
  out.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

std::vector<std::uint16_t> segments_per_strand(const Strands& strands, const std::filesystem::path& file) {
  std::vector<std::uint16_t> segments;
  for (std::size_t i = 0; i < strands.count(); ++i) {
    const std::size_t vertices = strands.strand(i).size();
    if (vertices == 0 || vertices - 1 > kMaxSegments) {
      throw OutputError(file.string(), "strand " + std::to_string(i) + " has " + std::to_string(vertices) +
                                           " vertices, a HAIR file takes 1 to 65536: resample it");
    }
    segments.push_back(static_cast<std::uint16_t>(vertices - 1));
  }
  return segments;
}

bool all_equal(const std::vector<std::uint16_t>& values) {
  return std::adjacent_find(values.begin(), values.end(), std::not_equal_to<>()) == values.end();
}

std::array<char, 128> make_header(const Strands& strands, std::uint32_t bits, std::uint32_t default_segments) {
  std::array<char, 128> header{};
  std::memcpy(header.data(), "HAIR", 4);
  put(header, 4, static_cast<std::uint32_t>(strands.count()));
  put(header, 8, static_cast<std::uint32_t>(strands.vertices.size()));
  put(header, 12, bits);
  put(header, 16, default_segments);
  put(header, 20, strands.diameter_m);
  put(header, 28, glm::vec3(1.0F));
  std::strcpy(header.data() + 40, "Pelage: metres, Y up");
  return header;
}

std::vector<glm::vec3> colours_per_point(const Strands& strands) {
  std::vector<glm::vec3> colours;
  for (std::size_t i = 0; i < strands.colours.size(); ++i) {
    colours.insert(colours.end(), strands.strand(i).size(), strands.colours[i]);
  }
  return colours;
}

}  // namespace

void write_hair(const Strands& strands, const std::filesystem::path& file) {
  const std::vector<std::uint16_t> segments = segments_per_strand(strands, file);
  const bool even = all_equal(segments);
  const std::uint32_t bits =
      (even ? 0U : 1U) | 2U | (strands.diameters_m.empty() ? 0U : 4U) | (strands.colours.empty() ? 0U : 16U);
  const std::array<char, 128> header = make_header(strands, bits, even && !segments.empty() ? segments[0] : 0U);
  std::string bytes(header.data(), header.size());
  if (!even) append_array(bytes, segments);
  append_array(bytes, strands.vertices);
  append_array(bytes, strands.diameters_m);
  append_array(bytes, colours_per_point(strands));

  AtomicFile out(file);
  out.write(bytes);
  out.commit();
}

}  // namespace pelage::hair
