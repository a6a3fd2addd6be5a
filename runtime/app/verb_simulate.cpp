#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>

#include "pelage/app/clip.h"
#include "pelage/app/drawing.h"
#include "pelage/app/explain_motion.h"
#include "pelage/app/framing.h"
#include "pelage/app/motion_budget.h"
#include "pelage/app/output_folder.h"
#include "pelage/app/picture.h"
#include "pelage/app/prepare.h"
#include "pelage/app/repeat.h"
#include "pelage/app/scene_options.h"
#include "pelage/app/simulation_options.h"
#include "pelage/app/stopwatch.h"
#include "pelage/app/verbs.h"
#include "pelage/app/video.h"
#include "pelage/console/json_output.h"
#include "pelage/console/options.h"
#include "pelage/console/program.h"
#include "pelage/console/progress.h"
#include "pelage/console/verb.h"
#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/output_file.h"
#include "pelage/data_schema/scene_values.h"
#include "pelage/hair/hair_file.h"
#include "pelage/render/gl_context.h"

namespace pelage::app {
namespace {

struct SimulateOptions {
  std::shared_ptr<SceneOptions> scene;
  std::shared_ptr<SimulationOptions> simulation;
  std::filesystem::path out, hair_out, video;
  double fps = 30, seconds = 0;
  BudgetOptions budget;
  bool stats = false, explain = false;
};

constexpr double kMiB = 1048576.0;
/// State and grid of 100,000 strands on a head take less.
constexpr double kMuch_MiB = 256;

std::string numbered(const std::filesystem::path& folder, int frame, const char* extension) {
  return (folder / fmt::format("frame_{:04d}{}", frame, extension)).string();
}

/// Says so where files of a longer sequence stay behind the last one.
void warn_of_older(const std::filesystem::path& folder, int frames, const char* extension) {
  if (folder.empty()) return;
  const std::string next = numbered(folder, frames, extension);
  if (std::filesystem::exists(next)) spdlog::warn("{} and what follows are of an earlier, longer sequence", next);
}

/// Times of all frames, summed by stage.
class Totals {
 public:
  void add(const std::string& stage, double ms) {
    for (auto& [name, sum] : sums_)
      if (name == stage) {
        sum += ms;
        return;
      }
    sums_.emplace_back(stage, ms);
  }
  const std::vector<std::pair<std::string, double>>& sums() const { return sums_; }

 private:
  std::vector<std::pair<std::string, double>> sums_;
};

struct FrameReport {
  int frame;
  std::uint64_t hash;
  float fastest_m_s, fastest_root_m_s;
  std::size_t asleep;
};

class Sequence {
 public:
  Sequence(const SimulateOptions& options, const Scene& scene) : options_(options), scene_(scene) {
    prepare();
    const Strands& strands = subject_.hair.strands;
    choose_settings();
    const SimulationSettings s = planned_motion(scene_, strands, subject_.head, subject_.hair.opacity);
    clip_.emplace(strands, subject_.head, s, options.fps, options.seconds);
    camera_ = scene.camera.value_or(
        framed_camera(carried_points(strands, subject_.head, s.motion, hair().pivot(), frames() / options.fps),
                      aspect_of(scene.image)));
    describe();
    warn_of_older(options.out, frames(), ".png");
    warn_of_older(options.hair_out, frames(), ".hair");
  }

  void run() {
    clip_->begin();
    console::Progress progress("simulating " + subject_.hair.name, static_cast<std::uint64_t>(frames()), "frames");
    for (int k = 0; k < frames(); ++k) {
      console::throw_if_interrupted();
      frame(k);
      progress.update(static_cast<std::uint64_t>(k) + 1);
    }
    if (budget_) budget_->achieved_ms = median_ms();
  }

  int frames() const { return clip_->frames(); }
  const Totals& totals() const { return totals_; }
  const std::vector<FrameReport>& reports() const { return reports_; }
  std::vector<LedgerLine> explain() {
    return explain_motion(subject_, scene_, options_.fps, options_.seconds, drawing_.get(), camera_);
  }
  const Simulation& simulation() const { return hair().simulation(); }
  const std::optional<Budget>& budget() const { return budget_; }
  /// Chains, voxels and strands of a frame, the median; the first, in which nothing moves, does not count.
  double median_ms() const { return median_of(frame_ms_); }

 private:
  /// Those that meet --budget-ms and --target-error.
  void choose_settings() {
    const std::optional<Goal> goal = options_.budget.goal();
    if (!goal) return;
    const double seconds = options_.seconds > 0 ? options_.seconds : 1;
    budget_ = choose_motion(scene_, subject_, *goal, {options_.fps, seconds});
    scene_ = with_values(scene_, budget_->settings);
  }

  /// What is to move; with pictures, as the method draws it.
  void prepare() {
    if (options_.out.empty()) {
      subject_ = {prepare_strands(scene_), prepare_head(scene_)};
      return;
    }
    drawing_ = make_drawing(scene_, true);
    subject_ = {{drawing_->name(), drawing_->lines(), drawing_->facts().opacity}, drawing_->head()};
  }

  void describe() const {
    const Simulation& sim = simulation();
    spdlog::info("{}: preset {}, {} of {} strands simulated, {} vertices, {:.1f} MiB; {} frames", subject_.hair.name,
                 scene_.simulation.name, sim.blocks().strands, subject_.hair.strands.count(),
                 sim.blocks().first.back() * static_cast<std::uint32_t>(kLanes),
                 static_cast<double>(sim.facts().bytes) / kMiB, frames());
    if (static_cast<double>(sim.facts().bytes) > kMuch_MiB * kMiB)
      spdlog::warn(
          "{}: voxels of {:.3g} m are small for hair of this size, most of the memory and time is theirs: a "
          "larger simulation.interaction.cell_m in a scene file will do",
          subject_.hair.name, scene_.simulation.interaction.cell_m);
  }

  MovingHair& hair() { return clip_->hair(); }
  const MovingHair& hair() const { return clip_->hair(); }

  void frame(int k) {
    const SimulationFacts before = simulation().facts();
    clip_->advance(k);
    const SimulationFacts& now = simulation().facts();
    totals_.add("chains", now.chain_ms - before.chain_ms);
    totals_.add("grid", now.grid_ms - before.grid_ms);
    const bool moved = hair().moved();
    const Strands& strands = hair().hair();
    totals_.add("strands", hair().hair_ms());
    if (k > 0) frame_ms_.push_back(now.chain_ms - before.chain_ms + now.grid_ms - before.grid_ms + hair().hair_ms());
    reports_.push_back({k, simulation().state_hash(), clip_->fastest_m_s(), clip_->fastest_root_m_s(), now.asleep});
    if (!options_.hair_out.empty()) hair::write_strands(strands, numbered(options_.hair_out, k, ".hair"));
    if (options_.out.empty()) return;
    if (moved) drawing_->move(strands, hair().pose().rotation, hair().head());
    draw(k);
  }

  void draw(int k) {
    const auto begin = std::chrono::steady_clock::now();
    Image image = drawing_->render(scene_, camera_);
    for (const Stage& s : drawing_->ledger().stages()) totals_.add(s.name, s.milliseconds);
    write_picture(std::move(image), scene_, numbered(options_.out, k, ".png"));
    totals_.add("(draw, write)", ms_since(begin));
  }

  const SimulateOptions& options_;
  Scene scene_;
  std::optional<Budget> budget_;
  std::vector<double> frame_ms_;
  std::unique_ptr<Drawing> drawing_;  // none without pictures
  Subject subject_;
  std::optional<Clip> clip_;
  Camera camera_;
  Totals totals_;
  std::vector<FrameReport> reports_;
};

void print_json(const Sequence& sequence, const std::vector<LedgerLine>& ledger) {
  nlohmann::ordered_json json;
  for (const FrameReport& r : sequence.reports())
    json["frames"].push_back({{"frame", r.frame},
                              {"hash", fmt::format("{:016x}", r.hash)},
                              {"fastest_m_s", r.fastest_m_s},
                              {"fastest_root_m_s", r.fastest_root_m_s},
                              {"asleep", r.asleep}});
  for (const auto& [name, ms] : sequence.totals().sums()) json["ms_per_frame"][name] = ms / sequence.frames();
  json["steps"] = sequence.simulation().facts().steps;
  json["dropped_s"] = sequence.simulation().facts().dropped_s;
  if (!ledger.empty()) json["effects"] = json_of(ledger);
  if (sequence.budget()) json["budget"] = json_of(*sequence.budget());
  console::print_json(json);
}

void print_stats(const Sequence& sequence) {
  std::printf("%-22s %12s\n", "stage", "ms per frame");
  for (const auto& [name, ms] : sequence.totals().sums())
    std::printf("%-22s %12.2f\n", name.c_str(), ms / sequence.frames());
  const FrameReport& last = sequence.reports().back();
  std::printf("%-22s %016llx\n", "last state", static_cast<unsigned long long>(last.hash));
  std::printf("%-22s %zu\n", "asleep at the end", last.asleep);
}

void simulate(const console::Verb& verb, const SimulateOptions& options) {
  const bool pictures = !options.out.empty();
  if (!options.video.empty() && !pictures) throw UsageError("--video is made from pictures: give -o as well");
  if (!pictures && options.hair_out.empty() && !options.stats && !options.explain && !options.budget.goal() &&
      !console::common().json)
    throw UsageError(
        "nothing is asked for: give -o for pictures, --hair-out for hair files, --stats, --explain, --budget-ms, "
        "--target-error or --json");
  Scene scene = resolve_scene(verb, *options.scene);
  scene.simulation = resolve_simulation(verb, *options.simulation, scene);
  if (pictures) check_curls(scene);
  if (scene.method == Method::satf && pictures && !options.hair_out.empty())
    throw UsageError("method satf moves clusters, not strands: give --hair-out without -o, or another --method");
  if (!options.video.empty()) check_video(options.video);
  make_folder(options.out, "frame_0000.png");
  make_folder(options.hair_out, "frame_0000.hair");
  std::optional<HeadlessContext> context;
  if (pictures && needs_opengl(scene.method)) context.emplace();
  Sequence sequence(options, scene);
  sequence.run();
  if (!options.video.empty()) make_video(options.out, sequence.frames(), options.fps, options.video);
  const std::vector<LedgerLine> ledger = options.explain ? sequence.explain() : std::vector<LedgerLine>{};
  if (sequence.budget() && !sequence.budget()->choice.met) {
    spdlog::warn("no settings meet the goal: those that come closest were used");
    console::set_exit_code(console::threshold);
  }
  if (console::common().json) {
    print_json(sequence, ledger);
    return;
  }
  if (sequence.budget()) print_budget(*sequence.budget());
  if (options.stats) print_stats(sequence);
  if (options.explain) print_ledger(ledger);
  for (const std::filesystem::path* const made : {&options.out, &options.hair_out, &options.video})
    if (!made->empty()) std::printf("%s\n", made->c_str());
}

}  // namespace

void add_simulate(CLI::App& app) {
  console::Verb* const verb =
      console::add_verb(app, "simulate", "Move the hair of a scene, a hairstyle or a hair file, and draw it");
  auto o = std::make_shared<SimulateOptions>();
  o->scene = add_scene_options(*verb);
  verb->add_output_folder("-o,--out", o->out, "Folder for pictures, frame_0000.png and on; made if there is none",
                          {{R"(frame_\d{4,}\.png)", ""}});
  verb->add_output_folder("--hair-out", o->hair_out, "Folder for hair files, frame_0000.hair and on",
                          {{R"(frame_\d{4,}\.hair)", ""}});
  verb->add_output("--video", o->video, "Video of the pictures, e.g. hair.mp4; needs ffmpeg");
  o->simulation = add_simulation_options(*verb);
  verb->add_option("--fps", o->fps, "Frames per second")->capture_default_str()->check(console::finite(1, 1000));
  verb->add_option("--seconds", o->seconds, "Length of the sequence [that of the motion, or 2]")
      ->check(console::finite(0.001, 100000));
  add_budget_options(*verb, o->budget, "a frame's chains, voxels and strands",
                     "RMS distance of the hair from a converged run [mm]");
  verb->add_flag("--stats", o->stats, "Print the time of each stage and a hash of the last state");
  verb->add_flag(
      "--explain", o->explain,
      "Print the ledger: each effect of the motion, whether it runs and why, its cost, and how far hair and, "
      "with -o, the last picture are from those with it switched over (four sequences more for each)");
  console::add_common_options(*verb);
  verb->runs([verb, o] { simulate(*verb, *o); });
}

}  // namespace pelage::app
