#include "pelage/simulate/rotation_frames.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "shape_fixture.h"

namespace pelage {
namespace {

using namespace pelage::test;

std::vector<glm::quat> frames_of(std::span<const vec3> line) {
  std::vector<glm::quat> frames(line.size());
  rotation_frames(line, first_frame(line), frames);
  return frames;
}

double angle_between(const dvec3& a, const dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}
double turn_between(const glm::quat& a, const glm::quat& b) {
  const glm::dquat p(a), q(b);
  return 2 * std::acos(std::min(1.0, std::abs(p.w * q.w + p.x * q.x + p.y * q.y + p.z * q.z)));
}

/// Line 25 of HARD_CASES: |n| = 1, n . t = 0 to 1e-6, frame turn <= 2 x segment turn. Segments of equal length.
void check_frames(std::span<const vec3> line, const char* what) {
  const std::vector<glm::quat> frames = frames_of(line);
  for (std::size_t i = 0; i < line.size(); ++i) {
    const dvec3 n(frame_normal(frames[i])), t(frame_tangent(frames[i]));
    EXPECT_NEAR(glm::length(n), 1, 1e-6) << what << ' ' << i;
    EXPECT_NEAR(glm::dot(n, t), 0, 1e-6) << what << ' ' << i;
    const dvec3 across = dvec3(line[std::min(i + 1, line.size() - 1)] - line[i > 0 ? i - 1 : 0]);  // as float sees them
    // A unit vector of three floats, then two products of it.
    if (glm::length(across) > 1e-3) {
      EXPECT_LT(glm::length(glm::normalize(across) - t), 2e-6) << what << ' ' << i;
    }
    if (i == 0) continue;
    double bend = 0;  // at either end of the segment
    for (const std::size_t k : {i - 1, i})
      if (k > 0 && k + 1 < line.size())
        bend = std::max(bend, angle_between(dvec3(line[k]) - dvec3(line[k - 1]), dvec3(line[k + 1]) - dvec3(line[k])));
    EXPECT_LE(turn_between(frames[i - 1], frames[i]), 2 * bend + 2e-3) << what << ' ' << i;  // acos near 1 in float
    EXPECT_GE(frames[i].w * frames[i - 1].w + frames[i].x * frames[i - 1].x + frames[i].y * frames[i - 1].y +
                  frames[i].z * frames[i - 1].z,
              -1e-6F)
        << what << ' ' << i;
  }
}

TEST(RotationFrames, AreOrthonormalAndTurnNoMoreThanTheLine) {
  std::mt19937 random(1);
  for (const double bend : {0.01, 0.3, 1.5, 3.0})
    for (int k = 0; k < 200; ++k) check_frames(random_walk(random, 2 + k % 30, 0.01, bend), "walk");
}

TEST(RotationFrames, NeverFlipTheNormal) {
  const auto keeps = [](std::span<const vec3> line, double least, const char* what) {
    const std::vector<glm::quat> frames = frames_of(line);
    for (std::size_t i = 0; i < line.size(); ++i) {
      ASSERT_TRUE(std::isfinite(frames[i].w + frames[i].x + frames[i].y + frames[i].z)) << what << ' ' << i;
      if (i > 0) {
        EXPECT_GT(glm::dot(frame_normal(frames[i - 1]), frame_normal(frames[i])), least) << what << ' ' << i;
      }
    }
  };
  const auto x = [](float m) { return vec3(m, 0.3F, -0.2F); };
  keeps(curve(20, [](double u) { return dvec3(0.1, -0.3 * u, 0.2); }), 0.999999, "straight");
  keeps(curve(20, [](double u) { return dvec3(0.1, 0.3 * u, 0.2); }), 0.999999, "straight up");
  keeps(std::vector{x(0), x(.1F), x(.1F), x(.1F), x(.2F)}, 0.999999, "duplicates");
  keeps(std::vector{x(0), x(0), x(0)}, 0.999999, "no length");
  keeps(std::vector{x(0), x(0), x(.1F)}, 0.999999, "begins with a duplicate");
  keeps(std::vector{x(0), x(.1F), x(.2F), x(.1F), x(0)}, 0.999999, "fold");
  keeps(std::vector{x(0), x(.1F), x(0), x(.1F), x(0)}, 0.999999, "folds");
  keeps(std::vector{x(0), x(.2F), x(.1F), x(.3F), x(.05F)}, 0.999999, "folds of unequal segments");
  keeps(curve(33, [](double u) { return dvec3(std::cos(2 * kPi * u), std::sin(2 * kPi * u), 0); }), 0.9, "loop");
  keeps(curve(33, [](double u) { return dvec3(u, 0.1 * std::sin(4 * kPi * u), 0); }), 0.9, "inflections");
}

/// The frames' x axis against Frenet's turns by -torsion x length [Wang2008 section 3.2]: on a helix of radius a and
/// rise b per radian by b / sqrt(a^2 + b^2) per radian.
TEST(RotationFrames, TurnOnAHelixByItsTorsion) {
  const double a = 0.03, b = 0.02, turns = 2;
  double error[2];
  for (const int fine : {0, 1}) {
    const std::size_t vertices = fine == 0 ? 65 : 129;
    const std::vector<vec3> line = curve(vertices, [&](double u) {
      const double phi = 2 * kPi * turns * u;
      return dvec3(a * std::cos(phi), a * std::sin(phi), b * phi);
    });
    const std::vector<glm::quat> frames = frames_of(line);
    const auto angle = [&](std::size_t i) {  // of the frame's normal, from Frenet's
      const double phi = 2 * kPi * turns * static_cast<double>(i) / static_cast<double>(vertices - 1);
      const dvec3 n(-std::cos(phi), -std::sin(phi), 0), t(frame_tangent(frames[i]));
      const dvec3 x(frame_normal(frames[i]));
      return std::atan2(glm::dot(glm::cross(t, n), x), glm::dot(n, x));
    };
    const std::size_t last = vertices - 4;
    const double steps = static_cast<double>(last - 3) / static_cast<double>(vertices - 1);
    const double expected = -2 * kPi * turns * steps * b / std::hypot(a, b);
    error[fine] = std::abs(std::remainder(angle(last) - angle(3) - expected, 2 * kPi));
  }
  EXPECT_LT(error[0], 0.02);             // of 7 rad, at 32 vertices a turn
  EXPECT_LT(error[1], 0.35 * error[0]);  // second order: chords for tangents
}

TEST(RotationFrames, KeepTheBinormalOfAPlaneCurve) {
  const std::vector<vec3> line = curve(40, [](double u) { return dvec3(0.2 * u, 0.05 * std::sin(5 * u), 0.0); });
  std::vector<glm::quat> frames(line.size());
  const glm::quat first = carried_to(glm::quat(1, 0, 0, 0), first_direction(line, {}));
  rotation_frames(line, first, frames);
  const double held = static_cast<double>(frame_normal(frames[0]).z);
  for (const glm::quat& q : frames) EXPECT_NEAR(static_cast<double>(frame_normal(q).z), held, 2e-6);
}

TEST(RotationFrames, TurnWithTheirLine) {
  std::mt19937 random(4);
  for (int k = 0; k < 50; ++k) {
    const std::vector<vec3> line = random_walk(random, 20, 0.01, 1.0);
    const glm::dquat turn = turn_about({0.3, 1.0 - 0.1 * k, 0.5}, 0.13 * k);
    std::vector<vec3> turned_line;
    for (const vec3& p : line) turned_line.emplace_back(turned_by(turn, dvec3(p)));
    const std::vector<glm::quat> rest = frames_of(line);
    std::vector<glm::quat> now(line.size());
    rotation_frames(turned_line, glm::quat(turn) * first_frame(line), now);
    for (std::size_t i = 0; i < line.size(); ++i) {
      const dvec3 expected = turned_by(turn, dvec3(frame_normal(rest[i])));
      EXPECT_LT(glm::length(expected - dvec3(frame_normal(now[i]))), 5e-5) << k << ' ' << i;  // chords of 1 cm in float
    }
  }
}

TEST(RotationFrames, CarryAFrameToAnyDirection) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 2000; ++k) {
    const dvec3 a = glm::normalize(dvec3(normal(random), normal(random), normal(random)));
    dvec3 b = glm::normalize(dvec3(normal(random), normal(random), normal(random)));
    if (k % 2 == 0) b = glm::normalize(-a + std::pow(10.0, -k % 12) * b);  // nearly and just opposite
    const glm::quat from = carried_to(glm::quat(1, 0, 0, 0), vec3(a)), to = carried_to(from, vec3(b));
    EXPECT_LT(glm::length(dvec3(frame_tangent(to)) - b), 1e-6) << k;
    EXPECT_NEAR(static_cast<double>(glm::length(frame_normal(to))), 1, 1e-6) << k;
  }
}

}  // namespace
}  // namespace pelage
