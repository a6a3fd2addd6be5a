// Where and of what something was measured: what every report says.
#pragma once

#include <string>

#include "pelage/data_schema/scene.h"

namespace pelage::app {

/// The processor's name, or "unknown".
std::string cpu_name();

/// 16 hex digits of a resolved scene and of the bytes of the files that it names, and of how it is looked at.
/// @throws InputError for a file that cannot be read
std::string scene_hash(const Scene& scene, bool quick);

}  // namespace pelage::app
