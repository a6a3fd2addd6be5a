// Hair in motion: from a groom to the strands that are drawn, frame after frame.
//   hair --centre_lines--> lines --wisps--> guides --Simulation--> guides --wisps--> lines --detail--> hair --curls-->
// What the settings do not call for is left out: without wisps every line is simulated, without detail the lines are
// the hair, without a radius there are no curls.
#pragma once

#include <functional>
#include <optional>

#include "pelage/data_schema/mesh.h"
#include "pelage/data_schema/simulation_settings.h"
#include "pelage/simulate/centre_lines.h"
#include "pelage/simulate/curl.h"
#include "pelage/simulate/simulation.h"
#include "pelage/simulate/wisps.h"

namespace pelage {

class MovingHair {
 public:
  /// @param head  at rest; may be empty    @throws what Simulation, Wisps, Curls throw
  MovingHair(const Strands& hair, const Mesh& head, const SimulationSettings& settings);

  /// @throws SimulationError
  void advance(double frame_s, const RigidPose& head);
  void teleport(const RigidPose& head);
  void reset();
  /// The groom at rest in this pose at time -settle_s, then simulated until time 0: hair as it hangs before anything
  /// moves.  @param told  now and then; may throw to interrupt
  void begin(const RigidPose& head, double settle_s, const std::function<void()>& told = {});

  /// Has anything changed since hair() was called last? Where all sleeps and the head rests, nothing has.
  bool moved() const noexcept { return moved_; }
  /// The hair as it is drawn now; diameters and colours are the groom's. Made anew only if it moved.
  const Strands& hair();
  /// Centre lines of all strands now.
  const Strands& lines() noexcept { return lines_; }
  /// The head where it is now.
  Mesh head() const;
  const glm::dvec3& pivot() const noexcept { return simulation_->pivot(); }
  const RigidPose& pose() const noexcept { return pose_; }
  const Simulation& simulation() const noexcept { return *simulation_; }
  /// Of the last call of hair() [ms].
  double hair_ms() const noexcept { return hair_ms_; }

 private:
  glm::dquat turn() const noexcept { return pose_.rotation; }

  Mesh head_;
  Strands hair_, lines_, guides_;
  std::optional<Wisps> wisps_;
  std::optional<StrandDetail> detail_;
  std::optional<Curls> curls_;
  Strands curled_;
  std::optional<Simulation> simulation_;
  RigidPose pose_;
  double hair_ms_ = 0;
  bool moved_ = true;
};

}  // namespace pelage
