#include "pelage/app/explain.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "pelage/app/picture.h"
#include "pelage/console/program.h"
#include "pelage/console/progress.h"

namespace pelage::app {
namespace {

/// A picture in which hair has moved, as people see it, and what it took.
struct Shot {
  Image image;
  std::vector<Stage> stages;  // calls: of this picture
  double ms = 0;
};

Shot shoot(Drawing& drawing, const Scene& scene, const Camera& camera) {
  const std::vector<Stage> before = drawing.ledger().stages();
  drawing.refresh();
  Shot shot{drawing.render(scene, camera), drawing.ledger().stages()};
  console::throw_if_interrupted();
  for (std::size_t i = 0; i < shot.stages.size(); ++i) {
    if (i < before.size()) shot.stages[i].calls -= before[i].calls;
    shot.ms += shot.stages[i].milliseconds;
  }
  shot.image = finished(std::move(shot.image), scene.image);
  return shot;
}

}  // namespace

void charge(LedgerLine& line, const Effect& effect, const std::vector<Stage>& stages) {
  for (const Stage& stage : stages) {
    if (std::find(effect.stages.begin(), effect.stages.end(), stage.name) == effect.stages.end()) continue;
    line.ms += stage.milliseconds;
    line.bytes += stage.calls > 0 ? stage.bytes : 0;
    line.calls += stage.calls;
  }
}

double rms_difference(const Image& a, const Image& b) noexcept {
  double sum = 0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i) {
    const double d = static_cast<double>(a.rgba[i]) - static_cast<double>(b.rgba[i]);
    if (i % 4 != 3) sum += d * d;
  }
  return std::sqrt(sum / (0.75 * static_cast<double>(std::max<std::size_t>(a.rgba.size(), 1))));
}

LedgerLine line_of(const PlannedEffect& p) {
  LedgerLine line;
  line.name = p.effect.name;
  line.pass = p.effect.pass;
  line.asked = p.asked;
  line.runs = p.runs;
  line.called_for = p.called_for;
  line.why = p.why;
  return line;
}

std::vector<LedgerLine> ledger_of(const Drawing& drawing) {
  std::vector<LedgerLine> ledger;
  for (const PlannedEffect& p : drawing.plan().effects)
    charge(ledger.emplace_back(line_of(p)), p.effect, drawing.ledger().stages());
  return ledger;
}

bool same_work(const EffectPlan& a, const EffectPlan& b) {
  for (std::size_t i = 0; i < a.effects.size(); ++i)
    if (a.effects[i].runs != b.effects[i].runs) return false;
  return true;
}

Scene switched_over(const Scene& scene, const PlannedEffect& p) {
  Scene other = scene;
  other.effects[p.effect.name] = p.runs ? EffectState::off : EffectState::on;
  return other;
}

void set_savings(LedgerLine& line, const std::array<double, 2>& as_is_ms, const std::array<double, 2>& other_ms) {
  const double saved = std::min(as_is_ms[0], as_is_ms[1]) - std::min(other_ms[0], other_ms[1]);
  line.saves_ms = line.runs ? saved : -saved;
  line.spread_ms = std::max(std::abs(as_is_ms[0] - as_is_ms[1]), std::abs(other_ms[0] - other_ms[1]));
}

namespace {

void compare_shots(Drawing& drawing, const Scene& as_is, const Scene& other, const Camera& camera, LedgerLine& line) {
  std::array<double, 2> with_ms{}, without_ms{};
  for (int i = 0; i < 2; ++i) {
    const Shot a = shoot(drawing, as_is, camera), b = shoot(drawing, other, camera);
    with_ms[static_cast<std::size_t>(i)] = a.ms, without_ms[static_cast<std::size_t>(i)] = b.ms;
    line.rmse = rms_difference(a.image, b.image);
  }
  set_savings(line, with_ms, without_ms);
}

}  // namespace

std::vector<LedgerLine> explain_picture(Drawing& drawing, const Scene& scene, const Camera& camera) {
  shoot(drawing, scene, camera);  // warms up: what is made once is made
  const Shot whole = shoot(drawing, scene, camera);
  const EffectPlan plan = drawing.plan();
  console::Progress progress("leaving out effects", plan.effects.size(), "effects");
  std::vector<LedgerLine> ledger;
  for (const PlannedEffect& p : plan.effects) {
    LedgerLine& line = ledger.emplace_back(line_of(p));
    charge(line, p.effect, whole.stages);
    if (!p.effect.pass && !p.idle) {
      const Scene other = switched_over(scene, p);
      if (same_work(plan, plan_effects(other, drawing.facts(), Task::picture)))
        line.rmse = line.saves_ms = 0;
      else
        compare_shots(drawing, scene, other, camera, line);
    }
    progress.update(ledger.size());
  }
  return ledger;
}

namespace {

const char* name_of(EffectState state) {
  return state == EffectState::on ? "on" : state == EffectState::off ? "off" : "auto";
}

/// What cannot be told from the spread is said so.
std::string savings(const LedgerLine& line) {
  if (!line.saves_ms) return "-";
  return std::abs(*line.saves_ms) < line.spread_ms ? fmt::format("<{:.3g}", line.spread_ms)
                                                   : fmt::format("{:.3g}", *line.saves_ms);
}

std::string number_or_dash(const std::optional<double>& value, const char* format) {
  return value ? fmt::format(fmt::runtime(format), *value) : "-";
}

nlohmann::ordered_json json_of(const LedgerLine& line) {
  nlohmann::ordered_json json{{"effect", line.name},
                              {"pass", line.pass},
                              {"asked", name_of(line.asked)},
                              {"runs", line.runs},
                              {"called_for", line.called_for},
                              {"why", line.why},
                              {"ms", line.ms},
                              {"bytes", line.bytes},
                              {"calls", line.calls}};
  if (line.saves_ms) json["saves_ms"] = *line.saves_ms, json["spread_ms"] = line.spread_ms;
  if (line.rmse) json["rmse"] = *line.rmse;
  if (line.moves_mm) json["moves_mm"] = *line.moves_mm;
  return json;
}

}  // namespace

nlohmann::ordered_json json_of(const std::vector<LedgerLine>& ledger) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const LedgerLine& line : ledger) json.push_back(json_of(line));
  return json;
}

void print_ledger(const std::vector<LedgerLine>& ledger) {
  const bool motion = std::any_of(ledger.begin(), ledger.end(), [](const LedgerLine& l) { return l.moves_mm; });
  if (motion) std::printf("ms and MiB: of a frame on average; calls: of the whole sequence\n");
  std::printf("%-20s %-5s %-4s %9s %8s %6s %9s %9s %s %s\n", "effect", "asked", "runs", "ms", "MiB", "calls",
              "saves ms", "RMSE", motion ? " moves mm" : "", "why");
  for (const LedgerLine& l : ledger) {
    std::printf("%-20s %-5s %-4s %9.2f %8.1f %6llu %9s %9s %s %s\n", l.name.c_str(), l.pass ? "pass" : name_of(l.asked),
                l.runs ? "yes" : "no", l.ms, static_cast<double>(l.bytes) / 1048576.0,
                static_cast<unsigned long long>(l.calls), savings(l).c_str(), number_or_dash(l.rmse, "{:.5f}").c_str(),
                motion ? fmt::format("{:>9}", number_or_dash(l.moves_mm, "{:.3f}")).c_str() : "", l.why.c_str());
  }
}

}  // namespace pelage::app
