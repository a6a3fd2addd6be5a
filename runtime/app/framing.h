// The camera of a scene that names none: on its hair and head, the same for every method, so that pictures can be laid
// over each other.
#pragma once

#include <vector>

#include "pelage/app/drawing.h"
#include "pelage/data_schema/mesh.h"
#include "pelage/data_schema/scene.h"
#include "pelage/data_schema/simulation_settings.h"
#include "pelage/data_schema/strands.h"

namespace pelage::app {

/// Returns the width of a picture over its height.
float aspect_of(const ImageSettings& image) noexcept;

/// Returns the scene's camera, or one that frames this hair and head in the scene's picture.
Camera camera_of(const Scene& scene, const Strands& hair, const Mesh& head);

/// Returns the same for what a drawing of the scene shows. SATF holds clusters: its hair is read as it is for the
/// others.
Camera camera_of(const Scene& scene, const Drawing& drawing);

/// Returns points of hair and head as they would be carried along, rigid, over `seconds` of a motion [metres]: enough
/// to frame by, not all of them.
std::vector<glm::vec3> carried_points(const Strands& hair, const Mesh& head, const MotionSettings& motion,
                                      const glm::dvec3& pivot, double seconds);

}  // namespace pelage::app
