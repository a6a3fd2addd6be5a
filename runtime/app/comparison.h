// What `pelage compare` finds out: every method's picture of one scene against the ray-traced truth, with what it cost.
// Written as a page, JSON and CSV (comparison_files.h).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pelage/data_schema/stages.h"
#include "pelage/image/picture_error.h"

namespace pelage::app {

/// One frame of an animated comparison.
struct ComparedFrame {
  PictureError error;
  double flicker = 0;  // RMSE of (this frame - the last) against the truth's, linear RGB; 0 in the first frame
  double ms = 0;       // to move, shadow and draw
};

struct ComparedMethod {
  std::string id;                     // "density-map-printed": names its files and --threshold; [a-z0-9-]+
  std::string title;                  // "Density map, as printed"
  std::string what;                   // a sentence: what it does, and what it has of its own here
  std::string command;                // draws this row alone: pelage render ...
  std::string failed;                 // not empty: why there is no picture; nothing below holds then
  PictureError error;                 // against the truth; of an animation: of its first frame
  std::vector<Stage> stages;          // of the first picture: everything is built
  double prepare_ms = 0;              // read, fit, bake or open: once per hair
  double first_ms = 0;                // sum over stages of the first picture
  double again_ms = 0;                // the same for a camera that has moved a little: what need not change is kept
  std::uint64_t bytes = 0;            // most that one frame's stages read, write and upload
  std::string picture;                // file names in the folder: <id>.png, beside it <id>.exr
  std::string error_map;              // <id>-error.png: absolute error of linear luminance on the comparison's scale
  std::string flip_map;               // <id>-flip.png: FLIP in [0, 1]
  std::vector<ComparedFrame> frames;  // animated comparisons only
  double flicker = 0;                 // RMS over its frames after the first
};

struct Comparison {
  std::string name;      // of the hair
  std::string command;   // that made it
  std::string scene;     // resolved scene as JSON
  std::string revision;  // of the program
  std::string cpu;
  int threads = 0;
  int width = 0, height = 0;
  double fps = 0;             // of an animated comparison
  float error_scale = 0.25F;  // the error map's end: this error of linear luminance and more
  int truth_samples = 0;      // per pixel
  /// What the truth's own noise does to the figures: error of one half of its samples against the other, halved
  /// (RMSE and FLIP); bias: the standard error of a mean over independent pixels.
  PictureError truth_noise;
  double flicker_noise = 0;             // the same of flicker: what an exact method would show
  std::vector<ComparedMethod> methods;  // the truth first
};

}  // namespace pelage::app
