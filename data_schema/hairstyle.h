// Hairstyle: clusters, how they are divided into layers, sectors and plates, and what one strand stops of the light.
// File format: schemas/hairstyle.schema.json, SCHEMA.md.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pelage/data_schema/cluster.h"
#include "pelage/data_schema/strands.h"

namespace pelage {

/// [Xu2006 eq. 3]: s_v = layers, s_u = sectors (of the outermost layer; inner ones have fewer, see db/sectors.h),
/// s_t = plates (number of HSVs along a cluster).
struct Division {
  int layers = 3;     // [1, 32]
  int sectors = 24;   // [3, 256]
  int plates = 24;    // [2, 512]
  float core = 0.1F;  // [0, 0.9] radius v of the transparent interior core
  bool operator==(const Division&) const = default;
};

struct Hairstyle {
  std::string name;
  std::string source;       // file that it was fitted to, or empty
  std::string source_hash;  // hex SHA-256 of that file's bytes, or empty
  Division division;
  float diameter_m = 0.0F;          // drawn diameter D of a strand, > 0
  float opacity = kDefaultOpacity;  // a in (0, 1]
  std::vector<Cluster> clusters;

  std::size_t strand_count() const noexcept {
    std::size_t n = 0;
    for (const Cluster& c : clusters) n += c.strand_count();
    return n;
  }
};

/// Reads and validates a hairstyle file. @throws InputError naming file, JSON path, value, and the nearest known key.
Hairstyle load_hairstyle(const std::filesystem::path& file);
/// Writes atomically (temporary file, then rename). @throws OutputError
void save_hairstyle(const Hairstyle& style, const std::filesystem::path& file);

}  // namespace pelage
