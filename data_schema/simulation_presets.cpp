// Presets: what people call hair, as parameters. Each was looked at on a straight groom under `shake`
// (pelage figure presets).
#include <algorithm>

#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/simulation_settings.h"
#include "pelage/data_schema/validate.h"

namespace pelage {
namespace {

SimulationSettings named(const char* name) {
  SimulationSettings s;
  s.name = name;
  return s;
}

/// Hangs freely, only the roots keep their direction a little.
SimulationSettings loose() {
  SimulationSettings s = named("loose");
  s.shape.cone_deg = 30;
  return s;
}

/// Keeps its parting, ends swing freely.
SimulationSettings straight() {
  SimulationSettings s = named("straight");
  s.interaction.friction_per_s = 6;
  s.shape.hold_rad_s = 20;
  s.shape.hold_tip = 0;
  s.shape.cone_deg = 30;
  return s;
}

/// More body than straight hair, and a wide helix of few turns.
SimulationSettings wavy() {
  SimulationSettings s = named("wavy");
  s.interaction.friction_per_s = 8;
  s.interaction.repulsion_m_s2 = 2;
  s.shape.hold_rad_s = 20;
  s.shape.hold_tip = 0.05F;
  s.shape.cone_deg = 30;
  s.shape.curl = {.radius_m = 0.006F, .pitch_m = 0.07F, .frequency_growth = 0.3F, .phase_spread = 0.06F};
  return s;
}

SimulationSettings curly() {
  SimulationSettings s = named("curly");
  s.interaction.friction_per_s = 12;
  s.interaction.repulsion_m_s2 = 4;
  s.shape.hold_rad_s = 25;
  s.shape.hold_tip = 0.2F;
  s.shape.cone_deg = 30;
  s.shape.curl = {
      .radius_m = 0.008F, .pitch_m = 0.035F, .frequency_growth = 0.6F, .phase_spread = 0.1F, .subdivision = 8};
  return s;
}

/// A styled groom stays as it was combed, and sways around it.
SimulationSettings hold_shape() {
  SimulationSettings s = named("hold-shape");
  s.interaction.repulsion_m_s2 = 0;
  s.shape.hold_rad_s = 25;
  s.shape.hold_tip = 0.4F;
  s.shape.sag_free = true;
  return s;
}

/// Heavy and slow, strands cling together.
SimulationSettings wet() {
  SimulationSettings s = named("wet");
  s.chain.damping_per_s = 12;
  s.interaction.friction_per_s = 30;
  s.interaction.repulsion_m_s2 = 0;
  s.shape.hold_rad_s = 12;
  s.shape.hold_tip = 0;
  return s;
}

}  // namespace

SimulationSettings simulation_preset(const std::string& name) {
  const std::vector<SimulationSettings> all{loose(), straight(), wavy(), curly(), hold_shape(), wet()};
  std::vector<std::string> names;
  for (const SimulationSettings& s : all) {
    if (s.name == name) return s;
    names.push_back(s.name);
  }
  throw UsageError("there is no preset \"" + name +
                   "\": the nearest of loose, straight, wavy, curly, hold-shape, wet is \"" +
                   nearest_word(name, names) + "\"");
}

}  // namespace pelage
