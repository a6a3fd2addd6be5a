#include "pelage/app/moved_frames.h"

#include "pelage/console/progress.h"

namespace pelage::app {

MovedFrames simulate_frames(const Strands& lines, const Mesh& head, const SimulationSettings& settings, int frames,
                            double fps, const std::string& label) {
  Clip clip(lines, head, settings, fps, frames / fps);
  clip.begin();
  console::Progress progress("simulating " + label, static_cast<std::uint64_t>(frames), "frames");
  MovedFrames moved{{}, clip.hair().pivot()};
  for (int k = 0; k < frames; ++k) {
    clip.advance(k);
    moved.frames.push_back({clip.hair().hair(), clip.hair().pose().rotation, clip.hair().head()});
    progress.update(static_cast<std::uint64_t>(k) + 1);
  }
  return moved;
}

}  // namespace pelage::app
