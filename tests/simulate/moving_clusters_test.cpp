#include "pelage/simulate/moving_clusters.h"

#include <gtest/gtest.h>

#include <glm/ext/matrix_transform.hpp>

#include "pelage/data_schema/procedural_strands.h"
#include "pelage/simulate/centre_lines.h"
#include "shape_fixture.h"

namespace pelage {
namespace {

using namespace pelage::test;

const glm::dquat kNoTurn(1, 0, 0, 0);

Cluster lock(vec3 root, float bend_m) {
  Cluster c;
  for (int i = 0; i < 7; ++i) {
    const float x = static_cast<float>(i) / 6;
    c.centre_line.push_back(root + vec3(bend_m * std::sin(3 * x), -0.2F * x, 0.5F * bend_m * x * x));
  }
  c.cross_sections.assign(4, cross_section({.010F, .006F, .3F}));
  c.first_normal = {0.3F, 0.1F, 1};
  append_procedural_strands(c, 30, StrandDistribution::uniform, 1);
  return c;
}

Hairstyle two_locks() {
  Hairstyle style;
  style.diameter_m = 1e-4F;
  style.clusters = {lock({.1F, .1F, 0}, .03F), lock({0, .1F, .1F}, -.02F)};
  return style;
}

/// Largest distance of points on the ellipses.
double apart(const Hairstyle& a, const Hairstyle& b, const std::function<dvec3(const dvec3&)>& to) {
  double most = 0;
  for (std::size_t c = 0; c < a.clusters.size(); ++c) {
    const SweptCluster p = sweep(a.clusters[c], 12), q = sweep(b.clusters[c], 12);
    for (int i = 0; i <= 12; ++i)
      for (const glm::vec2 disk : {glm::vec2(1, 0), glm::vec2(0, 1), glm::vec2(-0.5F, 0.3F)})
        most = std::max(most, glm::distance(to(dvec3(p.point(i, disk))), dvec3(q.point(i, disk))));
  }
  return most;
}

TEST(MovingClusters, AtRestAreTheHairstyle) {
  const Hairstyle style = two_locks();
  MovingClusters moving(style);
  const auto same = [](const dvec3& p) { return p; };
  EXPECT_EQ(moving.lines().strand(1).size(), 7U);
  const Strands lines = centre_lines(moving.lines(), 16);
  Strands out = moving.lines();
  StrandDetail(moving.lines(), lines).apply(lines, kNoTurn, out);
  moving.move(out, kNoTurn);
  EXPECT_LT(apart(style, moving.style(), same), 1e-6);
}

TEST(MovingClusters, TurnWithTheHead) {
  const Hairstyle style = two_locks();
  MovingClusters moving(style);
  for (int k = 1; k < 40; ++k) {
    const glm::dquat turn = turn_about({0.2, 1, 0.1 * k}, 0.3 * k);
    const auto rigid = [&](const dvec3& p) { return turned_by(turn, p) + dvec3(0.1, 0.02 * k, 0.3); };
    moving.move(moved(moving.lines(), rigid), turn);
    EXPECT_LT(apart(style, moving.style(), rigid), 2e-6) << k;
  }
}

/// The lock swings up by 130 degrees, past the direction of its first normal at rest: ellipses turn about the line no
/// faster than thrice as fast as the line does.
TEST(MovingClusters, DoNotSpinWhileTheySwing) {
  Hairstyle style = two_locks();
  for (Cluster& c : style.clusters) c.first_normal = {0.03F, 0.02F, 1};
  MovingClusters moving(style);
  const auto across = [&](std::size_t c) {  // an end of the ellipse at the middle, from the line
    const SweptCluster swept = sweep(moving.style().clusters[c], 12);
    return dvec3(swept.point(6, {1, 0})) - dvec3(swept.frames[6].position);
  };
  dvec3 last[] = {across(0), across(1)};
  for (int step = 1; step <= 225; ++step) {
    const auto swing = [&](const dvec3& p) {
      const dvec3 root(0, 0.1, 0);
      return root + turned_by(turn_about({1, 0, 0.1}, 0.01 * step), p - root);
    };
    moving.move(moved(moving.lines(), swing), kNoTurn);
    for (std::size_t c = 0; c < 2; ++c) {
      const dvec3 now = across(c);
      EXPECT_LT(glm::distance(now, last[c]), 3 * 0.01 * 0.01) << c << ' ' << step;
      last[c] = now;
    }
  }
}

TEST(MovingClusters, SeparateInstances) {
  Hairstyle style = two_locks();
  const glm::mat4 m = glm::rotate(glm::scale(glm::translate(glm::mat4(1), {1, 2, 3}), vec3(2)), 1.0F, {0, 0, 1});
  style.clusters[0].transforms = {glm::mat4(1), m};
  const MovingClusters moving(style);
  ASSERT_EQ(moving.style().clusters.size(), 3U);
  EXPECT_EQ(moving.lines().count(), 3U);
  Hairstyle first = style, second = style;
  first.clusters.resize(1);
  second.clusters = {moving.style().clusters[1]};
  EXPECT_TRUE(second.clusters[0].transforms.empty());
  EXPECT_LT(apart(first, second, [&](const dvec3& p) { return dvec3(glm::dmat4(m) * glm::dvec4(p, 1)); }), 2e-6);
}

TEST(MovingClusters, StayFiniteWhenAPolygonFolds) {
  MovingClusters moving(two_locks());
  Strands folded = moving.lines();
  for (std::size_t v = 0; v < folded.vertices.size(); ++v) folded.vertices[v] = vec3(0, v % 2 == 0 ? 0 : 0.1F, 0);
  moving.move(folded, kNoTurn);
  for (const Frame& f : sweep(moving.style().clusters[0], 12).frames)
    EXPECT_TRUE(std::isfinite(f.normal.x + f.tangent.y + f.position.z));
}

}  // namespace
}  // namespace pelage
