#include "pelage/app/explain_motion.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <span>

#include "pelage/app/clip.h"
#include "pelage/app/figure_sheet.h"
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

/// The place at a share of a strand's length.
glm::dvec3 place_at(std::span<const glm::vec3> strand, double share) {
  const auto segment = [&](std::size_t v) { return glm::distance(glm::dvec3(strand[v - 1]), glm::dvec3(strand[v])); };
  double length_m = 0;
  for (std::size_t v = 1; v < strand.size(); ++v) length_m += segment(v);
  double left_m = share * length_m;
  for (std::size_t v = 1; v < strand.size(); ++v) {
    const double segment_m = segment(v);
    if (left_m < segment_m) return glm::mix(glm::dvec3(strand[v - 1]), glm::dvec3(strand[v]), left_m / segment_m);
    left_m -= segment_m;
  }
  return strand.back();
}

/// Vertex by vertex; where curls or detail give strands vertices of their own, at evenly spaced shares of their length.
double rms_mm(const Strands& a, const Strands& b) {
  constexpr int kShares = 16;
  double sum = 0;
  std::size_t places = 0;
  const auto add = [&](const glm::dvec3& d) { sum += glm::dot(d, d), ++places; };
  for (std::size_t s = 0; s < a.count(); ++s) {
    const auto p = a.strand(s), q = b.strand(s);
    if (p.size() == q.size())
      for (std::size_t v = 0; v < p.size(); ++v) add(glm::dvec3(p[v]) - glm::dvec3(q[v]));
    else if (!p.empty() && !q.empty())
      for (int i = 0; i <= kShares; ++i) add(place_at(p, 1.0 * i / kShares) - place_at(q, 1.0 * i / kShares));
  }
  return 1e3 * std::sqrt(sum / static_cast<double>(std::max<std::size_t>(places, 1)));
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
