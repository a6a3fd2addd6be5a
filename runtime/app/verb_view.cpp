#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/ext/quaternion_trigonometric.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>

#include "pelage/app/clip.h"
#include "pelage/app/drawing.h"
#include "pelage/app/explain.h"
#include "pelage/app/framing.h"
#include "pelage/app/scene_options.h"
#include "pelage/app/simulation_options.h"
#include "pelage/app/verbs.h"
#include "pelage/console/program.h"
#include "pelage/console/verb.h"
#include "pelage/data_schema/errors.h"
#include "pelage/render/window.h"
#include "pelage/simulate/head_motion.h"
#include "pelage/simulate/moving_hair.h"

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
  if (light.position) {
    // Around what the camera looks at.
    glm::vec3 offset = *light.position - camera.target;
    offset = glm::angleAxis(drag.x * kRadiansPerPixel, glm::normalize(camera.up)) *
             (glm::angleAxis(drag.y * kRadiansPerPixel, side) * offset);
    light.position = camera.target + offset;
    return;
  }
  light.direction = glm::angleAxis(drag.x * kRadiansPerPixel, glm::normalize(camera.up)) *
                    (glm::angleAxis(drag.y * kRadiansPerPixel, side) * light.direction);
}

/// The next of n values.
template <class E>
void cycle(E& value, int n) {
  value = static_cast<E>((static_cast<int>(value) + 1) % n);
}

void press(char key, Scene& scene, bool& paused) {
  SatfSettings& s = scene.satf;
  StrandSettings& strands = scene.strands;
  const bool satf = scene.method == Method::satf;
  switch (key) {
    case ' ':
      paused = !paused;
      break;
    case '1':
      s.diffuse = strands.diffuse = !s.diffuse;
      break;
    case '2':
      s.primary_highlight = strands.primary_highlight = !s.primary_highlight;
      break;
    case '3':
      s.secondary_highlight = strands.secondary_highlight = !s.secondary_highlight;
      break;
    case '4':
      if (satf) cycle(s.self_shadow, 3);
      break;
    case '5':
      s.global_shadow = !s.global_shadow;
      break;
    case 'M':
      // Among those that draw strand by strand.
      if (!satf)
        scene.method = scene.method == Method::unshadowed ? Method::density_map
                                                          : static_cast<Method>(static_cast<int>(scene.method) + 1);
      break;
    case 'O':
      if (satf)
        cycle(s.draw_order, 3);
      else
        cycle(strands.order, 3);
      break;
    default:
      break;
  }
}

std::string title_of(const Drawing& drawing, bool paused) {
  double sum = 0;
  std::string text;
  for (const Stage& s : drawing.ledger().stages()) {
    sum += s.milliseconds;
    if (s.milliseconds >= 1.0) text += " " + s.name + " " + std::to_string(std::lround(s.milliseconds));
  }
  return drawing.name() + " - " + std::to_string(std::lround(sum)) + " ms:" + text + (paused ? " - paused" : "");
}

/// Hair that moves as time passes; what drawing takes too long for is dropped, not caught up with.
class Motion {
 public:
  Motion(const Drawing& drawing, const SimulationSettings& settings)
      : settings_(settings), hair_(drawing.lines(), drawing.head(), settings) {
    restart();
  }

  void restart() {
    time_s_ = 0;
    hair_.begin(head_pose(settings_.motion, hair_.pivot(), 0), settings_.life.settle_s, console::throw_if_interrupted);
    last_ = std::chrono::steady_clock::now();
  }
  void advance(Drawing& drawing) {
    const auto now = std::chrono::steady_clock::now();
    const double passed_s = std::min(std::chrono::duration<double>(now - last_).count(), settings_.life.catch_up_s);
    last_ = now;
    if (!running_) return;
    time_s_ += passed_s;
    hair_.advance(passed_s, head_pose(settings_.motion, hair_.pivot(), time_s_));
    if (hair_.moved()) drawing.move(hair_.hair(), hair_.pose().rotation, hair_.head());
  }
  void toggle() { running_ = !running_; }

 private:
  SimulationSettings settings_;
  MovingHair hair_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
  double time_s_ = 0;
  bool running_ = true;
};

/// --motion, --preset or --wind ask for hair that moves.
bool is_moving(const console::Verb& verb) {
  return verb.count("--motion") + verb.count("--preset") + verb.count("--wind") > 0;
}

struct ViewOptions {
  std::shared_ptr<SceneOptions> scene;
  std::shared_ptr<SimulationOptions> simulation;
  int frames = 0;
};

void view(const console::Verb& verb, const ViewOptions& options) {
  Scene scene = resolve_scene(verb, *options.scene);
  scene.simulation = resolve_simulation(verb, *options.simulation, scene);
  if (is_moving(verb)) check_curls(scene);
  if (!needs_opengl(scene.method))
    throw UsageError("--method truth takes minutes a picture and has no window: use pelage render");
  Window window(scene.image.width, scene.image.height, "pelage: preparing " + scene.hair);
  const std::unique_ptr<Drawing> drawing = make_drawing(scene, is_moving(verb));
  std::optional<Motion> motion;
  if (is_moving(verb)) {
    motion.emplace(*drawing, planned_motion(scene, drawing->lines(), drawing->head(), drawing->facts().opacity));
  }
  Camera camera = camera_of(scene, *drawing);
  const Camera home = camera;
  bool paused = true;
  for (int drawn = 0; !window.should_close() && (options.frames == 0 || drawn < options.frames); ++drawn) {
    console::throw_if_interrupted();
    const Window::Input input = window.poll();
    orbit(camera, input.drag);
    if (!paused) orbit(camera, {-kTurn / 60.0F / kRadiansPerPixel, 0.0F});
    if (!scene.lights.empty()) turn_light(scene.lights[0], camera, input.light_drag);
    camera.eye = camera.target + (camera.eye - camera.target) * std::pow(kDolly, input.scroll);
    for (const char key : input.keys) {
      press(key, scene, paused);
      if (key == 'R') camera = home;
      if (key == 'P' && motion) motion->toggle();
      if (key == 'T' && motion) motion->restart();
      if (key == 'E') print_ledger(ledger_of(*drawing));
    }
    if (motion) motion->advance(*drawing);
    const glm::ivec2 size = window.size();
    drawing->show(scene, camera, size.x, size.y);
    window.swap();
    window.set_title(title_of(*drawing, paused));
  }
}

}  // namespace

void add_view(CLI::App& app) {
  console::Verb* const verb = console::add_verb(app, "view", "Look at a scene, a hairstyle or a hair file in a window");
  verb->footer(
      "Mouse: drag turns, wheel dollies, right drag (or Shift) moves the first light. Keys: space turns or pauses, "
      "R resets the camera, 1 2 3 lobes, 4 self-shadow, 5 global shadow, M shadow method of strands, O drawing order, "
      "E prints what runs and why, Esc quits. With --motion, --preset or --wind the hair moves: P stops it and lets it "
      "go on, T begins anew.");
  auto options = std::make_shared<ViewOptions>();
  options->scene = add_scene_options(*verb);
  options->simulation = add_simulation_options(*verb);
  verb->add_option("--frames", options->frames, "Close after this many frames; 0: when the window is closed")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  console::add_common_options(*verb);
  verb->runs([verb, options] { view(*verb, *options); });
}

}  // namespace pelage::app
