// Settings of the strand simulation (DESIGN section 7). Plain values of a scene file (schemas/scene.schema.json). A
// rate of 0 switches its effect off: no call, no memory. All rates are per second, whatever the internal step.
#pragma once

#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

namespace pelage {

/// Follow-the-leader with eq. 3.1; equal masses relaxed over and over; all segments of a strand at once [Han2013].
enum class ChainSolver { dftl, position_based, tridiagonal };

struct ChainSettings {
  ChainSolver solver = ChainSolver::dftl;
  int iterations = 10;              // of position_based and tridiagonal, [1, 1000]
  float ftl_correction = 1.0F;      // s of eq. 3.1, [0.6, 1]; below 1 the scheme does not converge
  glm::vec3 gravity{0, -9.81F, 0};  // m/s^2
  float damping_per_s = 6;          // of the kinematic velocity, [0, 1000]
  bool operator==(const ChainSettings&) const = default;
};

/// gradient: down the gradient of density [C eq. 3.5, bounded]; overfull: away from the centre of cells that hold more
/// than `overfull` times the groom's own density [A section 4.1].
enum class RepulsionKind { gradient, overfull };

struct InteractionSettings {
  float cell_m = 0.01F;      // side of a voxel, [0.001, 0.1]
  float friction_per_s = 4;  // rate at which a vertex takes on the velocity around it [C eq. 3.4], [0, 1000]
  float repulsion_m_s2 = 1;  // greatest acceleration of repulsion, [0, 100]
  RepulsionKind repulsion = RepulsionKind::gradient;
  float overfull = 2;  // times the median density of the groom at rest, [0, 1000]
  bool operator==(const InteractionSettings&) const = default;
};

struct WindSettings {
  glm::vec3 velocity_m_s{0};  // mean wind; zero: none
  float gust = 0.5F;          // share of the mean by which it rises and falls, [0, 4]
  float gust_s = 1.5F;        // time between gusts, (0, 100]
  float gust_m = 0.3F;        // distance between gusts, (0, 100]
  float drag_per_s = 3;       // rate at which a free vertex takes on the wind's velocity, [0, 1000]
  float shelter = 1;          // 0: wind blows through; otherwise drag falls as exp(-shelter x density / rest density)
  bool operator==(const WindSettings&) const = default;
};

/// Helix around the simulated centre line, a rest shape [C section 3.1.2].
struct CurlSettings {
  float radius_m = 0;          // 0: no curl; [0, 0.1]
  float pitch_m = 0.03F;       // length of centre line per turn at the root, [0.001, 1]
  float frequency_growth = 0;  // turns per length at the tip are (1 + this) times those at the root, [0, 10]
  float start = 0.15F;         // share of the strand over which the radius grows from 0 at the root, [0, 1]
  float phase_spread = 0.15F;  // phases of neighbours differ by up to this many turns, [0, 1]
  int subdivision = 4;         // drawn segments per simulated one, [1, 64]
  bool operator==(const CurlSettings&) const = default;
};

struct ShapeSettings {
  float hold_rad_s = 0;   // omega of the pull back to the groom's own shape at the root; 0: none; [0, 1000]
  float hold_tip = 0.5F;  // omega at the tip as a share of that, [0, 1]
  bool sag_free = false;  // the groom's own shape bears gravity already: upright and at rest nothing sags
  float cone_deg = 0;     // a segment at the root bends by at most this; 0: no limit; [0, 90]
  float cone_end = 0.4F;  // share of the strand after which the limit has grown to 90 degrees and is gone, (0, 1]
  CurlSettings curl;
  bool operator==(const ShapeSettings&) const = default;
};

/// A sphere where both ends coincide.
struct ColliderCapsule {
  glm::vec3 from{0}, to{0};   // metres, at time 0
  float radius_m = 0.05F;     // [0, 10]
  glm::vec3 velocity_m_s{0};  // of one that does not move with the head
  bool with_head = false;
  bool operator==(const ColliderCapsule&) const = default;
};

struct CollisionSettings {
  bool head = true;             // with the scene's head, where it has one
  float margin_m = 0.002F;      // kept between hair and surfaces, [0, 0.1]
  float friction = 0.3F;        // Coulomb's coefficient, [0, 10]
  float field_cell_m = 0.005F;  // of a mesh's distance field, [0.0005, 0.1]
  std::vector<ColliderCapsule> capsules;
  bool operator==(const CollisionSettings&) const = default;
};

/// none; shake: turning left and right; nod; turn: half a turn and back; jump: 0.3 m aside at once; dance: a
/// dance-like sequence of all of them; keyframes: those given.
enum class MotionKind { none, shake, nod, turn, jump, dance, keyframes };

/// Pose of the head relative to its rest at a time.
struct MotionKey {
  double time_s = 0;
  glm::vec3 position_m{0};
  glm::vec3 turn_deg{0};  // about x (nod), then y (turn), then z (tilt)
  bool operator==(const MotionKey&) const = default;
};

struct MotionSettings {
  MotionKind kind = MotionKind::shake;
  float amplitude = 1;          // times the built-in's own, [0, 10]
  float speed = 1;              // times the built-in's own, [0.01, 100]
  std::vector<MotionKey> keys;  // by time; between them a smooth curve, before and after them at rest
  bool operator==(const MotionSettings&) const = default;
};

struct LifeSettings {
  double step_s = 1.0 / 240;   // internal step, [1/2000, 1/60]
  double catch_up_s = 0.25;    // longest time simulated for one frame; what is beyond is dropped, (0, 100]
  double settle_s = 1;         // simulated before a sequence's first frame, [0, 100]
  float max_speed_m_s = 0;     // cap of the kinematic velocity; 0: none
  float explosion_m_s = 300;   // faster than this is an error, > 0
  float sleep_m_s = 0.002F;    // a strand slower than this for `sleep_after_s` sleeps; 0: never
  float sleep_after_s = 0.5F;  // (0, 100]
  bool operator==(const LifeSettings&) const = default;
};

struct SimulationSettings {
  std::string name = "loose";  // of the preset that it began with
  int vertices = 24;           // of the longest strand's centre line, [2, 256]; shorter ones have fewer
  bool detail = true;          // what the centre line leaves out rides on it; off: the centre line is the hair
  int wisps = 0;               // 0: every strand is simulated; else guides: three for each wisp; [0, 100000]
  ChainSettings chain;
  InteractionSettings interaction;
  WindSettings wind;
  ShapeSettings shape;
  CollisionSettings collision;
  MotionSettings motion;
  LifeSettings life;
  bool operator==(const SimulationSettings&) const = default;
};

/// Named settings: loose, straight, wavy, curly, hold-shape, wet. @throws UsageError naming the nearest
SimulationSettings simulation_preset(const std::string& name);

}  // namespace pelage
