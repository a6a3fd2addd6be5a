// Measures every point of given knobs and keeps each on disk as soon as it is known, so that a sweep that was
// interrupted goes on where it stood.
//
// Points of one measure share its truth. A point whose scene is that of another point has its figures. After the knobs
// alone, settings of several knobs with one base are put together: those whose errors and times, predicted as if knobs
// did not know of each other, would be on the front are measured as well ("combined").
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pelage/app/measure.h"
#include "pelage/data_schema/knob.h"
#include "pelage/tradeoff/tradeoff.h"

namespace pelage::app {

struct SweepRequest {
  MeasureRequest measure;
  std::vector<Knob> knobs;
  std::filesystem::path folder;  // there is a folder "points" in it for rows and pictures
  std::string name;              // of the hair
  std::string command;           // that made it
  std::string row_words;         // input and options that all rows share: "hair.tfx --head head.obj"
  bool combine = true;
  std::function<void()> after_point;  // may be empty
  /// The measure of a kind; tests put their own here.
  std::function<std::unique_ptr<Measure>(MeasureKind, const MeasureRequest&)> make_measure;
};

/// @throws Interrupted with what is known so far on disk, OutputError
Tradeoff sweep(const SweepRequest& request);

/// The program's own measures.
std::unique_ptr<Measure> make_measure(MeasureKind kind, const MeasureRequest& request);

}  // namespace pelage::app
