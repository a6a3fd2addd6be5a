// Planar ray trace of one sector, the fast way: the model of bake/planar_reference.h in float32. The weights of a ray's
// steps do not depend on the light, so each (view, ray) is marched once and all lights are shaded with SIMD; density
// and gradient are prepared once per sector and sampled together; the view is reflected once per step. Agrees with the
// reference to 1e-3 (measured: tests/bake). The same bits on every CPU: no contraction, no reduction over SIMD lanes,
// own exponential and power.
#pragma once

#include <span>
#include <vector>

#include "pelage/data_schema/bake_settings.h"
#include "pelage/data_schema/hrir_record.h"
#include "pelage/db/density_grid.h"
#include "pelage/db/record_source.h"

namespace pelage {

/// Density and its gradient at the nodes of a sector, ready for bilinear sampling.
class PlanarField {
 public:
  struct alignas(16) Node {
    float rho, gradient_s, gradient_r, unused;
  };

  PlanarField() = default;
  explicit PlanarField(const DensityGrid& grid) { assign(grid); }
  void assign(const DensityGrid& grid);

  int size() const noexcept { return size_; }
  bool empty() const noexcept { return empty_; }  ///< no density anywhere
  const Node* nodes() const noexcept { return nodes_.data(); }

 private:
  int size_ = 0;
  bool empty_ = true;
  std::vector<Node>
      nodes_;  // [size + 2][size + 1]: one extrapolated row below and above, first column again at the end
  std::vector<float> rows_;  // scratch: [size + 4][size] densities with two extrapolated rows on either side
};

/// Traces sectors with fixed settings. Immutable after construction: one tracer serves all threads.
class PlanarTracer {
 public:
  explicit PlanarTracer(const BakeSettings& settings);

  const BakeSettings& settings() const noexcept { return settings_; }
  HrirRecord trace_record(const DensityGrid& grid) const;

  /// One view and one light angle per ray, linear along s [db/record_source.h], samples() values each. `re` may be
  /// empty. At angles of the table equal to the record's rows.
  void trace_rays(const PlanarField& field, const SatfAngles& angles, std::span<float> tau,
                  std::span<float> re) const noexcept;

 private:
  struct Tap {
    int offset;  // samples to the right, [0, samples)
    float weight;
  };

  void smooth(std::span<const float> in, std::span<float> out) const noexcept;
  float straight(float premultiplied, float opacity) const noexcept;

  BakeSettings settings_;
  std::vector<Tap> taps_;                 // periodic Gaussian along s, sum 1
  std::vector<float> light_s_, light_r_;  // [lights padded] unit vectors towards the lights
  float diffuse_ = 0, specular_ = 0;      // divided by mean_phong
  int squarings_ = -1;                    // exponent 2^n, or -1: any other
};

}  // namespace pelage
