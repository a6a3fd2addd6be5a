// Private to this box: keys of the simulation's settings (simulation_settings.h).
#pragma once

#include "pelage/data_schema/json_fields.h"
#include "pelage/data_schema/simulation_settings.h"

namespace pelage::json_fields {

template <>
inline constexpr std::array<std::string_view, 3> kNames<ChainSolver>{"dftl", "position-based", "tridiagonal"};
template <>
inline constexpr std::array<std::string_view, 2> kNames<RepulsionKind>{"gradient", "overfull"};
template <>
inline constexpr std::array<std::string_view, 7> kNames<MotionKind>{"none", "shake", "nod",      "turn",
                                                                    "jump", "dance", "keyframes"};

}  // namespace pelage::json_fields

namespace pelage {

template <class F>
void fields(F&& f, ChainSettings& s) {
  f("solver", s.solver);
  f("iterations", s.iterations);
  f("ftl_correction", s.ftl_correction);
  f("gravity", s.gravity);
  f("damping_per_s", s.damping_per_s);
}

template <class F>
void fields(F&& f, InteractionSettings& s) {
  f("cell_m", s.cell_m);
  f("friction_per_s", s.friction_per_s);
  f("repulsion_m_s2", s.repulsion_m_s2);
  f("repulsion", s.repulsion);
  f("overfull", s.overfull);
}

template <class F>
void fields(F&& f, WindSettings& s) {
  f("velocity_m_s", s.velocity_m_s);
  f("gust", s.gust);
  f("gust_s", s.gust_s);
  f("gust_m", s.gust_m);
  f("drag_per_s", s.drag_per_s);
  f("shelter", s.shelter);
}

template <class F>
void fields(F&& f, CurlSettings& s) {
  f("radius_m", s.radius_m);
  f("pitch_m", s.pitch_m);
  f("frequency_growth", s.frequency_growth);
  f("start", s.start);
  f("phase_spread", s.phase_spread);
  f("subdivision", s.subdivision);
}

template <class F>
void fields(F&& f, ShapeSettings& s) {
  f("hold_rad_s", s.hold_rad_s);
  f("hold_tip", s.hold_tip);
  f("sag_free", s.sag_free);
  f("cone_deg", s.cone_deg);
  f("cone_end", s.cone_end);
  f("curl", s.curl);
}

template <class F>
void fields(F&& f, ColliderCapsule& s) {
  f("from", s.from);
  f("to", s.to);
  f("radius_m", s.radius_m);
  f("velocity_m_s", s.velocity_m_s);
  f("with_head", s.with_head);
}

template <class F>
void fields(F&& f, CollisionSettings& s) {
  f("head", s.head);
  f("margin_m", s.margin_m);
  f("friction", s.friction);
  f("field_cell_m", s.field_cell_m);
  f("capsules", s.capsules);
}

template <class F>
void fields(F&& f, MotionKey& s) {
  f("time_s", s.time_s);
  f("position_m", s.position_m);
  f("turn_deg", s.turn_deg);
}

template <class F>
void fields(F&& f, MotionSettings& s) {
  f("kind", s.kind);
  f("amplitude", s.amplitude);
  f("speed", s.speed);
  f("keys", s.keys);
}

template <class F>
void fields(F&& f, LifeSettings& s) {
  f("step_s", s.step_s);
  f("catch_up_s", s.catch_up_s);
  f("settle_s", s.settle_s);
  f("max_speed_m_s", s.max_speed_m_s);
  f("explosion_m_s", s.explosion_m_s);
  f("sleep_m_s", s.sleep_m_s);
  f("sleep_after_s", s.sleep_after_s);
}

template <class F>
void fields(F&& f, SimulationSettings& s) {
  f("name", s.name);
  f("vertices", s.vertices);
  f("detail", s.detail);
  f("wisps", s.wisps);
  f("chain", s.chain);
  f("interaction", s.interaction);
  f("wind", s.wind);
  f("shape", s.shape);
  f("collision", s.collision);
  f("motion", s.motion);
  f("life", s.life);
}

}  // namespace pelage
