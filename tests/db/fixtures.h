// Small databases and hand-made hair for the tests of db and bake.
#pragma once

#include <gtest/gtest.h>

#include <unistd.h>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>

#include "pelage/data_schema/hairstyle.h"
#include "pelage/db/database.h"

namespace pelage::fixtures {

/// A folder of its own, removed at the end.
class Folder {
 public:
  Folder() {
    static int count = 0;
    path_ = std::filesystem::temp_directory_path() /
            ("pelage-db-" + std::to_string(::getpid()) + "-" + std::to_string(count++));
    std::filesystem::create_directories(path_);
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

inline std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
inline void write_bytes(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

inline BakeSettings small_settings(Storage storage = Storage::u8) {
  BakeSettings s;
  s.sectors = 12;
  s.views = 8;
  s.lights = 6;
  s.samples = 16;
  s.grid = 16;
  s.storage = storage;
  return s;
}

/// A record whose values are arbitrary but tell the cell that they belong to.
inline HrirRecord arbitrary_record(const BakeSettings& settings, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> value(0.0F, 1.0F);
  HrirRecord record{record_shape(settings), {}, {}};
  for (std::size_t i = 0; i < record.shape.tau_size(); ++i) record.tau.push_back(0.3F * value(random));
  for (std::size_t i = 0; i < record.shape.re_size(); ++i) record.re.push_back(2.5F * value(random));
  return record;
}

inline StoredSector stored(const BakeSettings& settings, const HrirRecord& record, std::vector<glm::vec2> crossings) {
  StoredSector s;
  s.features.resize(static_cast<std::size_t>(dimension(settings.features)));
  density_features(projections(crossings, settings.grid, settings.sigma), settings.features, s.features);
  s.crossings = std::move(crossings);
  s.tau = quantise(record.tau, settings.storage, "tau");
  s.re = quantise(record.re, settings.storage, "re");
  return s;
}

inline std::vector<glm::vec2> arbitrary_crossings(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(0.0F, 1.0F);
  std::vector<glm::vec2> crossings(1 + seed % 7);
  for (auto& p : crossings) p = {place(random), place(random)};
  return crossings;
}

inline std::vector<StoredSector> arbitrary_sectors(const BakeSettings& settings, int count) {
  std::vector<StoredSector> sectors;
  for (int i = 0; i < count; ++i) {
    const auto seed = static_cast<unsigned>(i);
    sectors.push_back(stored(settings, arbitrary_record(settings, seed), arbitrary_crossings(seed)));
  }
  return sectors;
}

inline FeatureScale scale_of(const std::vector<StoredSector>& sectors) {
  std::vector<float> all;
  for (const auto& s : sectors) all.insert(all.end(), s.features.begin(), s.features.end());
  return fit_scale(all, static_cast<int>(sectors.front().features.size()));
}

inline DatabaseMetadata metadata_of(const BakeSettings& settings, std::size_t count) {
  return {settings, "random", "", "", "test", count};
}

inline void write_database(const std::filesystem::path& file, const BakeSettings& settings,
                           const std::vector<StoredSector>& sectors) {
  DatabaseWriter writer(file, metadata_of(settings, sectors.size()));
  for (std::size_t i = writer.next_row(); i < sectors.size(); ++i) writer.append(sectors[i]);
  writer.finish();
}

/// Straight clusters of strands that drift slowly around the axis.
inline Hairstyle hand_made_style(int clusters, int strands, unsigned seed, float twist = 0.6F) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  Hairstyle style;
  style.name = "hand-made";
  style.diameter_m = 2e-4F;
  style.division = {2, 8, 8, 0.1F};
  for (int c = 0; c < clusters; ++c) {
    Cluster cluster;
    for (int i = 0; i < 4; ++i) {
      cluster.centre_line.push_back(
          {0.03F * static_cast<float>(c), 0.07F * static_cast<float>(i), 0.01F * unit(random)});
      cluster.cross_sections.push_back({0.012F, 0.0F, 0.009F});
    }
    for (int k = 0; k < strands; ++k) {
      const float v = std::sqrt(std::abs(unit(random))), u = 3.14159265F * unit(random), turn = twist * unit(random);
      for (int j = 0; j <= 8; ++j) {
        const float t = static_cast<float>(j) / 8.0F, angle = u + turn * t;
        cluster.strand_points.push_back({t, v * std::cos(angle), v * std::sin(angle)});
      }
      cluster.strand_offsets.push_back(static_cast<std::uint32_t>(cluster.strand_points.size()));
    }
    style.clusters.push_back(std::move(cluster));
  }
  return style;
}

/// The message of the exception of type E that `call` throws; a test failure otherwise.
template <class E, class Call>
std::string message_of(Call call) {
  try {
    call();
  } catch (const E& error) {
    return error.what();
  } catch (const std::exception& error) {
    ADD_FAILURE() << "another exception: " << error.what();
    return {};
  }
  ADD_FAILURE() << "nothing was thrown";
  return {};
}

}  // namespace pelage::fixtures
