// Progress on stderr: a bar with rate and ETA on a terminal, sparse lines otherwise (at most one every 5 s), nothing
// with
// --progress never.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace pelage::console {

/// Where the work stands.
struct ProgressState {
  std::uint64_t done = 0, total = 1;
  std::uint64_t first_done = 0;  // done when the clock started: a resumed bake does not count what it found
  double elapsed_s = 0;
};

/// "bake: 45 %, 900/2000 sectors, 512 sectors/s, ETA 0:02"; rate and ETA once they are known.
std::string progress_text(const std::string& label, const std::string& unit, const ProgressState& state);

class Progress {
 public:
  /// @param total  number of steps, > 0      @param unit  what a step is, plural: "sectors"
  Progress(std::string label, std::uint64_t total, std::string unit);
  ~Progress();  ///< ends the line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Steps done so far; from one thread at a time. Cheap when nothing is due to be drawn.
  void update(std::uint64_t done);

 private:
  void draw(std::uint64_t done);

  std::string label_, unit_;
  std::uint64_t total_, first_done_ = 0;
  bool bar_, silent_, drawn_ = false, first_ = true;
  std::chrono::steady_clock::time_point start_, last_;
};

}  // namespace pelage::console
