// Figures of what the paper's effects do, each with its error against the ray-traced truth.
#pragma once

#include "pelage/data_schema/scene.h"
#include "pelage/image/image.h"

namespace pelage::app {

/// [Xu2006 Fig. 4]: Scheuermann's shading alone, ours without secondary highlight, without self-shadow, with all;
/// truth.
Image ablations_figure(Scene scene);
/// [Xu2006 Fig. 5]: Scheuermann's shading alone, ours, truth, of hair on a head.
Image head_figure(Scene scene);

}  // namespace pelage::app
