// Motion of the hair over a clip against a converged run of it (converged_motion.h).
#include "pelage/app/converged_motion.h"
#include "pelage/app/figure_sheet.h"
#include "pelage/app/measure.h"

namespace pelage::app {
namespace {

constexpr std::size_t kStrands = 2000, kQuickStrands = 500;  // at most: more take longer, and tell no more
constexpr int kFinest = 1920, kQuickFinest = 960;            // internal steps per second
constexpr ClipLength kClip{30, 1}, kQuickClip{30, 0.4};
constexpr int kPictureWidth = 320, kPictureHeight = 240, kPictureSamples = 4;
constexpr float kAspect = static_cast<float>(kPictureWidth) / kPictureHeight;

/// Of the hair in all frames.
std::vector<glm::vec3> points_of(const ConvergedMotion& converged) {
  std::vector<glm::vec3> points;
  for (const Strands& frame : converged.frames())
    points.insert(points.end(), frame.vertices.begin(), frame.vertices.end());
  return points;
}

class MotionMeasure final : public Measure {
 public:
  explicit MotionMeasure(const MeasureRequest& request)
      : quick_(request.quick),
        converged_(
            request.scene,
            thinned({prepare_strands(request.scene), prepare_head(request.scene)}, quick_ ? kQuickStrands : kStrands),
            quick_ ? kQuickClip : kClip, quick_ ? kQuickFinest : kFinest) {
    facts_ = {"motion",
              "Motion: places of the hair",
              "RMS distance of drawn vertices",
              "mm",
              "a frame: chains, voxels and drawn strands",
              converged_.what()};
    camera_ = request.scene.camera.value_or(framed_camera(points_of(converged_), kAspect));
  }
  const MeasureFacts& facts() const override { return facts_; }
  std::pair<std::string, std::string> command() const override { return {"simulate", "--stats"}; }

  Measured measure(const Scene& scene) override {
    const ClipRun run = converged_.run(scene);
    const ClipError error = converged_.error_of(run);
    Measured m;
    m.error = error.rms_mm;
    m.error_bar = converged_.own_error_mm();
    m.others = {{"p99", error.p99_mm}, {"max", error.max_mm}, {"end", error.end_rms_mm}};
    m.ms = {run.median_ms()};
    for (int i = 1; i < (quick_ ? 2 : 3); ++i) m.ms.push_back(converged_.run(scene).median_ms());
    m.prepare_ms = run.prepare_ms;
    m.bytes = run.bytes;
    if (!quick_) m.picture = picture(scene, run);
    return m;
  }

 private:
  /// The last frame, traced: without OpenGL.
  Image picture(Scene scene, const ClipRun& run) const {
    StrandHair hair{converged_.subject().hair.name, run.frames.back(), converged_.subject().hair.opacity};
    const std::unique_ptr<Drawing> drawing = make_strand_drawing(Method::truth, std::move(hair), run.head);
    scene.method = Method::truth;
    scene.camera = camera_;
    scene.image.width = kPictureWidth, scene.image.height = kPictureHeight;
    scene.truth.samples = kPictureSamples;
    return picture_of(*drawing, scene);
  }

  bool quick_;
  ConvergedMotion converged_;
  MeasureFacts facts_;
  Camera camera_;
};

}  // namespace

std::unique_ptr<Measure> measure_motion(const MeasureRequest& request) {
  return std::make_unique<MotionMeasure>(request);
}

}  // namespace pelage::app
