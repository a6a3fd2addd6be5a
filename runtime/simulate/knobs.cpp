#include "pelage/simulate/knobs.h"

#include <string>

namespace pelage {
namespace {

/// Internal steps by their number per second, which is what people say; the amount is the step [s].
std::vector<KnobValue> steps(std::initializer_list<int> per_s) {
  std::vector<KnobValue> values;
  for (const int n : per_s) {
    const KnobValue step = numbers("simulation.life.step_s", {1.0 / n}).front();
    values.push_back({"1/" + std::to_string(n), step.amount, step.settings, 0, {}});
  }
  return values;
}

std::vector<KnobValue> cited(std::vector<KnobValue> values, const std::string& label, const std::string& paper) {
  for (KnobValue& value : values)
    if (value.label == label) value.paper = paper;
  return values;
}

/// Fewer vertices and guides go with longer steps.
KnobValue together(int steps_per_s, int vertices, int wisps, const std::string& solver = "dftl") {
  const std::string n = std::to_string(steps_per_s), v = std::to_string(vertices), w = std::to_string(wisps);
  KnobValue value;
  value.label = "1/" + n + "-" + v + (wisps > 0 ? "-" + w : "") + (solver == "dftl" ? "" : "-" + solver);
  value.settings = {steps({steps_per_s}).front().settings[0], "simulation.vertices=" + v, "simulation.wisps=" + w};
  if (solver != "dftl") {
    value.settings.push_back("simulation.chain.solver=" + solver);
    value.settings.emplace_back("simulation.chain.iterations=1");
  }
  return value;
}

std::vector<KnobValue> all_together() {
  std::vector<KnobValue> values;
  for (const int n : {60, 120, 240, 480, 960})
    for (const int vertices : {6, 10, 16, 24, 32})
      for (const int wisps : {0, 200, 50}) values.push_back(together(n, vertices, wisps));
  for (const int n : {60, 120, 240, 480})
    for (const int vertices : {10, 16, 32}) values.push_back(together(n, vertices, 0, "tridiagonal"));
  return values;
}

/// Knobs of the motion of hair.
std::vector<Knob> motion_knobs() {
  const std::string relaxed = "simulation.chain.solver=position-based", newton = "simulation.chain.solver=tridiagonal";
  const std::string iterations = "simulation.chain.iterations";
  const MeasureKind motion = MeasureKind::motion;
  return {
      {"simulation.step",
       "Internal step: finer ones bring follow-the-leader to the motion of an inextensible chain.",
       "s",
       motion,
       {},
       cited(steps({60, 90, 120, 180, 240, 360, 480, 720, 960}), "1/60", "Mueller2012")},
      {"simulation.vertices",
       "Vertices of the longest centre line: finer waves move by themselves, not as riders.",
       "",
       motion,
       {},
       numbers("simulation.vertices", {4, 6, 8, 12, 16, 24, 32, 48})},
      {"simulation.guides",
       "Wisps of three simulated guides each; other strands are carried by them.",
       "wisps",
       motion,
       {},
       cited(numbers("simulation.wisps", {10, 20, 50, 100, 134, 200, 300, 500}), "134", "Bertails2005")},
      {"simulation.correction",
       "Share of a follower's correction that comes back to its leader as velocity; below 1 motion does not converge.",
       "",
       motion,
       {},
       cited(numbers("simulation.chain.ftl_correction", {.6, .7, .8, .9, .95, 1}), "0.9", "Mueller2012")},
      {"simulation.cell",
       "Side of a voxel, through which hair feels hair. It is how far that reaches as well: what differs from the "
       "scene's is other hair, not a coarser picture of the same.",
       "m",
       motion,
       {},
       numbers("simulation.interaction.cell_m", {.04, .03, .02, .015, .01, .0075, .005})},
      {"simulation.detail",
       "What centre lines leave out of the strands rides on them, or is left out.",
       "",
       motion,
       {},
       choices("simulation.detail", {"false", "true"})},
      {"simulation.position-based",
       "Iterations of relaxed constraints [Mueller2006]: fewer leave hair stretched.",
       "",
       motion,
       {relaxed},
       numbers(iterations, {1, 2, 4, 8, 16, 32})},
      {"simulation.position-based.step",
       "Internal step with relaxed constraints.",
       "s",
       motion,
       {relaxed, iterations + "=4"},
       steps({60, 120, 240, 480, 960})},
      {"simulation.tridiagonal",
       "Newton steps of all constraints of a strand at once [Han2013].",
       "",
       motion,
       {newton},
       numbers(iterations, {1, 2, 3, 5, 10})},
      {"simulation.tridiagonal.step",
       "Internal step with all constraints of a strand at once, one Newton step.",
       "s",
       motion,
       {newton, iterations + "=1"},
       steps({60, 90, 120, 180, 240, 360, 480, 720, 960})},
      {"simulation.together",
       "Step, vertices and wisps at once: labels are step, vertices, wisps, solver.",
       "",
       motion,
       {},
       all_together()},
  };
}

/// Of the period of a hanging chain of ten links.
Knob period_knob(const std::string& name, const std::string& what, std::vector<std::string> base) {
  base.insert(base.begin(), "simulation.vertices=11");
  return {name, what, "s", MeasureKind::period, std::move(base), steps({120, 180, 240, 360, 480, 720, 960})};
}

std::vector<Knob> period_knobs() {
  const std::string correction = "simulation.chain.ftl_correction", solver = "simulation.chain.solver";
  Knob part = period_knob("simulation.period.correction-0.9",
                          "Internal step of follow-the-leader with s = .9: shorter steps do not help.",
                          {solver + "=dftl", correction + "=0.9"});
  for (KnobValue& value : part.values) value.paper = "Mueller2012";
  return {period_knob("simulation.period.correction-1", "Internal step of follow-the-leader with s = 1: order 2.",
                      {solver + "=dftl", correction + "=1"}),
          part,
          period_knob("simulation.period.position-based", "Internal step of relaxed constraints, 10 iterations.",
                      {solver + "=position-based", "simulation.chain.iterations=10"}),
          period_knob("simulation.period.tridiagonal", "Internal step of all constraints at once, one Newton step.",
                      {solver + "=tridiagonal", "simulation.chain.iterations=1"})};
}

}  // namespace

std::span<const Knob> simulation_knobs() {
  static const std::vector<Knob> knobs = [] {
    std::vector<Knob> all = motion_knobs();
    for (Knob& knob : period_knobs()) all.push_back(std::move(knob));
    return all;
  }();
  return knobs;
}

}  // namespace pelage
