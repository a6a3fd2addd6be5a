// Draws one scene with every method and tells how far each is from the ray-traced truth, and what it costs.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "pelage/app/compare_methods.h"
#include "pelage/app/comparison.h"
#include "pelage/data_schema/scene.h"

namespace pelage::app {

struct CompareRequest {
  Scene scene;                         // truth.samples: of both halves together
  std::vector<CompareMethod> methods;  // the truth first
  std::filesystem::path folder;        // pictures go there, each as soon as it is drawn
  std::string command;                 // that made it
  std::string row_command;             // "pelage render scene.json --light ...": what all rows share
  std::string order, clusters_order;   // --order as given, for rows of strands and of clusters
  bool names_database = false;         // does the input name a database of its own?
  float error_scale = 0.25F;
  int frames = 0;  // animated: more than 1
  double fps = 30;
};

/// What cannot be drawn is a row with `failed`. Needs a current OpenGL context where a method does.
/// @throws Interrupted, OutputError where a picture cannot be written, and what reading the hair throws
Comparison compare(const CompareRequest& request);

}  // namespace pelage::app
