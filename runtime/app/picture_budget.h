// Settings of a picture for the time there is or the error that is accepted: `render --budget-ms`, `--target-error`.
// Candidates are points of the fronts of reference scenes (runtime/tradeoff/picture_ladder.json): methods with their
// resolutions and samples; what the scene shows is never touched. A few of them draw this scene as it is asked for, and
// are compared with the truth at some thousand pixels drawn at random from those that show anything.
//
// Time: of a frame in which the hair has moved. Error: RMSE of linear RGB over the whole picture.
#pragma once

#include <memory>

#include "pelage/app/budget.h"
#include "pelage/app/drawing.h"

namespace pelage::app {

struct ChosenPicture {
  Budget budget;
  Scene scene;  // with the chosen settings
  Camera camera;
  std::unique_ptr<Drawing> drawing;
  Image image;  // as Drawing::render gives it
};

/// Needs a current OpenGL context.
/// @param method  candidates of this one only; none: of all
/// @throws UsageError where the ladder has none of that method, Interrupted
ChosenPicture choose_picture(const Scene& scene, const Goal& goal, std::optional<Method> method);

}  // namespace pelage::app
