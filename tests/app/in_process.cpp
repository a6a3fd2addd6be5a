#include "in_process.h"

#include <csignal>

#define main pelage_main
#include "../../runtime/app/main.cpp"
#undef main
#define main bake_main
#include "../../bake/pelage_bake.cpp"
#undef main

namespace pelage::test {
namespace {

/// A program handles these its own way; the test, and what it forks, shall not.
class KeptSignals {
 public:
  KeptSignals() {
    for (std::size_t i = 0; i < 3; ++i) sigaction(kSignals[i], nullptr, &before_[i]);
  }
  ~KeptSignals() {
    for (std::size_t i = 0; i < 3; ++i) sigaction(kSignals[i], &before_[i], nullptr);
  }
  KeptSignals(const KeptSignals&) = delete;
  KeptSignals& operator=(const KeptSignals&) = delete;

 private:
  static constexpr int kSignals[] = {SIGINT, SIGTERM, SIGBUS};
  struct sigaction before_[3];
};

}  // namespace

const Program kPelage{"pelage", pelage_main}, kBake{"bake", bake_main};

ResultHere run_here(const Program& program, const TemporaryFolder& folder, std::vector<std::string> words) {
  for (std::string& word : words)
    if (word.starts_with('@')) word = (folder / word.substr(1)).string();
  words.insert(words.begin(), program.name);
  std::vector<char*> list;
  for (std::string& word : words) list.push_back(word.data());
  list.push_back(nullptr);
  const KeptSignals kept;
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  ResultHere result{program.main(static_cast<int>(words.size()), list.data()), "", ""};
  result.out = testing::internal::GetCapturedStdout();
  result.err = testing::internal::GetCapturedStderr();
  return result;
}

}  // namespace pelage::test
