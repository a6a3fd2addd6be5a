#include "pelage/simulate/simulation.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/common.hpp>
#include <glm/ext/quaternion_common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "pelage/data_schema/errors.h"
#include "pelage/simulate/chain_kernels.h"
#include "pelage/simulate/colliders.h"
#include "pelage/simulate/lane_math.h"
#include "pelage/simulate/voxel_grid.h"

namespace pelage {
namespace {

/// Blocks that one task steps: 256 strands.
constexpr std::size_t kGrain = 16;
constexpr double kShortestStep = 1.0 / 2000, kLongestStep = 1.0 / 60;
/// A head that moves less than this in a step [m, and as much of a rotation's matrix] stands still.
constexpr double kStill = 1e-9;
/// Of the sleep speed: hair around a sleeping strand that is faster than this many times wakes it.
constexpr float kWake = 4;
/// Of a step: what rounding may leave of a frame that is a whole number of steps.
constexpr double kRound = 1e-6;

void check(const SimulationSettings& s) {
  const double step = s.life.step_s;
  if (!(step >= kShortestStep && step <= kLongestStep))
    throw UsageError("the internal step is " + std::to_string(step) + " s; it lies between 1/2000 s (below it floats " +
                     "lose the motion) and 1/60 s");
  const float correction = s.chain.ftl_correction;
  if (s.chain.solver == ChainSolver::dftl && !(correction >= 0.6F && correction <= 1.0F))
    throw UsageError("ftl_correction is " + std::to_string(static_cast<double>(correction)) +
                     "; it lies between 0.6 (below .5 DFTL blows up as the step shrinks) and 1");
  if (!(s.life.explosion_m_s > 0)) throw UsageError("explosion_m_s must be above 0");
}

glm::dvec3 middle_of_roots(const Strands& lines) {
  glm::dvec3 low(INFINITY), high(-INFINITY);
  for (std::size_t s = 0; s < lines.count(); ++s) {
    if (lines.strand(s).empty()) continue;
    low = glm::min(low, glm::dvec3(lines.strand(s)[0]));
    high = glm::max(high, glm::dvec3(lines.strand(s)[0]));
  }
  return low.x <= high.x ? 0.5 * (low + high) : glm::dvec3(0);
}

bool finite(const RigidPose& pose) {
  const glm::dvec3& p = pose.position;
  const glm::dquat& q = pose.rotation;
  return std::isfinite(p.x + p.y + p.z + q.w + q.x + q.y + q.z) && glm::dot(q, q) > 1e-12;
}

RigidPose between(const RigidPose& a, const RigidPose& b, double share) {
  if (share >= 1) return b;
  return {glm::mix(a.position, b.position, share), glm::normalize(glm::slerp(a.rotation, b.rotation, share))};
}

double milliseconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

/// FNV-1a over 32-bit words.
struct Hash {
  std::uint64_t value = 14695981039346656037ULL;
  void add(float x) noexcept {
    std::uint32_t bits;
    static_assert(sizeof bits == sizeof x);
    std::copy_n(reinterpret_cast<const char*>(&x), sizeof x, reinterpret_cast<char*>(&bits));
    value = (value ^ bits) * 1099511628211ULL;
  }
  void add(double x) noexcept {
    const auto high = static_cast<float>(x);
    add(high);
    add(static_cast<float>(x - static_cast<double>(high)));
  }
};

/// Distance to keep from colliders: the margin, or what there is at rest. Hair that lies in the head at rest may stay
/// as deep.
std::vector<Lanes> clearances(const StrandBlocks& blocks, const Colliders& colliders, float margin_m) {
  std::vector<Lanes> result(blocks.first.back(), Lanes{});
  for (std::size_t b = 0; b < blocks.count(); ++b) {
    for (std::uint32_t v = blocks.first[b]; v < blocks.first[b + 1]; ++v) {
      Lanes3 points;
      in_grid_frame(blocks.root[b], blocks.position[v], points);
      Nearest near;
      colliders.nearest(points, margin_m, near);
      for (int l = 0; l < kLanes; ++l) result[v].v[l] = std::min(margin_m, near.distance.v[l]);
    }
  }
  return result;
}

}  // namespace

SimulationError::SimulationError(std::size_t strand_, std::size_t vertex_, std::uint64_t frame_,
                                 const std::string& what)
    : std::runtime_error("frame " + std::to_string(frame_) + ", strand " + std::to_string(strand_) + ", vertex " +
                         std::to_string(vertex_) + ": " + what),
      strand(strand_),
      vertex(vertex_),
      frame(frame_) {}

struct Simulation::State {
  State(const Strands& lines, const Mesh& head, const SimulationSettings& s)
      : settings(s),
        pivot(middle_of_roots(lines)),
        pose{pivot, glm::dquat(1.0, 0.0, 0.0, 0.0)},
        shown(pose),
        blocks(make_blocks(lines, pivot)),
        colliders(s.collision, head, pivot),
        grid(s.interaction, s.wind),
        fastest(blocks.count()),
        awake(blocks.count(), 1),
        still_s(blocks.count()) {
    prepare_step();
    if (grid.needs_grid()) grid.set_rest_density(blocks);
    facts.bytes = bytes();
    facts.grid_bytes = grid.bytes();
  }

  void prepare_step() {
    if (settings.shape.cone_deg > 0) cone_cos = cone_limits(blocks, settings.shape);
    if (!colliders.empty()) {
      colliders.move(pose, pose, 0, settings.life.step_s);
      clearance = clearances(blocks, colliders, settings.collision.margin_m);
    }
    step.step_s = static_cast<float>(settings.life.step_s);
    step.chain = settings.chain;
    step.hold_rad_s = settings.shape.hold_rad_s;
    step.hold_tip = settings.shape.hold_tip;
    step.sag_free = settings.shape.sag_free;
    step.colliders = colliders.empty() ? nullptr : &colliders;
    step.collision_margin_m = settings.collision.margin_m;
    step.contact_friction = settings.collision.friction;
    step.cone_cos = cone_cos;
    step.clearance = clearance;
  }

  std::size_t bytes() const {
    return blocks.first.back() * (4 * sizeof(Lanes3)) + (cone_cos.size() + clearance.size()) * sizeof(Lanes) +
           grid.bytes();
  }

  bool has_wind() const { return settings.wind.velocity_m_s != glm::vec3(0); }
  bool may_sleep() const { return settings.life.sleep_m_s > 0 && !has_wind(); }

  void advance_step(const RigidPose& next);
  bool move_head(const RigidPose& next);
  void step_chain();
  void step_grid();
  void cap_speeds();
  void fall_asleep();
  bool colliders_move() const {
    return std::any_of(settings.collision.capsules.begin(), settings.collision.capsules.end(),
                       [](const ColliderCapsule& c) { return !c.with_head && c.velocity_m_s != glm::vec3(0); });
  }
  void wake_touched();
  void note_speeds();
  void wake_all() {
    std::fill(awake.begin(), awake.end(), std::uint8_t{1});
    std::fill(still_s.begin(), still_s.end(), 0.0F);
  }
  void show();
  void look_for_explosions() const;

  SimulationSettings settings;
  glm::dvec3 pivot;
  RigidPose pose, shown;  // that of the last step; that of the last frame
  StrandBlocks blocks;
  Colliders colliders;
  VoxelGrid grid;
  std::vector<Lanes> cone_cos, clearance;
  ChainStep step;
  std::vector<float> fastest;       // [blocks] of the last step, squared
  std::vector<std::uint8_t> awake;  // [blocks]
  std::vector<float> still_s;       // [blocks] time below the sleep speed
  double time_s = 0, left_s = 0;    // simulated; not yet simulated
  SimulationFacts facts;
};

/// @return  does it move at all
bool Simulation::State::move_head(const RigidPose& next) {
  const glm::dmat3 before = glm::mat3_cast(pose.rotation), after = glm::mat3_cast(next.rotation);
  const glm::dmat3 change = after - before;
  const glm::dvec3 shift = next.position - pose.position;
  step.turn = glm::mat3(after);
  step.turn_change = glm::mat3(change);
  step.shift = glm::vec3(shift);
  if (!colliders.empty()) colliders.move(pose, next, time_s, settings.life.step_s);
  pose = next;
  double moved = glm::dot(shift, shift);
  for (int c = 0; c < 3; ++c) moved += glm::dot(change[c], change[c]);
  return moved > kStill * kStill;
}

void Simulation::State::step_chain() {
  const auto begin = std::chrono::steady_clock::now();
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks.count(), kGrain), [&](const auto& range) {
    for (std::size_t b = range.begin(); b < range.end();) {
      std::size_t end = b;
      while (end < range.end() && awake[end] != 0) ++end;
      if (end > b) step_chains(blocks, b, end, step, fastest);
      b = end + 1;
    }
  });
  facts.chain_ms += milliseconds_since(begin);
  ++facts.chain_steps;
}

void Simulation::State::step_grid() {
  if (grid.idle()) return;
  const auto begin = std::chrono::steady_clock::now();
  GridStep g;
  g.step_s = settings.life.step_s;
  g.time_s = time_s;
  g.pivot = pose.position;
  g.awake = awake;
  if (grid.needs_grid()) {
    grid.build(blocks, g);
    ++facts.grid_builds;
  }
  grid.apply(blocks, g);
  ++facts.grid_applies;
  if (may_sleep()) grid.wake(blocks, g, awake, kWake * settings.life.sleep_m_s);
  facts.grid_ms += milliseconds_since(begin);
}

void Simulation::State::cap_speeds() {
  const float cap = settings.life.max_speed_m_s;
  if (cap <= 0) return;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks.velocity.size(), 1024), [&](const auto& range) {
    for (std::size_t v = range.begin(); v < range.end(); ++v) {
      for (int l = 0; l < kLanes; ++l) {
        const Vec u = load(blocks.velocity[v], l);
        const float sq = dot(u, u);
        if (sq > cap * cap) store(blocks.velocity[v], l, (cap / std::sqrt(sq)) * u);
      }
    }
  });
}

void Simulation::State::fall_asleep() {
  const float limit = settings.life.sleep_m_s * settings.life.sleep_m_s;
  for (std::size_t b = 0; b < awake.size(); ++b) {
    if (awake[b] == 0) continue;
    still_s[b] = fastest[b] < limit ? still_s[b] + step.step_s : 0.0F;
    if (still_s[b] < settings.life.sleep_after_s) continue;
    awake[b] = 0;
    fastest[b] = still_s[b] = 0;
    // Impulses stay: they are what holds the hair against gravity, and let it wake where it fell asleep.
    std::fill(blocks.velocity.begin() + blocks.first[b], blocks.velocity.begin() + blocks.first[b + 1], Lanes3{});
  }
}

void Simulation::State::advance_step(const RigidPose& next) {
  time_s += settings.life.step_s;
  ++facts.steps;
  if (move_head(next)) wake_all();
  if (colliders_move()) wake_touched();
  if (std::find(awake.begin(), awake.end(), std::uint8_t{1}) == awake.end()) return;
  facts.moved = true;
  step_chain();
  note_speeds();
  step_grid();
  cap_speeds();
  if (may_sleep()) fall_asleep();
}

/// Sleeping blocks that a moving surface has come to.
void Simulation::State::wake_touched() {
  for (std::size_t b = 0; b < awake.size(); ++b) {
    for (std::uint32_t v = blocks.first[b]; awake[b] == 0 && v < blocks.first[b + 1]; ++v) {
      Lanes3 points;
      in_grid_frame(blocks.root[b], blocks.position[v], points);
      Nearest near;
      colliders.nearest(points, settings.collision.margin_m, near);
      for (int l = 0; l < kLanes; ++l) {
        const Vec moved = load(near.displacement, l);
        if (near.distance.v[l] < clearance[v].v[l] && dot(moved, moved) > 0) awake[b] = 1;
      }
    }
  }
}

void Simulation::State::note_speeds() {
  float vertex = 0, root = 0;
  for (std::size_t b = 0; b < blocks.count(); ++b) {
    if (awake[b] == 0) continue;
    vertex = std::max(vertex, fastest[b]);
    for (int l = 0; l < kLanes; ++l) {
      const Vec v = load(blocks.velocity[blocks.first[b]], l);
      root = std::max(root, dot(v, v));
    }
  }
  facts.fastest_m_s = std::max(facts.fastest_m_s, std::sqrt(vertex));
  facts.fastest_root_m_s = std::max(facts.fastest_root_m_s, std::sqrt(root));
}

/// Roots where the frame has put the head.
void Simulation::State::show() {
  const glm::mat3 turn(glm::mat3_cast(shown.rotation));
  const Matrix m = rows_of(turn);
  for (std::size_t b = 0; b < blocks.count(); ++b)
    for (int l = 0; l < kLanes; ++l) store(blocks.root[b], l, m * load(blocks.root_rest[b], l));
}

void Simulation::State::look_for_explosions() const {
  const float limit = settings.life.explosion_m_s;
  for (std::size_t v = 0; v < blocks.velocity.size(); ++v) {
    for (int l = 0; l < kLanes; ++l) {
      const Vec u = load(blocks.velocity[v], l), p = load(blocks.position[v], l);
      const float speed = std::sqrt(dot(u, u));
      if (speed <= limit && std::isfinite(p.x + p.y + p.z)) continue;
      const auto block = static_cast<std::size_t>(std::upper_bound(blocks.first.begin(), blocks.first.end(), v) -
                                                  blocks.first.begin() - 1);
      const std::uint32_t strand = blocks.strand_of[block * kLanes + static_cast<std::size_t>(l)];
      const std::size_t vertex = v - blocks.first[block];
      if (strand == StrandBlocks::kNoStrand || static_cast<float>(vertex) >= blocks.vertices[block].v[l]) continue;
      throw SimulationError(strand, vertex, facts.frames,
                            std::isfinite(speed)
                                ? "moves at " + std::to_string(speed) + " m/s, the limit is " + std::to_string(limit) +
                                      ": take a shorter step, more damping or slower motion"
                                : "is not finite: take a shorter step or more damping");
    }
  }
}

Simulation::Simulation(const Strands& lines, const Mesh& head, const SimulationSettings& settings) {
  check(settings);
  state_ = std::make_unique<State>(lines, head, settings);
}
Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;

const glm::dvec3& Simulation::pivot() const noexcept {
  return state_->pivot;
}
const SimulationFacts& Simulation::facts() const noexcept {
  return state_->facts;
}
const StrandBlocks& Simulation::blocks() const noexcept {
  return state_->blocks;
}

void Simulation::advance(double frame_s, const RigidPose& head) {
  if (!(frame_s >= 0 && std::isfinite(frame_s)))
    throw UsageError("a frame of " + std::to_string(frame_s) + " s: give a time of 0 or more");
  if (!finite(head)) throw UsageError("the head's pose is not finite");
  State& s = *state_;
  const double h = s.settings.life.step_s;
  const double left = std::min(s.left_s + frame_s, std::max(s.settings.life.catch_up_s, h));
  s.facts.dropped_s += s.left_s + frame_s - left;
  s.facts.fastest_m_s = s.facts.fastest_root_m_s = 0;
  ++s.facts.frames;
  const RigidPose shown{head.position, glm::normalize(head.rotation)};
  s.facts.moved = shown.position != s.shown.position || shown.rotation != s.shown.rotation;
  s.shown = shown;
  const auto steps = static_cast<int>(left / h + kRound);
  for (int k = 0; k < steps; ++k) s.advance_step(between(s.pose, s.shown, h / (left - k * h) + kRound));
  s.left_s = std::max(left - steps * h, 0.0);
  s.facts.asleep = 0;
  for (std::size_t k = 0; k < s.blocks.strand_of.size(); ++k)
    if (s.blocks.strand_of[k] != StrandBlocks::kNoStrand && s.awake[k / kLanes] == 0) ++s.facts.asleep;
  s.facts.bytes = s.bytes();
  s.facts.grid_bytes = s.grid.bytes();
  s.show();
  s.look_for_explosions();
}

void Simulation::teleport(const RigidPose& head) {
  if (!finite(head)) throw UsageError("the head's pose is not finite");
  State& s = *state_;
  const RigidPose to{head.position, glm::normalize(head.rotation)};
  const Matrix turn = rows_of(glm::mat3(glm::mat3_cast(to.rotation * glm::conjugate(s.pose.rotation))));
  for (std::vector<Lanes3>* const all : {&s.blocks.position, &s.blocks.velocity, &s.blocks.impulse})
    for (Lanes3& lanes : *all)
      for (int l = 0; l < kLanes; ++l) store(lanes, l, turn * load(lanes, l));
  s.pose = s.shown = to;
  s.wake_all();
  s.show();
}

void Simulation::reset() {
  State& s = *state_;
  s.pose = s.shown;
  const Matrix turn = rows_of(glm::mat3(glm::mat3_cast(s.pose.rotation)));
  for (std::size_t v = 0; v < s.blocks.rest.size(); ++v)
    for (int l = 0; l < kLanes; ++l) store(s.blocks.position[v], l, turn * load(s.blocks.rest[v], l));
  std::fill(s.blocks.velocity.begin(), s.blocks.velocity.end(), Lanes3{});
  std::fill(s.blocks.impulse.begin(), s.blocks.impulse.end(), Lanes3{});
  s.left_s = 0;
  s.wake_all();
  s.show();
}

void Simulation::set_time(double time_s) noexcept {
  state_->time_s = time_s;
  state_->wake_all();
}

void Simulation::positions(Strands& out) const {
  world_positions(state_->blocks, state_->shown.position, out);
}

std::uint64_t Simulation::state_hash() const {
  const State& s = *state_;
  const StrandBlocks& blocks = s.blocks;
  Hash hash;
  for (std::size_t strand = 0; strand < blocks.strands; ++strand) {
    const std::size_t block = blocks.block_of[strand] / kLanes;
    const auto lane = static_cast<int>(blocks.block_of[strand] % kLanes);
    for (std::uint32_t v = blocks.first[block]; v < blocks.first[block + 1]; ++v)
      for (const Vec& u :
           {load(blocks.position[v], lane), load(blocks.velocity[v], lane), load(blocks.impulse[v], lane)})
        for (const float x : {u.x, u.y, u.z}) hash.add(x);
    hash.add(s.awake[block] != 0 ? 1.0F : 0.0F);
    hash.add(s.still_s[block]);
  }
  const glm::dquat& q = s.pose.rotation;
  const glm::dvec3& p = s.pose.position;
  for (const double x : {p.x, p.y, p.z, q.w, q.x, q.y, q.z, s.left_s, s.time_s}) hash.add(x);
  return hash.value;
}

}  // namespace pelage
