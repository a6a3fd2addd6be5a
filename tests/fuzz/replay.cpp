// Every harness over its kept corpus and its seeds, whole, cut off everywhere and with bytes changed (HARD_CASES 16,
// 31), in every configuration and without libFuzzer. What a fuzzer finds is kept in corpus/<harness>/ and stays a test.
#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <random>

#include "harness.h"

namespace pelage::fuzz {

void PrintTo(const Harness& harness, std::ostream* out) {
  *out << harness.name;
}

namespace {

namespace fs = std::filesystem;

struct Input {
  std::string name, bytes;
};

std::vector<Input> inputs(const Harness& harness) {
  std::vector<Input> all;
  const fs::path folder = fs::path(PELAGE_SOURCE_DIR "/tests/fuzz/corpus") / harness.name;
  if (fs::exists(folder))
    for (const auto& entry : fs::directory_iterator(folder))
      all.push_back({entry.path().filename().string(), bytes_of(entry.path())});
  if (harness.seeds) {
    for (const std::string& seed : harness.seeds()) all.push_back({"seed " + std::to_string(all.size()), seed});
  }
  std::ranges::sort(all, {}, &Input::name);
  return all;
}

/// With memory of exactly its size, so that the address sanitizer sees a byte too far.
void run(const Harness& harness, std::string_view bytes, const std::string& what) {
  const std::vector<char> exact(bytes.begin(), bytes.end());
  try {
    harness.run({exact.data(), exact.size()});
  } catch (const std::exception& e) {
    ADD_FAILURE() << what << ": " << e.what();
  }
}

class Replay : public testing::TestWithParam<Harness> {};

TEST_P(Replay, KeptInputs) {
  const std::vector<Input> all = inputs(GetParam());
  EXPECT_FALSE(all.empty());
  for (const Input& input : all) run(GetParam(), input.bytes, input.name);
}

TEST_P(Replay, KeptInputsCutOff) {
  constexpr std::size_t kCuts = 300;  // of a large input; a small one is cut at every byte
  for (const Input& input : inputs(GetParam())) {
    const std::size_t step = std::max<std::size_t>(1, input.bytes.size() / kCuts);
    for (std::size_t size = 0; size < input.bytes.size(); size += step)
      run(GetParam(), input.bytes.substr(0, size), input.name + " cut to " + std::to_string(size));
  }
}

TEST_P(Replay, KeptInputsWithBytesChanged) {
  std::mt19937 random(1);
  for (const Input& input : inputs(GetParam())) {
    for (int k = 0; k < 300 && !input.bytes.empty(); ++k) {
      std::string bytes = input.bytes;
      const std::size_t at = random() % bytes.size();
      bytes[at] = static_cast<char>(bytes[at] ^ static_cast<char>(1 + random() % 255));
      run(GetParam(), bytes, input.name + " with byte " + std::to_string(at) + " changed, round " + std::to_string(k));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Readers, Replay, testing::ValuesIn(harnesses().begin(), harnesses().end()),
                         [](const auto& each) { return std::string(each.param.name); });

}  // namespace
}  // namespace pelage::fuzz
