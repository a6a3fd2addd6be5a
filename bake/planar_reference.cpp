#include "pelage/bake/planar_reference.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <vector>

namespace pelage {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;

int wrap(int i, int n) {
  i %= n;
  return i < 0 ? i + n : i;
}

/// Density at a node, 0 <= s < size; rows outside the grid continue linearly.
double node(const DensityGrid& grid, int r, int s) {
  const int last = grid.size - 1;
  if (r < 0) return std::max(0.0, grid.at(0, s) + r * (grid.at(1, s) - grid.at(0, s)));
  if (r > last) return std::max(0.0, grid.at(last, s) + (r - last) * (grid.at(last, s) - grid.at(last - 1, s)));
  return grid.at(r, s);
}

double density(const DensityGrid& grid, double s, double r) {
  const double x = s * grid.size - 0.5, y = r * grid.size - 0.5;
  const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
  const double a = x - i, b = y - j;
  const int i0 = wrap(i, grid.size), i1 = i0 + 1 == grid.size ? 0 : i0 + 1;
  return (1 - b) * ((1 - a) * node(grid, j, i0) + a * node(grid, j, i1)) +
         b * ((1 - a) * node(grid, j + 1, i0) + a * node(grid, j + 1, i1));
}

glm::dvec2 gradient(const DensityGrid& grid, double s, double r) {
  const double h = 1.0 / grid.size;
  return {(density(grid, s + h, r) - density(grid, s - h, r)) / (2 * h),
          (density(grid, s, r + h) - density(grid, s, r - h)) / (2 * h)};
}

glm::dvec2 direction(double angle_rad) {
  return {std::sin(angle_rad), std::cos(angle_rad)};
}

/// Circular convolution with a Gaussian sampled at the ray spacing, images of the period summed, normalised to sum 1.
std::vector<double> smooth(const std::vector<double>& in, double sigma) {
  if (sigma <= 0) return in;
  const int n = static_cast<int>(in.size());
  std::vector<double> kernel(in.size());
  double total = 0;
  for (int d = 0; d < n; ++d)
    for (int period = -4; period <= 4; ++period) {
      const double x = static_cast<double>(d) / n + period;
      const double g = std::exp(-0.5 * x * x / (sigma * sigma));
      kernel[static_cast<std::size_t>(d)] += g;
      total += g;
    }
  std::vector<double> out(in.size());
  for (int i = 0; i < n; ++i)
    for (int d = 0; d < n; ++d)
      out[static_cast<std::size_t>(i)] +=
          kernel[static_cast<std::size_t>(d)] / total * in[static_cast<std::size_t>(wrap(i + d, n))];
  return out;
}

}  // namespace

double mean_phong(const PlanarPhong& phong) {
  const double p = phong.exponent;
  const double lobe = std::exp(std::lgamma((p + 1) / 2) - std::lgamma(p / 2 + 1)) / (2 * std::sqrt(std::numbers::pi));
  return phong.diffuse / std::numbers::pi + phong.specular * lobe;
}

double PlanarShading::reflectance(double rho, glm::dvec2 gradient, glm::dvec2 view, glm::dvec2 light) const {
  const double length = glm::length(gradient);
  if (length == 0) return 1;
  glm::dvec2 normal = -gradient / length;
  normal -= 2 * std::min(0.0, glm::dot(normal, view)) * view;
  const glm::dvec2 reflected = 2 * glm::dot(normal, view) * normal - view;
  const double phong = phong_.diffuse * std::max(0.0, glm::dot(normal, light)) +
                       phong_.specular * std::pow(std::max(0.0, glm::dot(reflected, light)), phong_.exponent);
  const double flat = flat_ * rho;
  const double share = length * length / (length * length + flat * flat);
  return share * phong / mean_ + (1 - share);
}

RayTrace trace_ray_reference(const DensityGrid& grid, const BakeSettings& settings, const PlanarShading& shading,
                             double view_rad, double light_rad, double s) {
  glm::dvec2 view = direction(view_rad);
  if (std::abs(view.y) < kGrazingCosine) view.y = 0;
  const glm::dvec2 light = direction(light_rad);
  const double length = view.y == 0 ? settings.max_path : std::min(1 / std::abs(view.y), settings.max_path);
  const int steps = static_cast<int>(std::ceil(length * 2 * grid.size - kStepSlack));
  const double step = length / steps;
  const double entry = view.y >= 0 ? 1 : 0;
  // From the viewer into the sector: against the view direction when it enters from outside; a viewer below looks up.
  const glm::dvec2 forward = -view;
  RayTrace ray;
  for (int k = 0; k < steps; ++k) {
    const double x = s + forward.x * (k + 0.5) * step;
    const double y = entry + forward.y * (k + 0.5) * step;
    const double rho = density(grid, x, y);
    const double dtau = settings.reference_scale * rho * step;
    ray.tau += dtau;
    if (ray.opacity >= settings.early_stop) continue;
    const double weight = (1 - ray.opacity) * -std::expm1(-dtau);
    ray.opacity += weight;
    ray.premultiplied += weight * shading.reflectance(rho, gradient(grid, x, y), view, light);
  }
  return ray;
}

HrirRecord trace_record_reference(const DensityGrid& grid, const BakeSettings& settings) {
  HrirRecord record{{settings.views, settings.lights, settings.samples}, {}, {}};
  record.tau.reserve(record.shape.tau_size());
  record.re.reserve(record.shape.re_size());
  const auto samples = static_cast<std::size_t>(settings.samples);
  const double sigma = settings.sigma * settings.smoothing;
  const PlanarShading shading(settings);
  for (int v = 0; v < settings.views; ++v)
    for (int l = 0; l < settings.lights; ++l) {
      std::vector<double> tau(samples), opacity(samples), premultiplied(samples);
      for (std::size_t x = 0; x < samples; ++x) {
        const double s = (static_cast<double>(x) + 0.5) / static_cast<double>(samples);
        const RayTrace ray =
            trace_ray_reference(grid, settings, shading, kTwoPi * v / settings.views, kTwoPi * l / settings.lights, s);
        tau[x] = ray.tau, opacity[x] = ray.opacity, premultiplied[x] = ray.premultiplied;
      }
      tau = smooth(tau, sigma), opacity = smooth(opacity, sigma), premultiplied = smooth(premultiplied, sigma);
      for (std::size_t x = 0; x < samples; ++x) {
        if (l == 0) record.tau.push_back(static_cast<float>(tau[x]));
        record.re.push_back(static_cast<float>((premultiplied[x] + kEmptyOpacity) / (opacity[x] + kEmptyOpacity)));
      }
    }
  return record;
}

}  // namespace pelage
