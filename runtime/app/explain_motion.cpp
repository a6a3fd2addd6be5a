#include "pelage/app/explain_motion.h"

#include <array>

#include "pelage/app/clip.h"
#include "pelage/app/figure_sheet.h"
#include "pelage/app/strand_places.h"
#include "pelage/console/progress.h"

namespace pelage::app {
namespace {

/// A sequence at its end, and what a frame of it took on average.
struct Run {
  Strands hair;
  Image image;  // empty without a drawing
  double ms = 0;
  std::vector<Stage> stages;
};

Run run(const Subject& subject, const Scene& planned, double fps, double seconds, Drawing* drawing,
        const Camera& camera) {
  Clip clip(subject.hair.strands, subject.head, planned.simulation, fps, seconds);
  clip.begin();
  const SimulationFacts before = clip.hair().simulation().facts();
  double strands_ms = 0;
  std::uint64_t strands_calls = 0;
  for (int k = 0; k < clip.frames(); ++k) {
    clip.advance(k);
    strands_calls += clip.hair().moved() ? 1 : 0;
    clip.hair().hair();
    strands_ms += clip.hair().hair_ms();
  }
  const SimulationFacts& now = clip.hair().simulation().facts();
  const double frames = clip.frames();
  Run result;
  result.hair = clip.hair().hair();
  result.stages = {
      {"chains", (now.chain_ms - before.chain_ms) / frames, now.bytes - now.grid_bytes,
       now.chain_steps - before.chain_steps},
      {"grid", (now.grid_ms - before.grid_ms) / frames, now.grid_bytes, now.grid_builds - before.grid_builds},
      {"strands", strands_ms / frames, clip.hair().hair().vertices.size() * sizeof(glm::vec3), strands_calls}};
  for (const Stage& stage : result.stages) result.ms += stage.milliseconds;
  if (drawing == nullptr) return result;
  drawing->move(clip.hair().hair(), clip.hair().pose().rotation, clip.hair().head());
  Scene scene = planned;
  scene.camera = camera;
  result.image = picture_of(*drawing, scene);
  return result;
}

}  // namespace

std::vector<LedgerLine> explain_motion(const Subject& subject, const Scene& scene, double fps, double seconds,
                                       Drawing* drawing, const Camera& camera) {
  const HairFacts facts{&subject.hair.strands, nullptr, &subject.head, subject.hair.opacity};
  const EffectPlan plan = plan_effects(scene, facts, Task::motion);
  const auto compare_runs = [&](const Scene& as_is, const Scene& other, LedgerLine& line) {
    std::array<double, 2> with_ms{}, without_ms{};
    for (std::size_t i = 0; i < 2; ++i) {
      const Run a = run(subject, as_is, fps, seconds, drawing, camera);
      const Run b = run(subject, other, fps, seconds, drawing, camera);
      with_ms[i] = a.ms, without_ms[i] = b.ms;
      line.moves_mm = rms_mm(a.hair, b.hair);
      if (drawing != nullptr) line.rmse = rms_difference(a.image, b.image);
    }
    set_savings(line, with_ms, without_ms);
  };
  console::Progress progress("leaving out effects of the motion", plan.effects.size(), "effects");
  std::vector<LedgerLine> ledger;
  for (const PlannedEffect& p : plan.effects) {
    LedgerLine& line = ledger.emplace_back(line_of(p));
    if (!p.effect.pass && !p.idle) {
      const EffectPlan other = plan_effects(switched_over(scene, p), facts, Task::motion);
      if (same_work(plan, other))
        line.moves_mm = line.saves_ms = 0;
      else
        compare_runs(plan.scene, other.scene, line);
    }
    progress.update(ledger.size());
  }
  const Run whole = run(subject, plan.scene, fps, seconds, nullptr, camera);
  for (std::size_t i = 0; i < ledger.size(); ++i) charge(ledger[i], plan.effects[i].effect, whole.stages);
  return ledger;
}

}  // namespace pelage::app
