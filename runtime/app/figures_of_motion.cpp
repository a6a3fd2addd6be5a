#include "pelage/app/figures_of_motion.h"

#include <fmt/format.h>

#include "pelage/app/figure_sheet.h"
#include "pelage/app/framing.h"
#include "pelage/console/program.h"
#include "pelage/console/progress.h"
#include "pelage/simulate/head_motion.h"
#include "pelage/simulate/moving_hair.h"

namespace pelage::app {
namespace {

constexpr double kFps = 60;

/// Moves hair from rest to a time of its motion and draws it there.
class Mover {
 public:
  Mover(const Subject& s, const SimulationSettings& settings)
      : settings_(settings),
        drawing_(make_strand_drawing(Method::density_map, s.hair, s.head)),
        hair_(s.hair.strands, s.head, settings) {
    hair_.begin(pose(0), settings.life.settle_s, console::throw_if_interrupted);
  }
  /// @param time_s  not before the last one
  Image at(double time_s, const Scene& scene) {
    for (; (frame_ + 0.5) / kFps < time_s; ++frame_) hair_.advance(1 / kFps, pose((frame_ + 1) / kFps));
    drawing_->move(hair_.hair(), hair_.pose().rotation, hair_.head());
    return picture_of(*drawing_, scene);
  }
  /// One camera for all pictures up to a time.
  Camera camera(const Scene& scene, double seconds) const {
    return framed_camera(carried_points(drawing_->lines(), drawing_->head(), settings_.motion, hair_.pivot(), seconds),
                         aspect_of(scene.image));
  }

 private:
  RigidPose pose(double time_s) const { return head_pose(settings_.motion, hair_.pivot(), time_s); }

  SimulationSettings settings_;
  std::unique_ptr<Drawing> drawing_;
  MovingHair hair_;
  int frame_ = 0;
};

}  // namespace

Image motion_figure(Scene scene) {
  constexpr int kPictures = 5;
  constexpr double kBetween_s = 0.55;
  const Subject s = subject_of(scene, hair::GroomStyle::wavy, 8'000);
  SimulationSettings settings = scene.simulation;
  settings.motion.kind = MotionKind::dance;
  scene.method = Method::density_map;
  Sheet sheet({kPictures, 1}, size_of(scene));
  Mover mover(s, settings);
  if (!scene.camera) scene.camera = mover.camera(scene, kPictures * kBetween_s);
  console::Progress progress("drawing", kPictures, "pictures");
  for (int i = 0; i < kPictures; ++i) {
    sheet.put({i, 0}, mover.at(i * kBetween_s, scene), fmt::format("{:.2f} s", i * kBetween_s),
              i == 0 ? "dance, " + settings.name : "");
    progress.update(static_cast<std::uint64_t>(i) + 1);
  }
  return sheet.image();
}

Image presets_figure(Scene scene) {
  constexpr double kMoment_s = 0.45;
  const std::vector<std::string> names{"loose", "straight", "wavy", "curly", "hold-shape", "wet"};
  const Subject s = subject_of(scene, hair::GroomStyle::straight, 6'000);
  scene.method = Method::density_map;
  Sheet sheet({static_cast<int>(names.size()) / 2, 2}, size_of(scene));
  console::Progress progress("drawing", names.size(), "pictures");
  for (std::size_t i = 0; i < names.size(); ++i) {
    Mover mover(s, simulation_preset(names[i]));
    if (!scene.camera) scene.camera = mover.camera(scene, kMoment_s);
    sheet.put({static_cast<int>(i % 3), static_cast<int>(i / 3)}, mover.at(kMoment_s, scene), names[i], "");
    progress.update(i + 1);
  }
  return sheet.image();
}

}  // namespace pelage::app
