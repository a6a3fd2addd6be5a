#include "pelage/app/converged_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pelage/app/clip.h"
#include "pelage/app/repeat.h"
#include "pelage/app/stopwatch.h"
#include "pelage/app/strand_places.h"

namespace pelage::app {
namespace {

constexpr int kFinestVertices = 32;  // of the longest strand

ClipError compare(const std::vector<Strands>& a, const std::vector<Strands>& b) {
  std::vector<float> distances_m;
  std::size_t last = 0;
  for (std::size_t k = 0; k < a.size(); ++k) last = distances_m.size(), add_distances(a[k], b[k], distances_m);
  return {rms_mm(distances_m), p99_mm(distances_m), max_mm(distances_m), rms_mm(std::span(distances_m).subspan(last))};
}

Scene with_steps(Scene scene, int per_s) {
  scene.simulation.life.step_s = 1.0 / per_s;
  return scene;
}

Scene finest_of(const Scene& scene, int per_s) {
  Scene finest = with_steps(with_motion(scene), per_s);
  finest.simulation.wisps = 0;
  finest.simulation.vertices = std::max(finest.simulation.vertices, kFinestVertices);
  return finest;
}

}  // namespace

double ClipRun::median_ms() const {
  return median_of(frame_ms);
}

Scene with_motion(Scene scene) {
  if (scene.simulation.motion.kind == MotionKind::none) scene.simulation.motion.kind = MotionKind::shake;
  return scene;
}

Subject thinned(Subject subject, std::size_t most) {
  Strands& all = subject.hair.strands;
  const std::size_t count = all.count();
  if (count <= most) return subject;
  const float wider = std::sqrt(static_cast<float>(count) / static_cast<float>(most));
  Strands few;
  few.diameter_m = all.diameter_m * wider;
  for (std::size_t i = 0; i < most; ++i) {
    const std::size_t s = i * count / most;
    few.append(all.strand(s));
    if (!all.colours.empty()) few.colours.push_back(all.colours[s]);
    if (!all.diameters_m.empty())
      for (std::size_t v = all.offsets[s]; v < all.offsets[s + 1]; ++v)
        few.diameters_m.push_back(all.diameters_m[v] * wider);
  }
  all = std::move(few);
  return subject;
}

ClipRun run_clip(const Subject& subject, const Scene& scene, ClipLength length) {
  const Strands& strands = subject.hair.strands;
  const auto begin = std::chrono::steady_clock::now();
  Clip clip(strands, subject.head, planned_motion(with_motion(scene), strands, subject.head, subject.hair.opacity),
            length.fps, length.seconds);
  clip.begin();
  ClipRun run;
  run.prepare_ms = ms_since(begin);
  for (int k = 0; k < clip.frames(); ++k) {
    const SimulationFacts before = clip.hair().simulation().facts();
    clip.advance(k);
    const Strands& now = clip.hair().hair();
    const SimulationFacts& after = clip.hair().simulation().facts();
    run.frames.push_back(now);
    run.bytes = std::max<std::uint64_t>(run.bytes, after.bytes + now.vertices.size() * sizeof(glm::vec3));
    if (k > 0)
      run.frame_ms.push_back(after.chain_ms - before.chain_ms + after.grid_ms - before.grid_ms + clip.hair().hair_ms());
  }
  run.head = clip.hair().head();
  return run;
}

ConvergedMotion::ConvergedMotion(const Scene& scene, Subject subject, ClipLength length, int finest)
    : subject_(std::move(subject)), length_(length) {
  const Scene fine = finest_of(scene, finest);
  finest_ = run(fine).frames;
  const std::vector<Strands> twice = run(with_steps(fine, finest / 2)).frames;
  const std::vector<Strands> four = run(with_steps(fine, finest / 4)).frames;
  const double d = compare(finest_, twice).rms_mm, before = compare(twice, four).rms_mm;
  // Within what schemes of this kind do: hair that parts from itself by chance shows none.
  order_ = std::clamp(d > 0 && before > 0 ? std::log2(before / d) : 1.0, 0.5, 2.0);
  own_error_mm_ = d / (std::exp2(order_) - 1);
  what_ = fmt::format(
      "{:g} s of the scene's motion at {:g} frames/s, all {} strands simulated with {} vertices on the longest and an "
      "internal step of 1/{} s. Runs at twice and four times that step are {:.3g} and {:.3g} mm apart (order {:.2f}), "
      "so "
      "its own error is about {:.3g} mm: the error bars.",
      length.seconds, length.fps, subject_.hair.strands.count(), fine.simulation.vertices, finest, d, before, order_,
      own_error_mm_);
}

ClipRun ConvergedMotion::run(const Scene& scene) const {
  return run_clip(subject_, scene, length_);
}

ClipError ConvergedMotion::error_of(const ClipRun& run) const {
  return compare(run.frames, finest_);
}

}  // namespace pelage::app
