// How much light of one light source reaches a point through the hair: the interface of the density map and of the
// methods that it is compared with, so that each is one more row in any comparison.
//
// Hair: `strands` with a drawn diameter D (strands.diameters_m per vertex, or strands.diameter_m > 0) and an opacity a;
// a fibre blocks a D len sin(segment, light) of area (DESIGN section 3).
#pragma once

#include <chrono>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "pelage/data_schema/scene.h"
#include "pelage/data_schema/strands.h"

namespace pelage {

/// A map as a 3D texture: values at whole cell coordinates, trilinear between them. For lookups on the GPU.
struct DepthTexture {
  glm::ivec3 size{0};          // along the light, across, across
  std::vector<float> values;   // [x][y][z] optical depth >= 0, or transmittance. What lies outside has the value at the
                               // border: coordinates are clamped to [0, size - 1]
  glm::mat4 world_to_cell{1};  // affine
  bool transmittance = false;  // values are exp(-depth) already, and are what is interpolated
  float tap_cells = 0;         // > 0: mean of four reads at (y +- tap, z +- tap)
};

/// Of the two stages that build a map [Bertails2005 sections 3.1, 3.2]; the third, the filter, is transmittance().
struct BuildTimes {
  double fill_ms = 0, transmittance_ms = 0;
};

inline double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

class HairShadow {
 public:
  virtual ~HairShadow() = default;
  /// Built anew for moved hair or another light; memory is kept. @throws as make_shadow
  virtual void build(const Strands& strands, float opacity, const Light& light) = 0;
  /// Transmittance in [0, 1] from the light to each point [metres]; NaN where a point is not finite (a caller's error
  /// stays visible). `out` is as long as `points`.
  virtual void transmittance(std::span<const glm::vec3> points, std::span<float> out) const = 0;
  virtual std::size_t bytes() const noexcept = 0;
  virtual BuildTimes times() const noexcept { return {}; }
  /// None where lookups are not affine in space: point lights, layers behind the first hair, adaptive slices.
  virtual std::optional<DepthTexture> depth_texture() const { return std::nullopt; }
};

/// The method's shadow of `strands` for one light. @throws UsageError for Method::satf and Method::truth, which have
/// none here
/// @throws InputError for a light without a direction, hair that is not finite, an opacity outside [0, 1], no diameter
std::unique_ptr<HairShadow> make_shadow(Method method, const ShadowSettings& settings, const Strands& strands,
                                        float opacity, const Light& light);

/// @throws InputError as make_shadow does, for the hair
void check_hair(const Strands& strands, float opacity);

}  // namespace pelage
