// Motions of the head: built-in shakes, nods, turns, a jump, a dance-like sequence, which repeat, or keyframes.
//
// Keyframes pass through every key with continuous velocity: cubic pieces with slopes that do not overshoot
// [Fritsch1984] in space, and the like for rotations [Kim1995: cumulative Bernstein basis], always the shorter way
// round. Where the first key is later than 0, the head's rest at time 0 is a key too. The built-in motions have the
// same bits on every CPU; keyframes use the C library's trigonometry.
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
