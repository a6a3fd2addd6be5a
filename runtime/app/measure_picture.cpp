#include <fmt/format.h>

#include <chrono>

#include "pelage/app/compared_truth.h"
#include "pelage/app/drawing.h"
#include "pelage/app/framing.h"
#include "pelage/app/measure.h"
#include "pelage/app/picture.h"
#include "pelage/app/picture_truth.h"
#include "pelage/app/repeat.h"
#include "pelage/app/stopwatch.h"
#include "pelage/image/picture_error.h"

namespace pelage::app {
namespace {

/// Rays per pixel of the truth, both halves together.
constexpr int kSamples = 256, kQuickSamples = 96;

class PictureMeasure final : public Measure {
 public:
  explicit PictureMeasure(const MeasureRequest& request) : scene_(request.scene) {
    hair_ = prepare_strands(scene_);
    head_ = prepare_head(scene_);
    const ImageSettings& image = scene_.image;
    camera_ = camera_of(scene_, hair_.strands, head_);
    Scene wanted = scene_;
    wanted.truth.samples = std::max(wanted.truth.samples, request.quick ? kQuickSamples : kSamples);
    const PictureTruth truth(hair_, head_, wanted, camera_);
    halves_ = truth.whole(request.seed, hair_.name);
    truth_ = Image(image.width, image.height);
    for (std::size_t i = 0; i < truth_.rgba.size(); ++i) truth_.rgba[i] = 0.5F * (halves_.a[i] + halves_.b[i]);
    opaque_.assign(truth_.rgba.size() / 4, 1.0F);
    describe(wanted);
  }

  const MeasureFacts& facts() const override { return facts_; }
  std::pair<std::string, std::string> command() const override { return {"render", "-o picture.png"}; }

  Measured measure(const Scene& scene) override {
    const auto begin = std::chrono::steady_clock::now();
    const std::unique_ptr<Drawing> drawing =
        scene.method == Method::satf ? make_drawing(scene) : make_strand_drawing(scene.method, hair_, head_);
    Measured result;
    result.prepare_ms = ms_since(begin);
    Image image;
    result.ms = repeated_ms(
        [&] {
          drawing->refresh();
          image = drawing->render(scene, camera_);
        },
        {3, 9, 1500});
    for (const Stage& stage : drawing->ledger().stages()) result.bytes += stage.bytes;
    Image picture = finished(std::move(image), scene.image);
    const NoisyError error = noisy_rmse(picture.rgba, halves_.a, halves_.b, Pixels::all);
    result.error = error.rmse;
    result.error_bar = error.standard_error;
    const PictureError all = picture_error(picture, truth_, opaque_);
    result.others = {{"flip", all.flip}, {"bias", all.bias}, {"max", all.max}, {"psnr_db", all.psnr_db}};
    result.picture = std::move(picture);
    return result;
  }

 private:
  void describe(const Scene& wanted) {
    const NoisyError own = noisy_rmse(halves_.a, halves_.b, halves_.b, Pixels::all);
    facts_ = {"picture",
              "Pictures",
              "RMSE of linear RGB",
              "",
              "a frame in which the hair has moved: everything but reading, fitting and baking",
              fmt::format("The ray-traced picture, {} x {} pixels, {} rays each in two independent halves. The mean of "
                          "(x - a)(x - b) over the halves a and b has none of their noise in it, which is {:.4f} in "
                          "their mean; the error bar is what that noise leaves open.",
                          wanted.image.width, wanted.image.height, wanted.truth.samples, 0.5 * own.rmse)};
  }

  Scene scene_;
  StrandHair hair_;
  Mesh head_;
  Camera camera_;
  TruthHalves halves_;
  Image truth_;
  std::vector<float> opaque_;
  MeasureFacts facts_;
};

}  // namespace

std::unique_ptr<Measure> measure_picture(const MeasureRequest& request) {
  return std::make_unique<PictureMeasure>(request);
}

}  // namespace pelage::app
