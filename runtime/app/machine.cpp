#include "pelage/app/machine.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>

#include "pelage/data_schema/json_file.h"
#include "pelage/db/checksum.h"

namespace pelage::app {

std::string cpu_name() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);)
    if (const auto colon = line.find(": "); line.starts_with("model name") && colon != std::string::npos)
      return line.substr(colon + 2);
  return "unknown";
}

std::string scene_hash(const Scene& scene, bool quick) {
  Checksum sum;
  const auto add = [&](const std::string& text) { sum.add(text.data(), text.size()); };
  Scene named = scene;  // the same files elsewhere are the same scene
  for (std::string* const file : {&named.hair, &named.head, &named.database})
    *file = std::filesystem::path(*file).filename().string();
  add(to_json(named));
  add(quick ? "quick" : "whole");
  for (const std::string& file : {scene.hair, scene.head, scene.database})
    if (!file.empty() && file != kGenericDatabase) add(read_text(file));
  return fmt::format("{:016x}", sum.value());
}

}  // namespace pelage::app
