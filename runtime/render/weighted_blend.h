// Weighted blended order-independent transparency [McGuireBavoil2013]: one pass and no lists. Opacity is exact; the
// colour of a pixel is a mean of its fragments, weighted by opacity and by exp(-depth behind the nearest hair /
// kWeightDepth_m), which stands for the order.
// Its error against the exact order is in strand_frame.h.
#pragma once

#include <functional>

#include "pelage/render/gl_objects.h"

namespace pelage {

class WeightedBlend {
 public:
  /// Defines of a program whose fragment shader ends in common_output.glsl's put_fragment().
  static constexpr const char* kDefine = "#define PELAGE_WEIGHTED";
  /// The best of .5 mm to 10 cm on three grooms, by little.
  static constexpr float kWeightDepth_m = 0.012F;

  WeightedBlend();
  ~WeightedBlend();
  WeightedBlend(const WeightedBlend&) = delete;
  WeightedBlend& operator=(const WeightedBlend&) = delete;

  /// Blends what `draw` draws over the target, with its depth test. `draw` uses a program made with kDefine and calls
  /// bind() for it.
  void blend(Framebuffer& target, const std::function<void()>& draw);
  /// @param nearest_m  depth of the nearest hair
  static void bind(const Program& program, float nearest_m);

 private:
  void fit(const Framebuffer& target);

  Program resolve_{"screen.vert", "weighted_resolve.frag"};
  VertexArray array_;
  GLuint framebuffer_ = 0, textures_[2] = {0, 0};
  int width_ = 0, height_ = 0;
};

}  // namespace pelage
