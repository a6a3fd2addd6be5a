// Figures of what `pelage simulate` does.
#pragma once

#include "pelage/data_schema/scene.h"
#include "pelage/image/image.h"

namespace pelage::app {

/// Frames of a dance, a groom holding its shape.
Image motion_figure(Scene scene);
/// One moment of a shake under each preset.
Image presets_figure(Scene scene);

}  // namespace pelage::app
