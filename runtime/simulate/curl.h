// Curls as a rest shape: a helix around each strand on rotation-minimising frames [Almeida2014 section 3.1.2, with
// Wang2008 in place of averaged normals].
#pragma once

#include <glm/ext/quaternion_double.hpp>

#include "pelage/data_schema/simulation_settings.h"
#include "pelage/data_schema/strands.h"

namespace pelage {

/// The strands with a helix around them, each segment cut into settings.subdivision. Roots stay. Nothing to do: a copy.
/// @param lines  centre lines, of any number of vertices   @param turn  of the head, so that phases turn with it
Strands curled(const Strands& lines, const CurlSettings& settings, const glm::dquat& turn);

}  // namespace pelage
