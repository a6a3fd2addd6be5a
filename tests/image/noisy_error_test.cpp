#include "pelage/image/noisy_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "pelage/data_schema/errors.h"

namespace pelage {
namespace {

struct Trial {
  std::vector<float> picture, a, b;
};

/// A truth of .4; the picture off by `error` in each channel, in turns up and down; halves off by noise that channels
/// share, as the light does.
Trial trial(std::mt19937& random, std::size_t pixels, float error, float sigma) {
  std::normal_distribution<float> noise(0, sigma);
  Trial t;
  for (std::size_t i = 0; i < pixels; ++i) {
    const float ea = noise(random), eb = noise(random), up = i % 2 == 0 ? 1.0F : -1.0F;
    for (int c = 0; c < 4; ++c) {
      t.picture.push_back(0.4F + up * error);
      t.a.push_back(0.4F + ea);
      t.b.push_back(0.4F + eb);
    }
  }
  return t;
}

TEST(NoisyError, WithoutNoiseIsTheRootMeanSquare) {
  const std::vector<float> x{1, 2, 3, 9, 0, 0, 0, 9}, truth{1, 0, 0, 1, 0, 0, 1, 1};
  const NoisyError e = noisy_rmse(x, truth, truth, Pixels::all);
  EXPECT_NEAR(e.rmse, std::sqrt((4.0 + 9.0 + 1.0) / 6.0), 1e-12);
  EXPECT_EQ(e.standard_error, 0);
}

TEST(NoisyError, NoiseOfTheTruthIsNotCountedAndItsErrorBarIsRight) {
  std::mt19937 random(11);
  for (const float error : {.005F, .02F, .1F}) {
    double sum = 0, squares = 0, bars = 0;
    constexpr int kTrials = 400;
    for (int i = 0; i < kTrials; ++i) {
      const Trial t = trial(random, 900, error, .05F);
      const NoisyError e = noisy_rmse(t.picture, t.a, t.b, Pixels::all);
      sum += e.rmse * e.rmse, squares += e.rmse, bars += e.standard_error;
    }
    const double mean = squares / kTrials, deviation = std::sqrt(std::max(sum / kTrials - mean * mean, 0.0));
    if (error > .01F) {
      EXPECT_NEAR(mean, double(error), .06 * double(error))
          << "with the noise in it: " << std::hypot(double(error), .035);
    }
    // Of a distribution cut at 0 where noise hides the error, within a factor.
    EXPECT_NEAR(bars / kTrials / deviation, 1, error > .01F ? .15 : .6) << error;
  }
}

TEST(NoisyError, SampleCountsWhatDrawingPixelsLeavesOpen) {
  std::mt19937 random(5);
  // A tenth of the pixels is wrong by .3, the others are right: which of them are drawn matters.
  double sum = 0, squares = 0, bars = 0;
  constexpr int kTrials = 300;
  for (int i = 0; i < kTrials; ++i) {
    Trial t = trial(random, 500, 0, .01F);
    for (std::size_t p = 0; p < 500; ++p)
      if (random() % 10 == 0)
        for (std::size_t c = 0; c < 4; ++c) t.picture[4 * p + c] += .3F;
    const NoisyError e = noisy_rmse(t.picture, t.a, t.b, Pixels::sample);
    sum += e.rmse, squares += e.rmse * e.rmse, bars += e.standard_error;
  }
  const double mean = sum / kTrials, deviation = std::sqrt(squares / kTrials - mean * mean);
  EXPECT_NEAR(mean, .3 * std::sqrt(.1), .002);
  EXPECT_NEAR(bars / kTrials / deviation, 1, .15);
}

TEST(NoisyError, RefusesPicturesOfDifferentSize) {
  const std::vector<float> four(4), eight(8);
  EXPECT_THROW(noisy_rmse(four, eight, eight, Pixels::all), UsageError);
  EXPECT_THROW(noisy_rmse({}, {}, {}, Pixels::all), UsageError);
}

}  // namespace
}  // namespace pelage
