#include "tiny_database.h"

namespace pelage::fuzz {

BakeSettings tiny_settings(Storage storage, int records) {
  BakeSettings s;
  s.sectors = records;
  s.views = s.lights = s.samples = 4;
  s.grid = 8;
  s.features = FeatureSet::paper3;
  s.storage = storage;
  return s;
}

StoredSector tiny_sector(const BakeSettings& settings, int index) {
  const RecordShape shape = record_shape(settings);
  std::vector<float> tau, re;
  for (std::size_t i = 0; i < shape.tau_size(); ++i) tau.push_back(0.01F * static_cast<float>((7 * i + 3) % 29));
  for (std::size_t i = 0; i < shape.re_size(); ++i) re.push_back(0.05F * static_cast<float>((11 * i + 5) % 37));
  StoredSector s;
  const auto id = static_cast<float>(index);
  s.features = {1.0F + id, 0.5F - 0.1F * id, 0.25F * id};
  s.crossings.assign(static_cast<std::size_t>(index % 5), glm::vec2(0.25F, 0.75F));
  s.tau = quantise(tau, settings.storage, "tau");
  s.re = quantise(re, settings.storage, "re");
  return s;
}

void write_tiny_database(const std::filesystem::path& file, const BakeSettings& settings) {
  const auto records = static_cast<std::uint64_t>(settings.sectors);
  DatabaseWriter writer(file, {settings, "random", "", "", "tiny", records});
  while (writer.next_row() < records) writer.append(tiny_sector(settings, static_cast<int>(writer.next_row())));
  writer.finish();
}

}  // namespace pelage::fuzz
