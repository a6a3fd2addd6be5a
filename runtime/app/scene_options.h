// The options that `render` and `view` share: a scene from a scene file or a bare hair file, and what the command line
// changes of it. DESIGN section 10.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pelage/data_schema/scene.h"

namespace pelage::console {
class Verb;
}

namespace pelage::app {

struct SceneOptions {
  std::string input;
  std::string head, database, unit, up, material, camera, background, size, records, self_shadow, order;
  std::string curve, method, density_map, shape, lobes, shadow_at, lighting;
  std::vector<std::string> lights, point_lights;
  std::vector<std::string> effects_on, effects_off, effects_auto;
  std::vector<std::string> values;  // --set
  bool azimuth = true;
  float exposure = 1.0F, diameter_um = 0, opacity = 0, colour_variation = 0;
  int supersampling = 2, clusters = 150, bake_sectors = 0, neighbours = 4;
  int shadow_resolution = 128, smoothing = 1, samples = 16;
  int layers = 0, sectors = 0, plates = 0;
};

/// Adds the options; the returned object is filled when the command line is parsed and must outlive the callback.
std::shared_ptr<SceneOptions> add_scene_options(console::Verb& verb);

/// The scene: the file's or, for a hair or hairstyle file, the default one, then the options that were given.
/// @throws UsageError, also where the verb would write over a file that the scene names; InputError
Scene resolve_scene(const console::Verb& verb, const SceneOptions& options);

/// The picture's size, or a smaller one of its shape within these pixels.
void limit_size(ImageSettings& image, int width, int height) noexcept;

}  // namespace pelage::app
