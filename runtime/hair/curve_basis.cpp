#include "pelage/hair/curve_basis.h"

#include <algorithm>
#include <glm/glm.hpp>

namespace pelage::hair {

CurveSpans divide(Basis basis, std::size_t control_points) noexcept {
  const std::size_t step = basis == Basis::bezier ? 3 : 1;
  const std::size_t spans = (control_points - 4) / step + 1;
  const std::size_t used = 4 + (spans - 1) * step;
  return {spans, step, used, 2 * used};
}

glm::vec4 evaluate(Basis basis, const CurveSpans& spans, std::span<const glm::vec4> control, std::size_t k) noexcept {
  const double x = spans.parameter(k);
  const std::size_t span = std::min(static_cast<std::size_t>(x), spans.spans - 1);
  const auto u = static_cast<float>(x - static_cast<double>(span));
  const float v = 1.0F - u;
  const glm::vec4* p = control.data() + span * spans.step;
  switch (basis) {
    case Basis::b_spline:
      return (v * v * v * p[0] + (3.0F * u * u * u - 6.0F * u * u + 4.0F) * p[1] +
              (3.0F * v * v * v - 6.0F * v * v + 4.0F) * p[2] + u * u * u * p[3]) /
             6.0F;
    case Basis::catmull_rom:
      return 0.5F * (-u * v * v * p[0] + (3.0F * u * u * u - 5.0F * u * u + 2.0F) * p[1] +
                     (3.0F * v * v * v - 5.0F * v * v + 2.0F) * p[2] - u * u * v * p[3]);
    case Basis::bezier:
      break;
  }
  return v * v * v * p[0] + 3.0F * u * v * v * p[1] + 3.0F * u * u * v * p[2] + u * u * u * p[3];
}

}  // namespace pelage::hair
