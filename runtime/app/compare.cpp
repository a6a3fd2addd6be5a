#include "pelage/app/compare.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <tbb/global_control.h>

#include <chrono>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <optional>

#include "pelage/app/command_line.h"
#include "pelage/app/compared_truth.h"
#include "pelage/app/framing.h"
#include "pelage/app/machine.h"
#include "pelage/app/picture.h"
#include "pelage/app/simulation_options.h"
#include "pelage/app/stopwatch.h"
#include "pelage/console/program.h"
#include "pelage/console/progress.h"
#include "pelage/data_schema/errors.h"
#include "pelage/db/database.h"
#include "pelage/image/error_map.h"
#include "pelage/image/flip.h"
#include "pelage/image/image_file.h"

namespace pelage::app {
namespace {

using Clock = std::chrono::steady_clock;

/// Angle by which the camera goes around its target for the second picture.
constexpr float kTurn_rad = 0.0175F;
/// Pictures of the truth that are kept for all methods take no more.
constexpr double kMostBytes = 4e9;

Camera turned(Camera camera) {
  const glm::quat turn = glm::angleAxis(kTurn_rad, glm::normalize(camera.up));
  camera.eye = camera.target + turn * (camera.eye - camera.target);
  return camera;
}

double ms_of(const std::vector<Stage>& stages) {
  double sum = 0;
  for (const Stage& s : stages) sum += s.milliseconds;
  return sum;
}

std::uint64_t bytes_of(const std::vector<Stage>& stages) {
  std::uint64_t sum = 0;
  for (const Stage& s : stages) sum += s.bytes;
  return sum;
}

std::string camera_option(const Camera& c) {
  return fmt::format("--camera={},{},{},{},{},{},{}", c.eye.x, c.eye.y, c.eye.z, c.target.x, c.target.y, c.target.z,
                     c.fov_deg);
}

class Run {
 public:
  explicit Run(const CompareRequest& request) : request_(request) {
    const Scene& scene = request.scene;
    check_memory();
    const auto begin = Clock::now();
    hair_ = prepare_strands(scene);
    head_ = prepare_head(scene);
    read_ms_ = ms_since(begin);
    if (animated())
      strand_frames_ = simulate_frames(hair_.strands, head_, planned_motion(scene, hair_.strands, head_, hair_.opacity),
                                       frames(), fps(), "strands");
    camera_ = scene.camera.value_or(framed());
  }

  Comparison run() {
    describe();
    truth();
    const auto methods = request_.methods.size() - 1, pictures = methods * static_cast<std::size_t>(frames() + 1);
    if (methods == 0) return std::move(result_);
    console::Progress progress("comparing", pictures, "pictures");
    for (std::size_t i = 1; i <= methods; ++i) {
      row(request_.methods[i]);
      progress.update(i * static_cast<std::size_t>(frames() + 1));
    }
    return std::move(result_);
  }

 private:
  bool animated() const { return request_.frames > 1; }
  int frames() const { return std::max(request_.frames, 1); }
  double fps() const { return request_.fps; }

  void check_memory() const {
    const ImageSettings& p = request_.scene.image;
    if (20.0 * p.width * p.height * frames() > kMostBytes)
      throw UsageError(
          fmt::format("{} frames of {} x {} pixels do not fit in memory: give fewer --frames or a smaller "
                      "--size",
                      frames(), p.width, p.height));
  }

  Camera framed() const {
    const Scene& scene = request_.scene;
    if (!animated()) return camera_of(scene, hair_.strands, head_);
    return framed_camera(
        carried_points(hair_.strands, head_, scene.simulation.motion, strand_frames_.pivot, frames() / fps()),
        aspect_of(scene.image));
  }

  void describe() {
    const Scene& scene = request_.scene;
    result_.name = hair_.name;
    result_.command = request_.command;
    result_.scene = to_json(scene);
    result_.revision = program_revision();
    result_.cpu = cpu_name();
    result_.threads = static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
    result_.width = scene.image.width;
    result_.height = scene.image.height;
    if (animated()) result_.fps = fps();
    result_.error_scale = request_.error_scale;
  }

  /// The row with what is known before it is drawn, and the scene as the method wants it.
  Scene begin(const CompareMethod& method, ComparedMethod& row) const {
    row.id = method.id;
    row.title = method.title;
    row.what = method.what;
    if (animated() && method.id.starts_with("satf"))
      row.what += " Its clusters' centre lines are simulated; the truth's strands are.";
    Scene scene = request_.scene;
    row.command = request_.row_command;
    const ImageSettings& p = scene.image;
    std::vector<std::string> words{"--size", fmt::format("{}x{}", p.width, p.height)};
    if (!scene.camera) words.push_back(camera_option(camera_));
    for (const std::string& word : method.set(scene)) words.push_back(word);
    const std::string& order = scene.method == Method::satf ? request_.clusters_order : request_.order;
    if (!order.empty()) words.insert(words.end(), {"--order", order});
    if (request_.names_database && scene.method == Method::satf && scene.database.empty())
      words.insert(words.end(), {"--database", ""});
    for (const std::string& word : words) row.command += " " + shell_word(word);
    row.command += animated() ? fmt::format(" --fps {} --seconds {} -o {}", fps(), frames() / fps(), row.id)
                              : " -o " + row.id + ".png";
    return scene;
  }

  void truth() {
    ComparedMethod row;
    Scene scene = begin(request_.methods.at(0), row);
    scene.truth.samples = (scene.truth.samples + 1) / 2;
    result_.truth_samples = 2 * scene.truth.samples;
    const bool moved = animated();
    const MovedFrame* const first = moved ? &strand_frames_.frames[0] : nullptr;
    const auto drawing = make_strand_drawing(
        Method::truth, {hair_.name, moved ? first->lines : hair_.strands, hair_.opacity}, moved ? first->head : head_);
    truth_ = draw_truth(*drawing, scene, camera_, strand_frames_.frames);
    result_.truth_noise = truth_.noise;
    result_.flicker_noise = truth_.flicker_noise;
    row.prepare_ms = read_ms_;
    row.stages = truth_.stages;
    row.first_ms = truth_.first_ms;
    row.again_ms = truth_.again_ms;
    row.bytes = bytes_of(row.stages);
    row.error.psnr_db = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; moved && k < truth_.ms.size(); ++k) row.frames.push_back({row.error, 0, truth_.ms[k]});
    const Image& picture = truth_.frames[0].picture;
    write(row, scene, picture, truth_.half);
    result_.methods.push_back(std::move(row));
  }

  void row(const CompareMethod& method) {
    console::throw_if_interrupted();
    ComparedMethod row;
    std::optional<Image> picture;
    Scene scene;
    try {
      scene = begin(method, row);
      picture = draw(scene, row);
    } catch (const Interrupted&) {
      throw;
    } catch (const std::exception& error) {
      ComparedMethod none;
      none.id = row.id, none.title = row.title, none.what = row.what, none.command = row.command;
      none.failed = error.what();
      spdlog::warn("{}: {}", row.id, error.what());
      row = std::move(none);
      picture.reset();
    }
    if (picture) write(row, scene, *picture, *picture);
    result_.methods.push_back(std::move(row));
  }

  std::unique_ptr<Drawing> prepared(const Scene& scene) {
    if (scene.method != Method::satf) return make_strand_drawing(scene.method, hair_, head_);
    if (animated()) check_curls(scene);
    return make_drawing(scene, animated());
  }

  const std::vector<MovedFrame>& frames_of(const Scene& scene, const Drawing& drawing) {
    if (scene.method != Method::satf) return strand_frames_.frames;
    if (cluster_frames_.frames.empty()) {
      const Strands lines = drawing.lines();
      const Mesh head = drawing.head();
      cluster_frames_ = simulate_frames(lines, head, planned_motion(scene, lines, head, drawing.facts().opacity),
                                        frames(), fps(), "clusters");
    }
    return cluster_frames_.frames;
  }

  /// @return the first frame's picture
  Image draw(const Scene& scene, ComparedMethod& row) {
    auto begin = Clock::now();
    const std::unique_ptr<Drawing> drawing = prepared(scene);
    row.prepare_ms = ms_since(begin) + (scene.method == Method::satf ? 0 : read_ms_);
    if (animated()) move(*drawing, frames_of(scene, *drawing)[0]);
    begin = Clock::now();
    Image picture = finished(drawing->render(scene, camera_), scene.image);
    const double wall_ms = ms_since(begin);
    row.stages = drawing->ledger().stages();
    row.first_ms = ms_of(row.stages);
    row.error = error_of(picture, 0);
    row.bytes = bytes_of(row.stages);
    console::throw_if_interrupted();
    drawing->render(scene, turned(camera_));
    row.again_ms = ms_of(drawing->ledger().stages());
    row.bytes = std::max(row.bytes, bytes_of(drawing->ledger().stages()));
    if (animated()) draw_frames(*drawing, scene, picture, wall_ms, row);
    return picture;
  }

  static void move(Drawing& drawing, const MovedFrame& frame) { drawing.move(frame.lines, frame.turn, frame.head); }

  PictureError error_of(const Image& picture, std::size_t frame) const {
    const TruthFrame& truth = truth_.frames[frame];
    return picture_error(picture, truth.picture, truth.alpha);
  }

  void draw_frames(Drawing& drawing, const Scene& scene, const Image& first, double first_ms, ComparedMethod& row) {
    const std::vector<MovedFrame>& frames = frames_of(scene, drawing);
    row.frames.push_back({row.error, 0, first_ms});
    Image last = first;
    double squares = 0;
    for (std::size_t k = 1; k < frames.size(); ++k) {
      console::throw_if_interrupted();
      const auto begin = Clock::now();
      move(drawing, frames[k]);
      Image image = drawing.render(scene, camera_);
      const double ms = ms_since(begin);
      Image picture = finished(std::move(image), scene.image);
      const double change = flicker(picture, last, truth_.frames[k].picture, truth_.frames[k - 1].picture);
      row.frames.push_back({error_of(picture, k), change, ms});
      squares += change * change;
      last = std::move(picture);
    }
    row.flicker = std::sqrt(squares / static_cast<double>(frames.size() - 1));
  }

  /// @param compared  what the maps show against the truth
  void write(ComparedMethod& row, const Scene& scene, const Image& picture, const Image& compared) {
    row.picture = row.id + ".png";
    row.error_map = row.id + "-error.png";
    row.flip_map = row.id + "-flip.png";
    const auto save = [&](const Image& image, const std::string& name) {
      console::throw_if_interrupted();
      write_image(image, request_.folder / name, {{"Software", "pelage"}, {"pelage:scene", to_json(scene)}});
    };
    const Image& truth = truth_.frames[0].picture;
    save(picture, row.picture);
    save(picture, row.id + ".exr");
    save(error_map(compared, truth, request_.error_scale), row.error_map);
    save(flip_picture(flip_map(compared, truth), picture.width, picture.height), row.flip_map);
  }

  const CompareRequest& request_;
  StrandHair hair_;
  Mesh head_;
  double read_ms_ = 0;
  MovedFrames strand_frames_, cluster_frames_;  // empty where nothing moves
  Camera camera_;
  ComparedTruth truth_;
  Comparison result_;
};

}  // namespace

Comparison compare(const CompareRequest& request) {
  return Run(request).run();
}

}  // namespace pelage::app
