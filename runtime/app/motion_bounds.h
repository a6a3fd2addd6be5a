// What a camera has to frame while a head moves.
#pragma once

#include "pelage/data_schema/mesh.h"
#include "pelage/data_schema/simulation_settings.h"
#include "pelage/data_schema/strands.h"
#include "pelage/render/camera.h"

namespace pelage::app {

/// Of hair and head as they would be carried along, rigid, over `seconds` of the motion.
Bounds motion_bounds(const Strands& lines, const Mesh& head, const MotionSettings& motion, const glm::dvec3& pivot,
                     double seconds);

}  // namespace pelage::app
