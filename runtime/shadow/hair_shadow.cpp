#include "pelage/shadow/hair_shadow.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "pelage/data_schema/errors.h"
#include "pelage/shadow/density_map.h"
#include "pelage/shadow/opacity_maps.h"

namespace pelage {
namespace {

class NoShadow final : public HairShadow {
  void build(const Strands&, float, const Light&) override {}
  void transmittance(std::span<const glm::vec3>, std::span<float> out) const override {
    std::fill(out.begin(), out.end(), 1.0F);
  }
  std::size_t bytes() const noexcept override { return 0; }
};

std::unique_ptr<HairShadow> method_of(Method method, const ShadowSettings& settings) {
  switch (method) {
    case Method::density_map:
      return std::make_unique<DensityMap>(settings.density_map);
    case Method::deep_opacity:
      return std::make_unique<DeepOpacityMap>(settings.opacity_map);
    case Method::opacity_shadow:
      return std::make_unique<OpacityShadowMap>(settings.opacity_map);
    case Method::unshadowed:
      return std::make_unique<NoShadow>();
    default:
      throw UsageError("this method has no map of its own");
  }
}

}  // namespace

std::unique_ptr<HairShadow> make_shadow(Method method, const ShadowSettings& settings, const Strands& strands,
                                        float opacity, const Light& light) {
  auto shadow = method_of(method, settings);
  shadow->build(strands, opacity, light);
  return shadow;
}

void check_hair(const Strands& strands, float opacity) {
  if (!(opacity >= 0.0F && opacity <= 1.0F))
    throw InputError("shadow", "the opacity is " + std::to_string(opacity) + "; it lies between 0 and 1");
  const bool known = strands.diameters_m.empty() ? strands.diameter_m > 0 && std::isfinite(strands.diameter_m)
                                                 : strands.diameters_m.size() == strands.vertices.size();
  if (!known && !strands.vertices.empty())
    throw InputError("shadow", "the hair has no drawn diameter: set one, or one per vertex");
  for (std::size_t i = 0; i < strands.diameters_m.size(); ++i) {
    if (strands.diameters_m[i] >= 0 && std::isfinite(strands.diameters_m[i])) continue;
    throw InputError("shadow", "the diameter at vertex " + std::to_string(i) + " is " +
                                   std::to_string(strands.diameters_m[i]) + " m; it is finite and not negative");
  }
}

}  // namespace pelage
