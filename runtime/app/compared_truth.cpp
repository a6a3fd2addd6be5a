#include "pelage/app/compared_truth.h"

#include <chrono>
#include <cmath>

#include "pelage/app/picture.h"
#include "pelage/app/stopwatch.h"

namespace pelage::app {
namespace {

constexpr double kTwice_dB = 6.020599913279624;  // 20 log10 2

/// Of the mean of two halves: half of what they differ by.
PictureError halved(PictureError e) {
  for (double* const length : {&e.rmse, &e.flip, &e.max, &e.rmse_covered}) *length /= 2;
  e.rel_mse /= 4;
  e.psnr_db += kTwice_dB;
  return e;
}

Image mean_of(const Image& a, const Image& b) {
  Image mean(a.width, a.height);
  for (std::size_t i = 0; i < mean.rgba.size(); ++i) mean.rgba[i] = 0.5F * (a.rgba[i] + b.rgba[i]);
  return mean;
}

struct Halves {
  Image a, b;  // exposed and over the background
};

/// The same rays in each frame, so that what stands still does not flicker.
Halves draw_halves(Drawing& drawing, const Scene& scene, const Camera& camera, TruthFrame& frame) {
  drawing.set_seed(1);
  Image a = drawing.render(scene, camera);
  drawing.set_seed(2);
  Image b = drawing.render(scene, camera);
  frame.alpha = alpha_of(mean_of(a, b));
  Halves halves{finished(std::move(a), scene.image), finished(std::move(b), scene.image)};
  frame.picture = mean_of(halves.a, halves.b);
  return halves;
}

void note_costs(const Drawing& drawing, ComparedTruth& truth) {
  truth.stages = drawing.ledger().stages();
  for (const Stage& s : truth.stages) {
    truth.first_ms += s.milliseconds;
    if (s.name == "trace") truth.again_ms += s.milliseconds;
  }
}

}  // namespace

ComparedTruth draw_truth(Drawing& drawing, const Scene& scene, const Camera& camera,
                         std::span<const MovedFrame> frames) {
  ComparedTruth truth;
  Halves last;
  double squares = 0;
  const std::size_t count = std::max<std::size_t>(frames.size(), 1);
  for (std::size_t k = 0; k < count; ++k) {
    const auto begin = std::chrono::steady_clock::now();
    if (k > 0) drawing.move(frames[k].lines, frames[k].turn, frames[k].head);
    Halves now = draw_halves(drawing, scene, camera, truth.frames.emplace_back());
    truth.ms.push_back(ms_since(begin));
    if (k == 0) {
      note_costs(drawing, truth);
      truth.noise = halved(picture_error(now.a, now.b, truth.frames[0].alpha));
      // Not the halves' own difference, which may be anything: the standard error of a mean over independent pixels.
      truth.noise.bias = truth.noise.rmse / std::sqrt(static_cast<double>(now.a.width) * now.a.height);
      truth.half = now.a;
    } else {
      squares += std::pow(0.5 * flicker(now.a, last.a, now.b, last.b), 2);
    }
    last = std::move(now);
  }
  if (count > 1) truth.flicker_noise = std::sqrt(squares / static_cast<double>(count - 1));
  return truth;
}

}  // namespace pelage::app
