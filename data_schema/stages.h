// A frame is a short list of named stages, each with its time, bytes and calls; `--stats` prints them.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace pelage {

struct Stage {
  std::string name;
  double milliseconds = 0;  // wall, this frame
  std::uint64_t bytes = 0;  // read and written, or uploaded
  std::uint64_t calls = 0;  // since the ledger began
};

class StageLedger {
 public:
  /// Times one call of a stage until it goes out of scope.
  class Timer {
   public:
    Timer(StageLedger& ledger, std::size_t stage)
        : ledger_(ledger), stage_(stage), start_(std::chrono::steady_clock::now()) {}
    ~Timer();
    Timer(const Timer&) = delete;
    Timer& operator=(const Timer&) = delete;
    void bytes(std::uint64_t n) noexcept { ledger_.stages_[stage_].bytes += n; }

   private:
    StageLedger& ledger_;
    std::size_t stage_;
    std::chrono::steady_clock::time_point start_;
  };

  /// Sets times and bytes back to 0; call counts stay.
  void begin_frame() noexcept;
  Timer run(const std::string& name);
  const std::vector<Stage>& stages() const noexcept { return stages_; }
  /// What was timed elsewhere: adds time, bytes and calls to the stage of that name.
  void add(const Stage& part);
  /// Calls of a stage so far; 0 if it never ran.
  std::uint64_t calls(const std::string& name) const noexcept;

 private:
  std::size_t stage(const std::string& name);
  std::vector<Stage> stages_;
};

}  // namespace pelage
