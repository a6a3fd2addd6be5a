#include "pelage/app/drawing.h"

#include "pelage/app/picture_truth.h"
#include "pelage/console/program.h"
#include "pelage/console/progress.h"
#include "pelage/data_schema/errors.h"
#include "pelage/hair/catmull_rom.h"
#include "pelage/reference/truth_image.h"
#include "pelage/render/satf_frame.h"
#include "pelage/render/strand_frame.h"
#include "pelage/simulate/moving_clusters.h"

namespace pelage::app {
namespace {

/// A window has no transparency: the default background shows there.
Presentation presentation_of(const ImageSettings& image) {
  return {image.exposure, image.background.value_or(*ImageSettings{}.background), image.backdrop};
}

FrameSettings settings_of(const SatfFrame&, const Scene& scene, const Camera& camera) {
  return {camera, scene.lights, scene.material, scene.satf};
}

StrandFrameSettings settings_of(const StrandFrame&, const Scene& scene, const Camera& camera) {
  return {camera, scene.lights, scene.material, scene.method, scene.strands, scene.shadow, scene.bake.phong};
}

/// Draws frames with OpenGL.
template <class Frame>
class FrameDrawing : public Drawing {
 public:
  template <class... Parts>
  explicit FrameDrawing(std::string name, Parts&&... parts)
      : Drawing(std::move(name)), frame_(std::forward<Parts>(parts)...) {}

  Mesh head() const override { return frame_.head(); }
  void refresh() override { frame_.refresh(); }
  const StageLedger& ledger() const override { return frame_.ledger(); }

 protected:
  Frame frame_;

 private:
  Image draw(const Scene& scene, const Camera& camera) override {
    const ImageSettings& p = scene.image;
    std::optional<console::Progress> progress;  // of pictures of several tiles
    return frame_.render(settings_of(frame_, scene, camera), p.width, p.height, p.supersampling, kTileSamples,
                         [&](int done, int total) {
                           console::throw_if_interrupted();
                           if (total == 1) return;
                           if (!progress)
                             progress.emplace("drawing " + name(), static_cast<std::uint64_t>(total), "tiles");
                           progress->update(static_cast<std::uint64_t>(done));
                         });
  }
  void draw_in_window(const Scene& scene, const Camera& camera, int width, int height) override {
    frame_.show(settings_of(frame_, scene, camera), width, height, presentation_of(scene.image));
  }
};

class StrandDrawing final : public FrameDrawing<StrandFrame> {
 public:
  StrandDrawing(StrandHair hair, Mesh head)
      : FrameDrawing(std::move(hair.name), std::move(hair.strands), hair.opacity, std::move(head)) {}
  Strands lines() const override { return frame_.strands(); }
  HairFacts facts() const override { return {&frame_.strands(), nullptr, &frame_.head(), frame_.opacity()}; }
  void move(const Strands& lines, const glm::dquat&, Mesh head) override {
    frame_.set_geometry(lines, std::move(head));
  }
};

class SatfDrawing final : public FrameDrawing<SatfFrame> {
 public:
  SatfDrawing(const Hairstyle& style, std::unique_ptr<RecordSource> records, const BakeSettings& bake, Mesh head,
              std::optional<MovingClusters> clusters)
      : FrameDrawing(style.name, style, std::move(records), bake, std::move(head)), clusters_(std::move(clusters)) {}
  Strands lines() const override { return clusters_ ? clusters_->lines() : Strands{}; }
  void move(const Strands& lines, const glm::dquat& turn, Mesh head) override {
    if (!clusters_) return;
    clusters_->move(lines, turn);
    frame_.move_hair(clusters_->style().clusters);
    frame_.move_head(std::move(head));
  }
  HairFacts facts() const override { return {nullptr, &frame_.style(), &frame_.head(), frame_.style().opacity}; }
  std::uint64_t searches() const override { return frame_.source().searches(); }

 private:
  std::optional<MovingClusters> clusters_;  // none: they stand still
};

std::unique_ptr<Drawing> satf_drawing(const Scene& scene, bool moving) {
  Mesh head = prepare_head(scene);  // first: what is wrong with it shows before the bake
  Hairstyle style = prepare_hairstyle(scene);
  std::optional<MovingClusters> clusters;
  if (moving) style = clusters.emplace(std::move(style)).style();
  BakeSettings bake;
  std::unique_ptr<RecordSource> records = prepare_records(scene, style, bake);
  console::throw_if_interrupted();
  return std::make_unique<SatfDrawing>(style, std::move(records), bake, std::move(head), std::move(clusters));
}

class TruthDrawing final : public Drawing {
 public:
  TruthDrawing(StrandHair hair, Mesh head) : Drawing(std::move(hair.name)), opacity_(hair.opacity) {
    set(hair.strands, std::move(head));
  }
  void refresh() override { build(); }
  void set_seed(std::uint64_t seed) override { seed_ = seed; }
  Strands lines() const override { return lines_; }
  Mesh head() const override { return head_; }
  void move(const Strands& lines, const glm::dquat&, Mesh head) override { set(lines, std::move(head)); }
  void set(const Strands& lines, Mesh head) {
    scene_.reset();  // it looks at the head
    lines_ = lines;
    head_ = std::move(head);
    build();
  }
  void build() {
    scene_.reset();  // it looks at what follows
    if (smoothing_ > 1) {
      auto stage = ledger_.run("smooth");
      strands_ = hair::smooth(lines_, smoothing_);
    } else {
      strands_ = lines_;
    }
    auto stage = ledger_.run("hierarchy");
    scene_.emplace(strands_, opacity_, head_.triangles.empty() ? nullptr : &head_);
  }
  HairFacts facts() const override { return {&lines_, nullptr, &head_, opacity_}; }
  const StageLedger& ledger() const override { return ledger_; }

 private:
  Image draw(const Scene& scene, const Camera& camera) override {
    if (scene.strands.smoothing != smoothing_) {
      smoothing_ = scene.strands.smoothing;
      build();
    }
    TruthRequest request = truth_request(scene, camera);
    request.seed = seed_;
    auto stage = ledger_.run("trace");
    console::Progress progress("tracing " + name(),
                               static_cast<std::uint64_t>(request.width) * static_cast<std::uint64_t>(request.height),
                               "pixels");
    Image image(request.width, request.height);
    image.rgba = truth_image(*scene_, strands_, request, [&](std::uint64_t done, std::uint64_t) {
      console::throw_if_interrupted();
      progress.update(done);
    });
    return image;
  }
  void draw_in_window(const Scene&, const Camera&, int, int) override {
    throw UsageError("the truth has no frames to show");
  }

  Strands lines_, strands_;  // as given; smoothed
  Mesh head_;
  float opacity_;
  int smoothing_ = 1;
  std::uint64_t seed_ = 1;
  StageLedger ledger_;
  std::optional<FibreScene> scene_;
};

}  // namespace

const Scene& Drawing::planned(const Scene& scene, const Camera& camera) {
  Scene seen = scene;
  seen.camera = camera;
  plan_ = plan_effects(seen, facts(), Task::picture);
  return plan_.scene;
}

bool needs_opengl(Method method) noexcept {
  return method != Method::truth;
}

std::unique_ptr<Drawing> make_strand_drawing(Method method, StrandHair hair, Mesh head) {
  if (method == Method::truth) return std::make_unique<TruthDrawing>(std::move(hair), std::move(head));
  return std::make_unique<StrandDrawing>(std::move(hair), std::move(head));
}

std::unique_ptr<Drawing> make_drawing(const Scene& scene, bool moving) {
  if (scene.method == Method::satf) return satf_drawing(scene, moving);
  StrandHair hair = prepare_strands(scene);
  console::throw_if_interrupted();
  return make_strand_drawing(scene.method, std::move(hair), prepare_head(scene));
}

}  // namespace pelage::app
