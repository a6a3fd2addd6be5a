// The truth of a comparison: pictures of all frames, twice with independent rays, so that their noise is known.
#pragma once

#include <span>
#include <vector>

#include "pelage/app/comparison.h"
#include "pelage/app/drawing.h"
#include "pelage/app/moved_frames.h"

namespace pelage::app {

struct TruthFrame {
  Image picture;             // mean of both halves, exposed and over the background
  std::vector<float> alpha;  // before that
};

struct ComparedTruth {
  std::vector<TruthFrame> frames;
  Image half;                // of the first frame: one of both halves, exposed and over the background
  PictureError noise;        // as Comparison has it
  double flicker_noise = 0;  // RMS over the frames after the first
  std::vector<double> ms;    // of each frame
  std::vector<Stage> stages;
  double first_ms = 0, again_ms = 0;
};

/// @param scene   with method truth and the samples of one half
/// @param frames  empty: the hair as it is, one frame
ComparedTruth draw_truth(Drawing& drawing, const Scene& scene, const Camera& camera,
                         std::span<const MovedFrame> frames);

}  // namespace pelage::app
