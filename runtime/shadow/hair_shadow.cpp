#include "pelage/shadow/hair_shadow.h"

#include <algorithm>

#include "pelage/data_schema/errors.h"
#include "pelage/shadow/density_map.h"

namespace pelage {
namespace {

class NoShadow final : public HairShadow {
  void transmittance(std::span<const glm::vec3>, std::span<float> out) const override {
    std::fill(out.begin(), out.end(), 1.0F);
  }
  std::size_t bytes() const noexcept override { return 0; }
};

class MappedShadow final : public HairShadow {
 public:
  MappedShadow(std::span<const Segment> segments, const Light& light, float width_m, int resolution)
      : map_(segments, light.direction, width_m, resolution) {}
  void transmittance(std::span<const glm::vec3> points, std::span<float> out) const override {
    for (std::size_t i = 0; i < points.size(); ++i) out[i] = map_.transmittance(points[i]);
  }
  std::size_t bytes() const noexcept override { return map_.bytes(); }

 private:
  DensityMap map_;
};

}  // namespace

std::unique_ptr<HairShadow> make_shadow(Method method, const ShadowSettings& settings, const Strands& strands,
                                        float opacity, const Light& light) {
  if (method == Method::unshadowed) return std::make_unique<NoShadow>();
  std::vector<Segment> segments;
  for (std::size_t s = 0; s < strands.count(); ++s) {
    const auto points = strands.strand(s);
    for (std::size_t i = 1; i < points.size(); ++i) segments.push_back({points[i - 1], points[i]});
  }
  return std::make_unique<MappedShadow>(segments, light, opacity * strands.diameter_m, settings.density_map.resolution);
}

}  // namespace pelage
