#include "pelage/simulate/curl.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>

#include "pelage/data_schema/errors.h"
#include "pelage/simulate/rotation_frames.h"
#include "shape_fixture.h"

namespace pelage {
namespace {

using namespace pelage::test;

const glm::dquat kNoTurn(1, 0, 0, 0);

Strands hanging(std::size_t strands, std::size_t vertices, double length_m) {
  Strands lines;
  for (std::size_t s = 0; s < strands; ++s) {
    const dvec3 root(0.002 * static_cast<double>(s), 0.1, 0.03);
    lines.append(curve(vertices, [&](double u) { return root + dvec3(0, -length_m * u, 0); }));
  }
  return lines;
}

CurlSettings helix_settings() {
  CurlSettings settings;
  settings.radius_m = 0.01F;
  settings.pitch_m = 0.03F;
  settings.start = 0;
  settings.phase_spread = 0;
  settings.subdivision = 16;
  return settings;
}

double azimuth(const vec3& p, const vec3& root) {
  return std::atan2(static_cast<double>(p.z - root.z), static_cast<double>(p.x - root.x));
}
double apart(double a, double b) {
  return std::abs(std::remainder(a - b, 2 * kPi));
}

TEST(Curl, OfAStraightLineIsTheHelix) {
  const double length = 0.24;
  const Strands lines = hanging(1, 13, length);
  for (const float growth : {0.0F, 1.0F}) {
    CurlSettings settings = helix_settings();
    settings.frequency_growth = growth;
    const Strands out = curled(lines, settings);
    ASSERT_EQ(out.strand(0).size(), 12 * 16 + 1U);
    const vec3 root = lines.vertices[0];
    EXPECT_EQ(out.vertices[0], root);
    const auto turns = [&](double s) { return (s + 0.5 * static_cast<double>(growth) * s * s / length) / 0.03; };
    const double s1 = length / (12 * 16);
    const double sense =
        std::copysign(1.0, std::remainder(azimuth(out.vertices[2], root) - azimuth(out.vertices[1], root), 2 * kPi));
    for (std::size_t i = 1; i < out.vertices.size(); ++i) {
      const vec3 p = out.vertices[i];
      const double s = s1 * static_cast<double>(i);
      EXPECT_NEAR(std::hypot(static_cast<double>(p.x - root.x), static_cast<double>(p.z - root.z)), 0.01, 1e-7) << i;
      EXPECT_NEAR(static_cast<double>(p.y), 0.1 - s, 1e-7) << i;
      const double expected = azimuth(out.vertices[1], root) + sense * 2 * kPi * (turns(s) - turns(s1));
      EXPECT_LT(apart(azimuth(p, root), expected), 2e-5) << i;  // 2e-7 m at a radius of 1 cm
    }
  }
}

/// As the head of curl.h says, but for the polygon: 24 chords a turn shorten a circle by 0.3 %.
TEST(Curl, AddsTheLengthItSays) {
  const Strands lines = hanging(1, 13, 0.24);
  CurlSettings settings = helix_settings();
  settings.subdivision = 36;
  // Without the first chord, which jumps from the root to the radius.
  const double ratio = length_of(curled(lines, settings).strand(0).subspan(1)) / (0.24 * 431 / 432);
  EXPECT_NEAR(ratio, std::sqrt(1 + std::pow(2 * kPi * 0.01 / 0.03, 2)), 0.005 * ratio);
  settings.start = 1;
  EXPECT_LT(length_of(curled(lines, settings).strand(0)) / 0.24, 0.9 * ratio);
}

TEST(Curl, RadiusGrowsFromTheRoot) {
  const Strands lines = hanging(1, 13, 0.24);
  CurlSettings settings = helix_settings();
  settings.start = 0.5F;
  const Strands out = curled(lines, settings);
  double last = 0;
  for (std::size_t i = 0; i < out.vertices.size(); ++i) {
    const vec3 d = out.vertices[i] - lines.vertices[0];
    const double radius = std::hypot(static_cast<double>(d.x), static_cast<double>(d.z));
    EXPECT_GE(radius, last - 1e-7) << i;
    EXPECT_LE(radius, 0.01 + 1e-7) << i;
    const double step = std::min(static_cast<double>(i) / 96, 1.0);
    EXPECT_NEAR(radius, 0.01 * step * step * (3 - 2 * step), 1e-6) << i;
    last = radius;
  }
}

TEST(Curl, KeepsRootsRadiusAndItsTurnsOnAnyLine) {
  std::mt19937 random(3);
  Strands lines;
  for (int s = 0; s < 300; ++s) lines.append(random_walk(random, 2 + static_cast<std::size_t>(s % 20), 0.02, 0.5));
  CurlSettings settings = helix_settings();
  settings.start = 0.15F;
  settings.radius_m = 0.004F;
  const Curls curls(lines, settings);
  CurlSettings none = settings;
  none.radius_m = 0;
  const Strands smooth = Curls(lines, none).rest();
  const glm::dquat turn = turn_about({1, 2, 3}, 2.0);
  const auto rigid = [&](const dvec3& p) { return turned_by(turn, p) + dvec3(3, -1, 2); };
  Strands now = curls.rest();
  curls.apply(moved(lines, rigid), turn, now);
  EXPECT_LT(largest_distance(now, moved(curls.rest(), rigid)), 2e-6);
  for (std::size_t s = 0; s < lines.count(); ++s) {
    EXPECT_EQ(curls.rest().strand(s)[0], lines.strand(s)[0]);
    for (std::size_t i = 0; i < smooth.strand(s).size(); ++i) {
      const double off = glm::distance(curls.rest().strand(s)[i], smooth.strand(s)[i]);
      EXPECT_LE(off, 0.004 + 1e-6) << s << ' ' << i;
    }
    // Vertices of the line stay where they are in the smooth curve.
    for (std::size_t i = 0; i < lines.strand(s).size(); ++i)
      EXPECT_LT(glm::distance(smooth.strand(s)[16 * i], lines.strand(s)[i]), 1e-6F);
  }
}

/// The curl of a strand that swings does not spin about it: per step no vertex moves by more than the line does and
/// its frame's turn at the radius.
TEST(Curl, DoesNotSpinWhileTheLineSwings) {
  const Strands lines = hanging(5, 13, 0.24);
  CurlSettings settings = helix_settings();
  settings.start = 0.15F;
  const Curls curls(lines, settings);
  Strands last = curls.rest(), now = last;
  for (int step = 1; step <= 700; ++step) {  // the free part once around, into itself and on
    const double angle = 0.01 * step;
    const auto swing = [&](const dvec3& p) {
      const dvec3 d(0, p.y - 0.1, 0);
      return dvec3(p.x, 0.1, p.z) + turned_by(turn_about({1, 0, 0.2}, angle * std::min(1.0, -8 * d.y)), d);
    };
    curls.apply(moved(lines, swing), kNoTurn, now);
    EXPECT_LT(largest_distance(now, last), 0.01 * 0.24 + 0.03 * 0.01 + 1e-5) << step;
    last = now;
  }
}

TEST(Curl, NeighboursShareACurlAndLocksDoNot) {
  const Strands lines = hanging(200, 13, 0.24);  // roots along 40 cm
  CurlSettings settings = helix_settings();
  const auto phases = [&](float spread) {
    settings.phase_spread = spread;
    const Strands out = curled(lines, settings);
    std::vector<double> angles;
    for (std::size_t s = 0; s < lines.count(); ++s)
      angles.push_back(azimuth(out.strand(s)[100], lines.strand(s)[0]) / (2 * kPi));
    return angles;
  };
  const std::vector<double> none = phases(0), some = phases(0.15F);
  double least = 1, most = -1;
  for (std::size_t s = 0; s < none.size(); ++s) {
    const double before = none[s > 0 ? s - 1 : 0];
    EXPECT_LT(std::abs(std::remainder(none[s] - before, 1.0)), 0.15) << s;  // 2 mm: at most 1.5 x 2 / 25
    EXPECT_LT(std::abs(std::remainder(some[s] - none[s], 1.0)), 0.0751) << s;
    least = std::min(least, none[s]), most = std::max(most, none[s]);
  }
  EXPECT_GT(most - least, 0.4);
}

TEST(Curl, KeepsDiametersAndColours) {
  Strands lines = hanging(2, 3, 0.1);
  lines.diameters_m = {1e-4F, 8e-5F, 4e-5F, 1e-4F, 8e-5F, 4e-5F};
  lines.colours = {vec3(1, 0, 0), vec3(0, 1, 0)};
  CurlSettings settings = helix_settings();
  settings.subdivision = 2;
  const Strands out = curled(lines, settings);
  EXPECT_EQ(out.colours, lines.colours);
  const std::vector<float> expected{1e-4F, 9e-5F, 8e-5F, 6e-5F, 4e-5F};
  ASSERT_EQ(out.diameters_m.size(), 10U);
  for (std::size_t i = 0; i < 10; ++i) EXPECT_FLOAT_EQ(out.diameters_m[i], expected[i % 5]);
}

TEST(Curl, TakesDegenerateLinesAndNothing) {
  Strands lines;
  lines.append(std::vector{vec3(1)});
  lines.append({});
  lines.append(std::vector<vec3>(4, vec3(2)));
  lines.append(std::vector{vec3(0), vec3(.1F, 0, 0), vec3(0), vec3(0)});
  const CurlSettings settings = helix_settings();
  const Strands out = curled(lines, settings);
  EXPECT_EQ(out.strand(0).size(), 1U);
  for (const vec3& p : out.vertices) EXPECT_TRUE(std::isfinite(p.x + p.y + p.z));
  CurlSettings none;
  EXPECT_EQ(curled(lines, none).vertices, lines.vertices);
  CurlSettings bad = settings;
  bad.pitch_m = 0;
  EXPECT_THROW(curled(lines, bad), UsageError);
  bad = settings;
  bad.frequency_growth = NAN;
  EXPECT_THROW(curled(lines, bad), UsageError);
}

TEST(Curl, IsTheSameForAnyNumberOfThreads) {
  const Strands lines = random_strands(1000, 9);
  std::vector<vec3> first;
  for (const std::size_t threads : {1U, 2U, 5U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const Strands out = curled(lines, helix_settings());
    if (threads == 1) first = out.vertices;
    EXPECT_EQ(out.vertices, first) << threads;
  }
}

}  // namespace
}  // namespace pelage
