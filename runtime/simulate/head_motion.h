// Motions of the head: built-in shakes, nods, turns, a jump, a dance-like sequence, or keyframes.
#pragma once

#include "pelage/data_schema/simulation_settings.h"
#include "pelage/simulate/rigid_pose.h"

namespace pelage {

/// Pose at a time >= 0. Continuous, with continuous velocity but for the jump; at time 0 the head is at rest.
/// @param pivot  of the head at rest     @throws UsageError for keys that do not increase in time
RigidPose head_pose(const MotionSettings& motion, const glm::dvec3& pivot, double time_s);

/// Length of the motion [s]; one that repeats has that of its period.
double motion_length_s(const MotionSettings& motion);

}  // namespace pelage
