#include "pelage/app/picture_truth.h"

#include <algorithm>

#include "pelage/app/picture.h"
#include "pelage/console/program.h"
#include "pelage/console/progress.h"
#include "pelage/effects/plan.h"
#include "pelage/hair/catmull_rom.h"
#include "pelage/image/tone.h"
#include "pelage/render/strand_frame.h"

namespace pelage::app {
namespace {

/// Far from the seeds that `pelage render` and `compare` draw with.
constexpr std::uint64_t kFirstSeed = 1'000'000;

}  // namespace

TruthRequest truth_request(const Scene& planned, const Camera& camera) {
  TruthRequest request;
  request.camera = camera;
  request.width = planned.image.width;
  request.height = planned.image.height;
  request.lights = planned.lights;
  request.material = material_of(planned.material, planned.strands.lobes);
  request.lobes = {planned.strands.diffuse, planned.strands.primary_highlight, planned.strands.secondary_highlight};
  request.phong = planned.bake.phong;
  request.settings = planned.truth;
  return request;
}

PictureTruth::PictureTruth(StrandHair hair, Mesh head, const Scene& scene, const Camera& camera)
    : head_(std::move(head)), camera_(camera) {
  Scene seen = scene;
  seen.method = Method::truth;
  seen.camera = camera;
  scene_ = plan_effects(seen, {&hair.strands, nullptr, &head_, hair.opacity}, Task::picture).scene;
  scene_.truth.samples = std::max(1, (scene_.truth.samples + 1) / 2);
  strands_ =
      scene.strands.smoothing > 1 ? hair::smooth(hair.strands, scene.strands.smoothing) : std::move(hair.strands);
  fibres_ = std::make_unique<FibreScene>(strands_, hair.opacity, head_.triangles.empty() ? nullptr : &head_);
}

TruthRequest PictureTruth::request(std::uint64_t seed) const {
  TruthRequest request = truth_request(scene_, camera_);
  request.seed = kFirstSeed + seed;
  return request;
}

std::vector<float> PictureTruth::whole_half(std::uint64_t seed, const TruthProgress& progress) const {
  Image image(scene_.image.width, scene_.image.height);
  image.rgba = truth_image(*fibres_, strands_, request(seed), progress);
  return finished(std::move(image), scene_.image).rgba;
}

std::vector<float> PictureTruth::half_at(std::span<const glm::ivec2> pixels, std::uint64_t seed) const {
  const ImageSettings& settings = scene_.image;
  Image row(static_cast<int>(pixels.size()), 1);
  row.rgba = truth_pixels(*fibres_, strands_, request(seed), pixels);
  expose(row, settings.exposure);
  const glm::vec2 size(settings.width, settings.height);
  for (std::size_t i = 0; settings.background && i < pixels.size(); ++i) {
    const float gain = backdrop_gain(settings.backdrop, glm::vec2(pixels[i]) + 0.5F, size);
    compose_over(row.rgba.data() + 4 * i, gain * *settings.background);
  }
  return std::move(row.rgba);
}

TruthHalves PictureTruth::whole(std::uint64_t seed, const std::string& name) const {
  const auto pixels = static_cast<std::uint64_t>(scene_.image.width) * static_cast<std::uint64_t>(scene_.image.height);
  console::Progress progress("tracing the truth of " + name, 2 * pixels, "pixels");
  const auto half = [&](std::uint64_t which) {
    return whole_half(2 * seed + which, [&](std::uint64_t done, std::uint64_t) {
      console::throw_if_interrupted();
      progress.update(which * pixels + done);
    });
  };
  TruthHalves halves;
  halves.a = half(0);
  halves.b = half(1);
  return halves;
}

TruthHalves PictureTruth::at(std::span<const glm::ivec2> pixels, std::uint64_t seed) const {
  TruthHalves halves;
  halves.a = half_at(pixels, 2 * seed);
  console::throw_if_interrupted();
  halves.b = half_at(pixels, 2 * seed + 1);
  return halves;
}

std::vector<float> PictureTruth::alpha(std::uint64_t seed) const {
  const std::vector<float> rgba = truth_image(*fibres_, strands_, request(2 * seed));
  std::vector<float> alpha;
  for (std::size_t i = 3; i < rgba.size(); i += 4) alpha.push_back(rgba[i]);
  return alpha;
}

std::vector<float> values_at(const Image& image, std::span<const glm::ivec2> pixels) {
  std::vector<float> values;
  values.reserve(4 * pixels.size());
  for (const glm::ivec2& p : pixels) {
    const float* const rgba =
        image.rgba.data() +
        4 * (static_cast<std::size_t>(p.y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(p.x));
    values.insert(values.end(), rgba, rgba + 4);
  }
  return values;
}

}  // namespace pelage::app
