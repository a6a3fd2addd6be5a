// Writes the seeds that are made: `fuzz_seeds FOLDER` fills FOLDER/<harness>/.
#include <fstream>

#include "harness.h"

int main(int argc, char** argv) {
  using namespace pelage::fuzz;
  if (argc != 2) return 2;
  for (const Harness& harness : harnesses()) {
    const std::filesystem::path folder = std::filesystem::path(argv[1]) / harness.name;
    std::filesystem::create_directories(folder);
    int count = 0;
    for (const std::string& seed : harness.seeds ? harness.seeds() : std::vector<std::string>{})
      std::ofstream(folder / ("seed-" + std::to_string(count++)), std::ios::binary) << seed;
  }
  return 0;
}
