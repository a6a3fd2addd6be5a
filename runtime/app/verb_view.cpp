#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <glm/ext/quaternion_trigonometric.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "pelage/app/prepare.h"
#include "pelage/app/scene_options.h"
#include "pelage/app/verbs.h"
#include "pelage/console/program.h"
#include "pelage/render/satf_frame.h"
#include "pelage/render/window.h"

namespace pelage::app {
namespace {

constexpr float kRadiansPerPixel = 0.008F;
/// Dolly per notch of the wheel.
constexpr float kDolly = 0.9F;
/// Turntable speed [rad/s].
constexpr float kTurn = 0.4F;

void orbit(Camera& camera, glm::vec2 drag) {
  const glm::vec3 offset = camera.eye - camera.target;
  const glm::vec3 side = glm::normalize(glm::cross(camera.up, offset));
  const glm::quat around = glm::angleAxis(-drag.x * kRadiansPerPixel, glm::normalize(camera.up));
  const glm::quat over = glm::angleAxis(-drag.y * kRadiansPerPixel, side);
  const glm::vec3 turned = around * (over * offset);
  // Not over the pole: there `up` and the view direction coincide.
  const bool pole = std::abs(glm::dot(glm::normalize(turned), glm::normalize(camera.up))) > 0.99F;
  camera.eye = camera.target + (pole ? around * offset : turned);
}

void turn_light(Light& light, const Camera& camera, glm::vec2 drag) {
  const glm::vec3 side = glm::normalize(glm::cross(camera.up, camera.eye - camera.target));
  light.direction = glm::angleAxis(drag.x * kRadiansPerPixel, glm::normalize(camera.up)) *
                    (glm::angleAxis(drag.y * kRadiansPerPixel, side) * light.direction);
}

void press(char key, FrameSettings& frame, bool& paused) {
  SatfSettings& s = frame.satf;
  switch (key) {
    case ' ':
      paused = !paused;
      break;
    case '1':
      s.diffuse = !s.diffuse;
      break;
    case '2':
      s.primary_highlight = !s.primary_highlight;
      break;
    case '3':
      s.secondary_highlight = !s.secondary_highlight;
      break;
    case '4':
      s.self_shadow = static_cast<SelfShadow>((static_cast<int>(s.self_shadow) + 1) % 3);
      break;
    case '5':
      s.global_shadow = !s.global_shadow;
      break;
    case 'O':
      s.draw_order = static_cast<DrawOrder>((static_cast<int>(s.draw_order) + 1) % 3);
      break;
    default:
      break;
  }
}

std::string title_of(const SatfFrame& frame, const std::string& name, bool paused) {
  double sum = 0;
  std::string text;
  for (const Stage& s : frame.ledger().stages()) {
    sum += s.milliseconds;
    if (s.milliseconds >= 1.0) text += " " + s.name + " " + std::to_string(std::lround(s.milliseconds));
  }
  return name + " - " + std::to_string(std::lround(sum)) + " ms:" + text + (paused ? " - paused" : "");
}

void view(const CLI::App& verb, const SceneOptions& options, int frames) {
  const Scene scene = resolve_scene(verb, options);
  Window window(scene.image.width, scene.image.height, "pelage: preparing " + scene.hair);
  Hairstyle style = prepare_hairstyle(scene);
  const std::string name = style.name;
  BakeSettings bake;
  std::unique_ptr<RecordSource> records = prepare_records(scene, style, bake);
  SatfFrame frame(std::move(style), std::move(records), bake, prepare_head(scene));
  const float aspect = static_cast<float>(scene.image.width) / static_cast<float>(scene.image.height);
  FrameSettings settings{scene.camera.value_or(framed_camera(frame.bounds(), aspect)), scene.lights, scene.material,
                         scene.satf};
  const Camera home = settings.camera;
  bool paused = true;
  for (int drawn = 0; !window.should_close() && (frames == 0 || drawn < frames); ++drawn) {
    console::throw_if_interrupted();
    const Window::Input input = window.poll();
    orbit(settings.camera, input.drag);
    if (!paused) orbit(settings.camera, {-kTurn / 60.0F / kRadiansPerPixel, 0.0F});
    if (!settings.lights.empty()) turn_light(settings.lights[0], settings.camera, input.light_drag);
    settings.camera.eye =
        settings.camera.target + (settings.camera.eye - settings.camera.target) * std::pow(kDolly, input.scroll);
    for (const char key : input.keys) {
      press(key, settings, paused);
      if (key == 'R') settings.camera = home;
    }
    const glm::ivec2 size = window.size();
    frame.show(settings, size.x, size.y, scene.image.exposure, scene.image.background.value_or(glm::vec3(0.85F)));
    window.swap();
    window.set_title(title_of(frame, name, paused));
  }
}

}  // namespace

void add_view(CLI::App& app) {
  CLI::App* verb = app.add_subcommand("view", "Look at a scene, a hairstyle or a hair file in a window");
  verb->footer(
      "Mouse: drag turns, wheel dollies, right drag (or Shift) moves the first light. Keys: space turns or pauses, "
      "R resets the camera, 1 2 3 lobes, 4 self-shadow, 5 global shadow, O drawing order, Esc quits.");
  auto options = add_scene_options(*verb);
  auto frames = std::make_shared<int>(0);
  verb->add_option("--frames", *frames, "Close after this many frames; 0: when the window is closed")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  console::add_common_options(*verb);
  verb->callback([verb, options, frames] { view(*verb, *options, *frames); });
}

}  // namespace pelage::app
