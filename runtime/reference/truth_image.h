// The truth of a picture: hair and head traced ray by ray.
//
// A pixel is the mean over `samples` rays through it, spread well over its square (box filter: what the rasteriser's
// supersampling converges to). Along a ray all crossings of fibres count, nearest first: each adds its colour times
// a T and T becomes T (1 - a), until the head, which is opaque, or the background, which is transparent black. Nothing
// is widened, however thin, and no crossing is left out.
//
// Colour of a crossing, for each light: irradiance * (T(one ray to the light) * hair_lighting() * azimuth term +
// ambient * diffuse colour, which is not shadowed [Bertails2005 section 3.3]). t is the strand's tangent as the
// rasteriser has it, n the side that faces the viewer. Crossings are shaded one by one while T >= kTail; of those
// behind, one is chosen at random with the probability of its weight and stands for all: right in the mean, and a
// shadow ray behind ten fibres is not worth its time. Colour of the head: shading/head_lighting.h, in the shadow of
// the hair, which is soft where a light has a size: each sample looks at one place of its disc. Hair is shadowed from
// the disc's middle, as it is by the methods compared with.
//
// Limits: one scattering. The rasteriser's near plane (a hundredth in front of the nearest hair) does not exist here.
// The head casts no shadow unless asked to: the methods compared with have none.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "pelage/data_schema/scene.h"
#include "pelage/reference/fibre_scene.h"
#include "pelage/reference/truth_transmittance.h"
#include "pelage/shading/lobes.h"

namespace pelage {

/// Transmittance in front of a crossing from which on one crossing stands for all behind it.
inline constexpr double kTail = 0.1;

struct TruthRequest {
  Camera camera;
  int width = 1280, height = 720;
  std::span<const Light> lights;
  HairMaterial material;
  LobeSwitches lobes;
  PlanarPhong phong;  // of the azimuth term
  TruthSettings settings;
  HeadShadow head_shadow = HeadShadow::none;
  std::uint64_t seed = 1;  // pictures of different seeds have independent noise
};

/// Rays through a picture: the projection of render/camera.h.
class TruthCamera {
 public:
  /// @throws UsageError for eye = target
  TruthCamera(const Camera& camera, int width, int height);
  /// Through (x, y) in pixels, (0, 0) the upper left corner of the picture.
  FibreRay ray(double x, double y) const noexcept;

 private:
  glm::dvec3 eye_, forward_, right_, down_;  // right_, down_: of one pixel, at distance 1
  double half_width_, half_height_;          // pixels
};

/// @param strands   that `scene` was made of: their colours, where they have any, replace the material's diffuse and
///                  secondary colour; either varies as the material says
/// @param progress  told the pixels done, by one thread at a time; may throw to interrupt
/// @return [y][x][4] linear RGBA, premultiplied, row 0 on top; the same bytes for any number of threads
/// @throws UsageError for eye = target or a light without a direction
std::vector<float> truth_image(const FibreScene& scene, const Strands& strands, const TruthRequest& request,
                               const std::function<void(std::uint64_t done, std::uint64_t total)>& progress = {});

/// Some pixels of that picture: the same numbers as there.
/// @param pixels  (x, y) inside it
/// @return [pixel][4]
std::vector<float> truth_pixels(const FibreScene& scene, const Strands& strands, const TruthRequest& request,
                                std::span<const glm::ivec2> pixels);

}  // namespace pelage
