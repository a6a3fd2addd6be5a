#include "pelage/app/picture_budget.h"
#include "pelage/app/framing.h"

#include <fmt/format.h>

#include <algorithm>
#include <random>

#include "ladders.h"
#include "pelage/app/compared_truth.h"
#include "pelage/app/ladder.h"
#include "pelage/app/picture.h"
#include "pelage/app/picture_truth.h"
#include "pelage/app/repeat.h"
#include "pelage/console/program.h"
#include "pelage/console/progress.h"
#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/scene_values.h"

namespace pelage::app {
namespace {

constexpr int kMostProbes = 7;
/// Leave an error bar of some per cent.
constexpr std::size_t kPixels = 4000;
constexpr int kSamples = 64;
/// Of the small picture that says which pixels show anything.
constexpr int kMaskSide = 160;
constexpr std::uint64_t kMaskSeed = 10, kProbeSeed = 11, kFinalSeed = 12;
constexpr RepeatLimits kProbeFrames{2, 7, 400}, kFinalFrames{3, 9, 800};

/// Pixels at random from those that show hair or head, and what share of the picture those are.
class ShownPixels {
 public:
  ShownPixels(const StrandHair& hair, const Mesh& head, const Scene& scene, const Camera& camera)
      : width_(scene.image.width), height_(scene.image.height) {
    Scene small = scene;
    const double shrink = std::max(1.0, static_cast<double>(std::max(width_, height_)) / kMaskSide);
    small.image.width = across_ = std::max(1, static_cast<int>(width_ / shrink));
    small.image.height = down_ = std::max(1, static_cast<int>(height_ / shrink));
    small.image.background.reset();
    small.truth.samples = 8;
    const std::vector<float> seen = PictureTruth(hair, head, small, camera).alpha(kMaskSeed);
    for (int y = 0; y < down_; ++y)
      for (int x = 0; x < across_; ++x)
        if (near(seen, x, y)) cells_.emplace_back(x, y);
    if (!cells_.empty()) return;
    for (int i = 0; i < across_ * down_; ++i) cells_.emplace_back(i % across_, i / across_);
  }

  double share() const { return static_cast<double>(cells_.size()) / (static_cast<double>(across_) * down_); }

  std::vector<glm::ivec2> draw(std::uint64_t seed) const {
    std::mt19937_64 random(seed);
    const auto within = [&](int cell, int cells, int pixels) {
      const auto first = static_cast<std::int64_t>(cell) * pixels / cells;
      const auto end = std::max(first + 1, static_cast<std::int64_t>(cell + 1) * pixels / cells);
      return static_cast<int>(first + static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(end - first)));
    };
    std::vector<glm::ivec2> pixels;
    for (std::size_t i = 0; i < kPixels; ++i) {
      const glm::ivec2 cell = cells_[random() % cells_.size()];
      const int x = within(cell.x, across_, width_), y = within(cell.y, down_, height_);
      pixels.emplace_back(x, y);
    }
    return pixels;
  }

 private:
  /// Does the cell or a neighbour show anything?
  bool near(const std::vector<float>& alpha, int x, int y) const {
    for (int v = std::max(y - 1, 0); v <= std::min(y + 1, down_ - 1); ++v)
      for (int u = std::max(x - 1, 0); u <= std::min(x + 1, across_ - 1); ++u)
        if (alpha[static_cast<std::size_t>(v) * static_cast<std::size_t>(across_) + static_cast<std::size_t>(u)] > 0)
          return true;
    return false;
  }

  int width_, height_, across_ = 1, down_ = 1;
  std::vector<glm::ivec2> cells_;
};

/// The truth at some pixels.
struct Spot {
  std::vector<glm::ivec2> pixels;
  TruthHalves halves;
};

class PictureSearch {
 public:
  explicit PictureSearch(const Scene& scene)
      : scene_(scene),
        hair_(prepare_strands(scene)),
        head_(prepare_head(scene)),
        camera_(camera_of(scene, hair_.strands, head_)) {
    Scene wanted = scene;
    wanted.truth.samples = kSamples;
    truth_.emplace(hair_, head_, wanted, camera_);
    console::throw_if_interrupted();
    shown_.emplace(hair_, head_, scene, camera_);
    probe_ = spot(kProbeSeed);
  }

  const Camera& camera() const { return camera_; }
  std::string truth() const {
    return fmt::format("the ray-traced picture, {} rays each at {} pixels drawn from the {:.0f} % that show anything",
                       kSamples, kPixels, 100 * shown_->share());
  }
  Spot spot(std::uint64_t seed) const {
    Spot s{shown_->draw(seed), {}};
    s.halves = truth_->at(s.pixels, seed);
    return s;
  }
  std::unique_ptr<Drawing> make(const Scene& scene) const {
    return scene.method == Method::satf ? make_drawing(scene) : make_strand_drawing(scene.method, hair_, head_);
  }
  Probe measure(Drawing& drawing, const Scene& scene, const Spot& at, const RepeatLimits& frames, Image& image) const {
    const std::vector<double> ms = repeated_ms(
        [&] {
          drawing.refresh();
          image = drawing.render(scene, camera_);
        },
        frames);
    const Image picture = finished(Image(image), scene.image);
    const NoisyError e = noisy_rmse(values_at(picture, at.pixels), at.halves.a, at.halves.b, Pixels::sample);
    const double whole = std::sqrt(shown_->share());
    return {whole * e.rmse, whole * e.standard_error, median_of(ms)};
  }
  Probe probe(const Scene& scene) const {
    Image image;
    return measure(*make(scene), scene, probe_, kProbeFrames, image);
  }

 private:
  const Scene& scene_;
  StrandHair hair_;
  Mesh head_;
  Camera camera_;
  std::optional<PictureTruth> truth_;
  std::optional<ShownPixels> shown_;
  Spot probe_;
};

/// Those of the method that was asked for.
std::vector<Candidate> candidates_for(const Scene& scene, std::optional<Method> method) {
  std::vector<Candidate> candidates = read_ladder(data::picture_ladder_json, "picture_ladder.json").candidates;
  std::erase_if(candidates,
                [&](const Candidate& c) { return method && with_values(scene, c.settings).method != *method; });
  if (candidates.empty())
    throw UsageError(
        "--method: no setting of that method is on the front of any reference scene; leave --method out, or "
        "--budget-ms and --target-error");
  return candidates;
}

}  // namespace

ChosenPicture choose_picture(const Scene& scene, const Goal& goal, std::optional<Method> method) {
  const std::vector<Candidate> ladder = candidates_for(scene, method);
  console::Progress progress("choosing settings of the picture", kMostProbes + 2, "probes");
  const PictureSearch search(scene);
  std::uint64_t done = 0;
  progress.update(++done);
  ChosenPicture chosen;
  chosen.camera = search.camera();
  Budget& budget = chosen.budget;
  budget.goal = goal;
  budget.choice = choose(
      ladder, goal,
      [&](std::size_t candidate) {
        const Probe probe = search.probe(with_values(scene, ladder[candidate].settings));
        progress.update(++done);
        return probe;
      },
      kMostProbes);
  budget.settings = ladder[budget.choice.candidate].settings;
  budget.error_name = "RMSE";
  budget.truth = search.truth();
  chosen.scene = with_values(scene, budget.settings);
  chosen.drawing = search.make(chosen.scene);
  // Pixels and rays that no choice was made by.
  budget.achieved = search.measure(*chosen.drawing, chosen.scene, search.spot(kFinalSeed), kFinalFrames, chosen.image);
  budget.achieved_ms = budget.achieved->ms;
  progress.update(kMostProbes + 2);
  return chosen;
}

}  // namespace pelage::app
