#include "pelage/image/picture_error.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "pelage/data_schema/errors.h"
#include "pelage/image/flip.h"
#include "pelage/image/tone.h"

namespace pelage {
namespace {

/// Keeps relMSE finite where the truth is black.
constexpr double kRelative = 0.01;

struct Sums {
  double squares = 0, signed_sum = 0, relative = 0, encoded_squares = 0, max = 0, covered_squares = 0;
  std::size_t covered = 0;  // pixels

  void add(const Sums& s) {
    squares += s.squares, signed_sum += s.signed_sum, relative += s.relative, encoded_squares += s.encoded_squares;
    covered_squares += s.covered_squares, covered += s.covered;
    max = std::max(max, s.max);
  }
};

Sums sums_of_row(const Image& picture, const Image& truth, std::span<const float> truth_alpha, int y) {
  Sums sums;
  for (int x = 0; x < picture.width; ++x) {
    const float *const p = picture.pixel(x, y), *const t = truth.pixel(x, y);
    double squares = 0;
    for (int c = 0; c < 3; ++c) {
      const double wanted = static_cast<double>(t[c]), d = static_cast<double>(p[c]) - wanted;
      const double encoded = static_cast<double>(srgb_encode(p[c])) - static_cast<double>(srgb_encode(t[c]));
      squares += d * d;
      sums.signed_sum += d;
      sums.relative += d * d / (wanted * wanted + kRelative);
      sums.encoded_squares += encoded * encoded;
      sums.max = std::max(sums.max, std::abs(d));
    }
    sums.squares += squares;
    if (truth_alpha[static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
                    static_cast<std::size_t>(x)] < 0.5F)
      continue;
    sums.covered_squares += squares;
    ++sums.covered;
  }
  return sums;
}

/// By rows, which are then added in order.
Sums sums_of(const Image& picture, const Image& truth, std::span<const float> truth_alpha) {
  std::vector<Sums> rows(static_cast<std::size_t>(picture.height));
  tbb::parallel_for(0, picture.height,
                    [&](int y) { rows[static_cast<std::size_t>(y)] = sums_of_row(picture, truth, truth_alpha, y); });
  Sums all;
  for (const Sums& row : rows) all.add(row);
  return all;
}

double mean_of(const std::vector<float>& values) {
  double sum = 0;
  for (const float v : values) sum += static_cast<double>(v);
  return sum / static_cast<double>(values.size());
}

}  // namespace

void check_same_size(const Image& a, const Image& b) {
  const auto size = [](const Image& i) { return std::to_string(i.width) + " x " + std::to_string(i.height); };
  if (a.width != b.width || a.height != b.height)
    throw UsageError("a picture of " + size(a) + " pixels cannot be compared with one of " + size(b) +
                     ": draw both at one size");
  if (a.rgba.empty()) throw UsageError("pictures without pixels cannot be compared");
}

void check_finite(const Image& image, const char* which) {
  const auto bad = std::count_if(image.rgba.begin(), image.rgba.end(), [](float v) { return !std::isfinite(v); });
  if (bad > 0)
    throw InputError(which, std::to_string(bad) + " of its values are not finite, no error can be told from them");
}

std::vector<float> alpha_of(const Image& image) {
  std::vector<float> alpha(image.rgba.size() / 4);
  for (std::size_t i = 0; i < alpha.size(); ++i) alpha[i] = image.rgba[4 * i + 3];
  return alpha;
}

PictureError picture_error(const Image& picture, const Image& truth, std::span<const float> truth_alpha) {
  check_same_size(picture, truth);
  if (truth_alpha.size() != truth.rgba.size() / 4)
    throw UsageError("the truth's alpha has " + std::to_string(truth_alpha.size()) + " values, its picture " +
                     std::to_string(truth.rgba.size() / 4) + " pixels");
  check_finite(picture, "the picture");
  check_finite(truth, "the truth");
  const Sums sums = sums_of(picture, truth, truth_alpha);
  const auto values = static_cast<double>(3 * truth_alpha.size());
  PictureError error;
  error.rmse = std::sqrt(sums.squares / values);
  error.bias = sums.signed_sum / values;
  error.rel_mse = sums.relative / values;
  const double mse = sums.encoded_squares / values;
  error.psnr_db = mse > 0 ? -10 * std::log10(mse) : std::numeric_limits<double>::infinity();
  error.flip = mean_of(flip_map(picture, truth));
  error.max = sums.max;
  if (sums.covered > 0) error.rmse_covered = std::sqrt(sums.covered_squares / (3 * static_cast<double>(sums.covered)));
  return error;
}

double flicker(const Image& picture, const Image& last_picture, const Image& truth, const Image& last_truth) {
  for (const Image* const other : {&last_picture, &truth, &last_truth}) check_same_size(picture, *other);
  double squares = 0;
  for (std::size_t i = 0; i < picture.rgba.size(); ++i) {
    if (i % 4 == 3) continue;
    const double change = static_cast<double>(picture.rgba[i]) - static_cast<double>(last_picture.rgba[i]);
    const double true_change = static_cast<double>(truth.rgba[i]) - static_cast<double>(last_truth.rgba[i]);
    squares += (change - true_change) * (change - true_change);
  }
  return std::sqrt(squares / (0.75 * static_cast<double>(picture.rgba.size())));
}

}  // namespace pelage
