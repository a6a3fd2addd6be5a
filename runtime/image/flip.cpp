#include "pelage/image/flip.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>
#include <numbers>
#include <utility>

#include "pelage/data_schema/errors.h"
#include "pelage/image/draw.h"
#include "pelage/image/picture_error.h"
#include "pelage/image/tone.h"

namespace pelage {
namespace {

constexpr double kPi = std::numbers::pi;

// [Andersson2020]: section 4.1.2 (qc), 4.1.3 (pc, pt), 4.2 (qf, and the width of a feature's detector in degrees).
constexpr double kColourPower = 0.7, kBend = 0.4, kBendTo = 0.95, kFeaturePower = 0.5, kFeatureWidth_deg = 0.082;

/// Contrast sensitivity as a sum of two Gaussians of the distance in degrees, a sqrt(pi / b) exp(-pi^2 d^2 / b)
/// [Andersson2020 table 1, after Johnson & Fairchild 2003]: achromatic, red-green, blue-yellow.
struct Sensitivity {
  double a1, b1, a2, b2;
};
constexpr std::array<Sensitivity, 3> kSensitivity{
    {{1, 0.0047, 0, 1e-5}, {1, 0.0053, 0, 1e-5}, {34.1, 0.04, 13.5, 0.025}}};

/// Linear RGB to XYZ: sRGB's primaries (IEC 61966-2-1) and D65 at x = .31271, y = .32902. Columns.
constexpr glm::dmat3 kXyz{{10135552.0 / 24577794, 2613072.0 / 12288897, 1425312.0 / 73733382},
                          {8788810.0 / 24577794, 8788810.0 / 12288897, 8788810.0 / 73733382},
                          {4435075.0 / 24577794, 887015.0 / 12288897, 70074185.0 / 73733382}};

glm::dvec3 white() {
  return kXyz * glm::dvec3(1);
}

/// YCxCz: L*a*b* without the cube root (Flohr et al. 1993).
glm::dvec3 opponent(const glm::dvec3& rgb) {
  const glm::dvec3 n = kXyz * rgb / white();
  return {116 * n.y - 16, 500 * (n.x - n.y), 200 * (n.y - n.z)};
}

glm::dvec3 rgb_of(const glm::dvec3& ycc) {
  static const glm::dmat3 inverse = glm::inverse(kXyz);
  const double y = (ycc.x + 16) / 116;
  return inverse * (glm::dvec3(ycc.y / 500 + y, y, y - ycc.z / 200) * white());
}

/// CIE L*a*b* with a* and b* scaled by 0.01 L*.
glm::dvec3 hunt_lab(const glm::dvec3& rgb) {
  constexpr double kDelta = 6.0 / 29;
  const glm::dvec3 n = kXyz * rgb / white();
  glm::dvec3 f;
  for (int c = 0; c < 3; ++c)
    f[c] = n[c] > kDelta * kDelta * kDelta ? std::cbrt(n[c]) : n[c] / (3 * kDelta * kDelta) + 4.0 / 29;
  const double lightness = 116 * f.y - 16;
  return {lightness, 0.01 * lightness * 500 * (f.x - f.y), 0.01 * lightness * 200 * (f.y - f.z)};
}

/// City block in lightness, Euclidean in colour.
double hyab(const glm::dvec3& a, const glm::dvec3& b) {
  return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z);
}

/// The greatest distance in RGB's cube is green to blue: 41.276.
double greatest_colour_error() {
  static const double most = std::pow(hyab(hunt_lab({0, 1, 0}), hunt_lab({0, 0, 1})), kColourPower);
  return most;
}

double colour_error(const glm::dvec3& a, const glm::dvec3& b) {
  const double error = std::pow(hyab(a, b), kColourPower), most = greatest_colour_error(), bend = kBend * most;
  if (error < bend) return kBendTo / bend * error;
  return kBendTo + (error - bend) / (most - bend) * (1 - kBendTo);
}

/// [y][x]. Not float: a feature's rounding is taken to the power qf = .5.
using Plane = std::vector<double>;
using Kernel = std::vector<double>;

struct Size {
  int width, height;
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
  std::size_t count() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
};

/// Along x, or along y.
Plane convolve(const Plane& in, Size size, const Kernel& kernel, bool along_x) {
  const int radius = static_cast<int>(kernel.size() / 2);
  Plane out(in.size());
  tbb::parallel_for(0, size.height, [&](int y) {
    for (int x = 0; x < size.width; ++x) {
      double sum = 0;
      for (int i = -radius; i <= radius; ++i) {
        const int u = along_x ? std::clamp(x + i, 0, size.width - 1) : x;
        const int v = along_x ? y : std::clamp(y + i, 0, size.height - 1);
        sum += kernel[static_cast<std::size_t>(i + radius)] * in[size.at(u, v)];
      }
      out[size.at(x, y)] = sum;
    }
  });
  return out;
}

Plane separable(const Plane& in, Size size, const Kernel& along_x, const Kernel& along_y) {
  return convolve(convolve(in, size, along_x, true), size, along_y, false);
}

template <class Function>
Kernel sampled(int radius, const Function& f) {
  Kernel kernel;
  for (int i = -radius; i <= radius; ++i) kernel.push_back(f(static_cast<double>(i)));
  return kernel;
}

double sum_of(const Kernel& kernel) {
  double sum = 0;
  for (const double v : kernel) sum += v;
  return sum;
}

/// A sum of two Gaussians over the plane, of weight 1 in all: each is the product of one along x and one along y.
class SensitivityFilter {
 public:
  SensitivityFilter(const Sensitivity& s, double pixels_per_degree, int radius) {
    for (const auto& [a, b] : {std::pair(s.a1, s.b1), std::pair(s.a2, s.b2)}) {
      if (a == 0) continue;
      parts_.push_back({a * std::sqrt(kPi / b), sampled(radius, [&](double x) {
                          return std::exp(-std::pow(kPi * x / pixels_per_degree, 2) / b);
                        })});
    }
    double all = 0;
    for (const Part& part : parts_) all += part.weight * sum_of(part.kernel) * sum_of(part.kernel);
    for (Part& part : parts_) part.weight /= all;
  }
  Plane apply(const Plane& in, Size size) const {
    Plane out(in.size());
    for (const Part& part : parts_) {
      const Plane smooth = separable(in, size, part.kernel, part.kernel);
      for (std::size_t i = 0; i < out.size(); ++i) out[i] += part.weight * smooth[i];
    }
    return out;
  }

 private:
  struct Part {
    double weight;
    Kernel kernel;
  };
  std::vector<Part> parts_;
};

/// Three standard deviations of the widest Gaussian, for all three filters.
int sensitivity_radius(double pixels_per_degree) {
  double widest = 0;
  for (const Sensitivity& s : kSensitivity) widest = std::max({widest, s.b1, s.b2});
  return static_cast<int>(std::ceil(3 * std::sqrt(widest / (2 * kPi * kPi)) * pixels_per_degree));
}

using Planes = std::array<Plane, 3>;

Planes opponent_planes(const Image& image, Size size) {
  Planes planes;
  for (Plane& plane : planes) plane.resize(size.count());
  tbb::parallel_for(std::size_t{0}, size.count(), [&](std::size_t i) {
    glm::dvec3 rgb;
    for (int c = 0; c < 3; ++c)
      rgb[c] = static_cast<double>(std::clamp(image.rgba[4 * i + static_cast<std::size_t>(c)], 0.0F, 1.0F));
    const glm::dvec3 ycc = opponent(rgb);
    for (int c = 0; c < 3; ++c) planes[static_cast<std::size_t>(c)][i] = ycc[c];
  });
  return planes;
}

std::vector<glm::dvec3> seen_colours(const Planes& planes, Size size, double pixels_per_degree) {
  const int radius = sensitivity_radius(pixels_per_degree);
  Planes seen;
  for (std::size_t c = 0; c < 3; ++c)
    seen[c] = SensitivityFilter(kSensitivity[c], pixels_per_degree, radius).apply(planes[c], size);
  std::vector<glm::dvec3> lab(size.count());
  tbb::parallel_for(std::size_t{0}, size.count(), [&](std::size_t i) {
    const glm::dvec3 rgb = rgb_of({seen[0][i], seen[1][i], seen[2][i]});
    lab[i] = hunt_lab(glm::clamp(rgb, 0.0, 1.0));
  });
  return lab;
}

/// Positive weights add up to 1, negative ones to -1.
void balance(Kernel& kernel) {
  double positive = 0, negative = 0;
  for (const double v : kernel) (v > 0 ? positive : negative) += v;
  for (double& v : kernel) v /= v > 0 ? positive : -negative;
}

struct Detector {
  Kernel across, along;  // a derivative of a Gaussian, and the Gaussian (of weight 1)
};

/// @param second  points, by the second derivative; else edges, by the first
Detector detector(double pixels_per_degree, bool second) {
  const double sd = 0.5 * kFeatureWidth_deg * pixels_per_degree;
  const int radius = static_cast<int>(std::ceil(3 * sd));
  const auto gauss = [&](double x) { return std::exp(-x * x / (2 * sd * sd)); };
  Detector d{sampled(radius, [&](double x) { return (second ? x * x / (sd * sd) - 1 : -x) * gauss(x); }),
             sampled(radius, gauss)};
  balance(d.across);
  const double sum = sum_of(d.along);
  for (double& v : d.along) v /= sum;
  return d;
}

/// Length of the detector's answers along x and y.
Plane feature(const Plane& luminance, Size size, const Detector& d) {
  Plane x = separable(luminance, size, d.across, d.along);
  const Plane y = separable(luminance, size, d.along, d.across);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = std::hypot(x[i], y[i]);
  return x;
}

/// Delta E_f of all pixels.
Plane feature_error(const Planes& a, const Planes& b, Size size, double pixels_per_degree) {
  Plane luminance_a(size.count()), luminance_b(size.count());
  for (std::size_t i = 0; i < size.count(); ++i) {
    luminance_a[i] = (a[0][i] + 16) / 116;
    luminance_b[i] = (b[0][i] + 16) / 116;
  }
  Plane most(size.count());
  for (const bool points : {false, true}) {
    const Detector d = detector(pixels_per_degree, points);
    const Plane in_a = feature(luminance_a, size, d), in_b = feature(luminance_b, size, d);
    for (std::size_t i = 0; i < most.size(); ++i) most[i] = std::max(most[i], std::abs(in_a[i] - in_b[i]));
  }
  for (double& v : most) v = std::pow(v / std::numbers::sqrt2, kFeaturePower);
  return most;
}

}  // namespace

std::vector<float> flip_map(const Image& a, const Image& b, double pixels_per_degree) {
  check_same_size(a, b);
  check_finite(a, "the picture");
  check_finite(b, "the truth");
  if (!(pixels_per_degree >= 1 && pixels_per_degree <= 1000))
    throw UsageError("FLIP is seen at 1 to 1000 pixels per degree");
  const Size size{a.width, a.height};
  const Planes planes_a = opponent_planes(a, size), planes_b = opponent_planes(b, size);
  const std::vector<glm::dvec3> colours_a = seen_colours(planes_a, size, pixels_per_degree);
  const std::vector<glm::dvec3> colours_b = seen_colours(planes_b, size, pixels_per_degree);
  const Plane features = feature_error(planes_a, planes_b, size, pixels_per_degree);
  std::vector<float> map(size.count());
  tbb::parallel_for(std::size_t{0}, map.size(), [&](std::size_t i) {
    const double colour = colour_error(colours_a[i], colours_b[i]);
    const double feature = std::min(features[i], 1.0);  // rounding
    map[i] = static_cast<float>(std::clamp(std::pow(colour, 1 - feature), 0.0, 1.0));
  });
  return map;
}

Image ramp_picture(const std::vector<float>& map, int width, int height) {
  Image picture(width, height);
  for (std::size_t i = 0; i < map.size(); ++i) {
    const draw::Colour colour = draw::ramp(map[i]);
    for (int c = 0; c < 3; ++c) picture.rgba[4 * i + static_cast<std::size_t>(c)] = srgb_decode(colour[c]);
    picture.rgba[4 * i + 3] = 1;
  }
  return picture;
}

}  // namespace pelage
