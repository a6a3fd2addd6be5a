// The truth of a scene's picture in two halves of independent rays, whole or at pixels drawn at random: what errors of
// pictures are estimated against without the truth's own noise (image/noisy_error.h).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "pelage/app/prepare.h"
#include "pelage/data_schema/mesh.h"
#include "pelage/data_schema/scene.h"
#include "pelage/image/image.h"
#include "pelage/image/noisy_error.h"
#include "pelage/reference/truth_image.h"

namespace pelage::app {

/// What the truth of a scene's picture is asked for: the scene with the effects that it calls for.
TruthRequest truth_request(const Scene& planned, const Camera& camera);

/// Values of pixels, [n][4] linear RGBA, exposed and over the scene's background.
struct TruthHalves {
  std::vector<float> a, b;
};

class PictureTruth {
 public:
  /// @param scene    its truth.samples are those of both halves
  PictureTruth(StrandHair hair, Mesh head, const Scene& scene, const Camera& camera);

  /// @param seed  other seeds, independent noise; none is that of `pelage render`     @throws Interrupted
  TruthHalves whole(std::uint64_t seed, const std::string& name) const;
  /// Of one half, before it is laid over the background, [y][x].
  std::vector<float> alpha(std::uint64_t seed) const;
  TruthHalves at(std::span<const glm::ivec2> pixels, std::uint64_t seed) const;

  const Scene& scene() const noexcept { return scene_; }
  const Camera& camera() const noexcept { return camera_; }

 private:
  using TruthProgress = std::function<void(std::uint64_t done, std::uint64_t total)>;
  TruthRequest request(std::uint64_t seed) const;
  std::vector<float> whole_half(std::uint64_t seed, const TruthProgress& progress) const;
  std::vector<float> half_at(std::span<const glm::ivec2> pixels, std::uint64_t seed) const;

  Strands strands_;
  Mesh head_;
  Scene scene_;
  Camera camera_;
  std::unique_ptr<FibreScene> fibres_;
};

/// The picture's values at some pixels, [pixel][4].
std::vector<float> values_at(const Image& image, std::span<const glm::ivec2> pixels);

}  // namespace pelage::app
