// Single values of a scene by their place: "shadow.density_map.resolution=64". What `--set` takes, what knobs (knob.h)
// are made of, and how two scenes differ. Places are keys of schemas/scene.schema.json joined by points; elements of a
// list are counted from 0 ("lights.0.intensity=2"). A value is JSON or, where it is not, a word.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "pelage/data_schema/scene.h"

namespace pelage {

/// The scene with those values, the last of one place winning. @throws UsageError naming the place, what is wrong and
/// the nearest place that there is
Scene with_values(const Scene& scene, std::span<const std::string> values);

/// What must be set in `from` to make it `to`, in the order of the schema; lists of different length as a whole.
std::vector<std::string> changed_values(const Scene& from, const Scene& to);

}  // namespace pelage
