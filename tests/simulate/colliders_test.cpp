#include "pelage/simulate/colliders.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <random>

#include "pelage/data_schema/errors.h"
#include "test_meshes.h"

namespace pelage {
namespace {

using glm::dquat;
using glm::dvec3;
using glm::vec3;

constexpr double kStep_s = 1.0 / 480;
const RigidPose kRest{};

Lanes3 lanes_of(const std::vector<vec3>& points) {
  Lanes3 lanes;
  for (int l = 0; l < kLanes; ++l) {
    const vec3& p = points[static_cast<std::size_t>(l) % points.size()];
    lanes.x[l] = p.x, lanes.y[l] = p.y, lanes.z[l] = p.z;
  }
  return lanes;
}

vec3 lane(const Lanes3& v, int l) {
  return {v.x[l], v.y[l], v.z[l]};
}

std::vector<vec3> random_points(unsigned seed, float half_m) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> u(-half_m, half_m);
  std::vector<vec3> points;
  for (int l = 0; l < kLanes; ++l) points.push_back({u(random), u(random), u(random)});
  return points;
}

CollisionSettings settings(std::vector<ColliderCapsule> capsules) {
  CollisionSettings s;
  s.capsules = std::move(capsules);
  return s;
}

Nearest ask(const Colliders& colliders, const std::vector<vec3>& points, float reach_m = 10) {
  Nearest out;
  colliders.nearest(lanes_of(points), reach_m, out);
  return out;
}

void expect_unit_and_finite(const Nearest& n) {
  for (int l = 0; l < kLanes; ++l) {
    EXPECT_TRUE(std::isfinite(n.distance.v[l]));
    EXPECT_NEAR(glm::length(lane(n.normal, l)), 1, 2e-6);
    EXPECT_TRUE(std::isfinite(glm::length(lane(n.displacement, l))));
  }
}

double segment_distance(const dvec3& p, const dvec3& a, const dvec3& b) {
  const double sq = glm::dot(b - a, b - a);
  const double t = sq > 0 ? std::clamp(glm::dot(p - a, b - a) / sq, 0.0, 1.0) : 0;
  return glm::distance(p, a + t * (b - a));
}

TEST(Colliders, AreEmptyWithoutSolids) {
  const Colliders none(CollisionSettings{}, Mesh{}, dvec3(0));
  EXPECT_TRUE(none.empty());
  const Nearest n = ask(none, random_points(1, 1));
  for (float d : n.distance.v) EXPECT_GT(d, 10);
  expect_unit_and_finite(n);
}

TEST(Colliders, CapsulesAreExactAndTheNearestWins) {
  const std::vector<ColliderCapsule> capsules = {{.from = {0.1F, 0, 0}, .to = {0.1F, 0.4F, 0.1F}, .radius_m = 0.06F},
                                                 {.from = {-0.2F, 0.1F, 0}, .to = {-0.2F, 0.1F, 0}, .radius_m = 0.1F},
                                                 {.from = {-0.1F, 0, 0}, .to = {0.3F, 0, 0}, .radius_m = 0.0F}};
  const dvec3 pivot(0.3, -0.1, 0.2);
  const Colliders colliders(settings(capsules), Mesh{}, pivot);
  for (unsigned seed = 0; seed < 50; ++seed) {
    const std::vector<vec3> points = random_points(seed, 0.5F);
    const Nearest n = ask(colliders, points);
    expect_unit_and_finite(n);
    for (int l = 0; l < kLanes; ++l) {
      const dvec3 p = dvec3(points[static_cast<std::size_t>(l)]) + pivot;
      double expected = INFINITY;
      for (const ColliderCapsule& c : capsules)
        expected =
            std::min(expected, segment_distance(p, dvec3(c.from), dvec3(c.to)) - static_cast<double>(c.radius_m));
      EXPECT_NEAR(static_cast<double>(n.distance.v[l]), expected, 4e-7);
      // The normal is the distance's gradient: going along it leaves the surface as fast as one goes.
      std::vector<vec3> farther = points;
      farther[static_cast<std::size_t>(l)] += 1e-3F * lane(n.normal, l);
      if (expected > 2e-3) {
        EXPECT_NEAR(ask(colliders, farther).distance.v[l] - n.distance.v[l], 1e-3F, 5e-5F);
      }
    }
  }
}

TEST(Colliders, NeverGiveNaNOnCentresAndAxes) {
  const Colliders colliders(settings({{.from = {0, 0, 0}, .to = {0, 0, 0}, .radius_m = 0},
                                      {.from = {1, 0, 0}, .to = {1, 2, 0}, .radius_m = 0.1F},
                                      {.from = {2, 0, 0}, .to = {2, 1e-30F, 0}, .radius_m = 0.1F}}),
                            Mesh{}, dvec3(0));
  const std::vector<vec3> points = {{0, 0, 0}, {1e-30F, 0, 0}, {1, 1, 0},      {1, 0, 0},     {1, 2, 0},
                                    {2, 0, 0}, {-0.0F, 0, 0},  {1e-16F, 0, 0}, {1, 1, 1e-22F}};
  expect_unit_and_finite(ask(colliders, points));
  const Nearest n = ask(colliders, points);
  EXPECT_NEAR(n.distance.v[2], -0.1F, 1e-7F);
  EXPECT_EQ(lane(n.normal, 2).y, 0);  // on the axis: at right angles to it
}

TEST(Colliders, LeaveOutWhatIsBeyondReach) {
  const Colliders colliders(settings({{.from = {0, 0, 0}, .to = {0, 0, 0}, .radius_m = 0.1F}}), Mesh{}, dvec3(0));
  const Nearest n = ask(colliders, {{0.3F, 0, 0}, {0, 5, 0}}, 0.05F);
  for (int l = 0; l < kLanes; ++l) EXPECT_GT(n.distance.v[l], 0.05F);
  expect_unit_and_finite(n);
  EXPECT_NEAR(ask(colliders, {{0.149F, 0, 0}, {0, 5, 0}}, 0.05F).distance.v[0], 0.049F, 1e-6F);
}

TEST(Colliders, MoveWithConstantVelocity) {
  Colliders colliders(settings({{.from = {0, 0, 0}, .to = {0, 0, 0}, .radius_m = 0.1F, .velocity_m_s = {1, 2, 0}}}),
                      Mesh{}, dvec3(0));
  colliders.move(kRest, kRest, 0.5, kStep_s);
  const Nearest n = ask(colliders, {{0.5F, 1.3F, 0}});
  EXPECT_NEAR(n.distance.v[0], 0.2F, 1e-6F);
  EXPECT_NEAR(n.displacement.x[0], 1.0 / 480, 1e-7);
  EXPECT_NEAR(n.displacement.y[0], 2.0 / 480, 1e-7);
}

TEST(Colliders, WithTheHeadTurnAndGo) {
  const dvec3 pivot(1e6, 2, 3);  // as good as at the origin
  Colliders colliders(
      settings({{.from = {1e6F, 2, 3.25F}, .to = {1e6F, 2, 3.25F}, .radius_m = 0.0625F, .with_head = true}}), Mesh{},
      pivot);
  const RigidPose before{pivot + dvec3(0.5, 0, 0), glm::angleAxis(0.48, dvec3(0, 1, 0))};
  const RigidPose after{pivot + dvec3(0.5, 0.001, 0), glm::angleAxis(0.50, dvec3(0, 1, 0))};
  colliders.move(before, after, 1, kStep_s);
  const dvec3 centre = after.rotation * dvec3(0, 0, 0.25);
  const dvec3 touching = centre + after.rotation * dvec3(0, 0, 0.0625);
  const Nearest n = ask(colliders, {vec3(centre + dvec3(0, 0.1, 0)), vec3(touching)});
  EXPECT_NEAR(n.distance.v[0], 0.1 - 0.0625, 1e-6);
  EXPECT_NEAR(n.distance.v[1], 0, 1e-6);
  const dvec3 was = before.position + before.rotation * dvec3(0, 0, 0.3125);
  const dvec3 moved = after.position + touching - was;
  for (int a = 0; a < 3; ++a) EXPECT_NEAR(static_cast<double>(lane(n.displacement, 1)[a]), moved[a], 1e-7);
}

TEST(Colliders, FasterThanTheirOwnSizeSweepTheirWay) {
  // A sphere of 2 cm that goes 0.5 m in the step, a bar that goes 0.3 m sideways, a bar without thickness that slides
  // along itself.
  Colliders colliders(settings({{.from = {0, 0, 0}, .to = {0, 0, 0}, .radius_m = 0.02F, .velocity_m_s = {240, 0, 0}},
                                {.from = {0, 1, 0}, .to = {0, 1, 1}, .radius_m = 0.01F, .velocity_m_s = {144, 0, 0}},
                                {.from = {0, 2, 0}, .to = {1, 2, 0}, .radius_m = 0.0F, .velocity_m_s = {480, 0, 0}}}),
                      Mesh{}, dvec3(0));
  colliders.move(kRest, kRest, kStep_s, kStep_s);
  const Nearest n = ask(colliders, {{0.25F, 0.005F, 0},     // on the sphere's way
                                    {0.15F, 1.004F, 0.5F},  // within the bar's sheet
                                    {0.20F, 1.004F, 0.7F},  // in the other triangle of it
                                    {0.05F, 1.05F, 0.2F},   // above it
                                    {0.1F, 1, 0.5F},        // on it
                                    {1.5F, 2, 0},           // on the way of the thin one
                                    {1.5F, 2.1F, 0}});
  expect_unit_and_finite(n);
  EXPECT_NEAR(n.distance.v[0], 0.005F - 0.02F, 1e-6F);
  EXPECT_NEAR(n.normal.y[0], 1, 1e-4F);
  EXPECT_NEAR(n.displacement.x[0], 0.5F, 1e-5F);
  EXPECT_NEAR(n.distance.v[1], 0.004F - 0.01F, 1e-6F);
  EXPECT_NEAR(n.distance.v[2], 0.004F - 0.01F, 1e-6F);
  EXPECT_NEAR(n.distance.v[3], 0.05F - 0.01F, 1e-6F);
  EXPECT_NEAR(n.distance.v[4], -0.01F, 1e-6F);
  EXPECT_NEAR(n.distance.v[5], 0, 1e-6F);
  EXPECT_NEAR(n.distance.v[6], 0.1F, 1e-6F);
}

TEST(Colliders, SlowerThanTheirOwnSizeDoNotSweep) {
  Colliders colliders(settings({{.from = {0, 0, 0}, .to = {0, 0, 0}, .radius_m = 0.02F, .velocity_m_s = {9, 0, 0}}}),
                      Mesh{}, dvec3(0));
  colliders.move(kRest, kRest, 0, kStep_s);  // 19 mm in the step
  EXPECT_NEAR(ask(colliders, {{-0.03F, 0, 0}}).distance.v[0], 0.01F, 1e-6F);
}

TEST(Colliders, DistanceIsOneLipschitz) {
  Colliders colliders(
      settings({{.from = {0, 0, 0}, .to = {0.2F, 0.1F, 0}, .radius_m = 0.05F},
                {.from = {0, 0.1F, 0}, .to = {0, 0.2F, 0.2F}, .radius_m = 0.01F, .velocity_m_s = {90, 40, 0}}}),
      Mesh{}, dvec3(0));
  colliders.move(kRest, kRest, kStep_s, kStep_s);
  for (unsigned seed = 0; seed < 200; ++seed) {
    const std::vector<vec3> a = random_points(seed, 0.3F), b = random_points(seed + 1000, 0.3F);
    const Nearest at_a = ask(colliders, a), at_b = ask(colliders, b);
    for (std::size_t l = 0; l < kLanes; ++l)
      EXPECT_LE(std::abs(at_a.distance.v[l] - at_b.distance.v[l]), glm::distance(a[l], b[l]) + 1e-6F);
  }
}

/// A head of uneven shape somewhere far from the origin.
Mesh head_at(const dvec3& pivot) {
  Mesh head = round_mesh(4, [](vec3 d) { return 0.0625F * (1 + 0.5F * std::max(d.z, 0.0F)); });
  for (vec3& v : head.vertices) v = vec3(pivot + dvec3(v));
  return head;
}

TEST(Colliders, TheHeadsFieldGoesWithTheHead) {
  const dvec3 pivot(2, -3, 1);
  const Colliders resting(CollisionSettings{}, head_at(pivot), pivot);
  Colliders moved = resting;
  const RigidPose before{pivot + dvec3(0.10, 0.2, 0.3), glm::angleAxis(1.00, glm::normalize(dvec3(1, 2, 3)))};
  const RigidPose after{pivot + dvec3(0.11, 0.2, 0.3), glm::angleAxis(1.05, glm::normalize(dvec3(1, 2, 3)))};
  moved.move(before, after, 1, kStep_s);
  EXPECT_FALSE(moved.empty());
  ASSERT_NE(moved.field(), nullptr);
  for (unsigned seed = 0; seed < 100; ++seed) {
    const std::vector<vec3> points = random_points(seed, 0.1F);
    std::vector<vec3> turned;
    for (const vec3& p : points) turned.push_back(vec3(after.rotation * dvec3(p)));
    const Nearest a = ask(resting, points, 0.02F), b = ask(moved, turned, 0.02F);
    expect_unit_and_finite(b);
    for (int l = 0; l < kLanes; ++l) {
      if (a.distance.v[l] > 0.02F) continue;
      EXPECT_NEAR(a.distance.v[l], b.distance.v[l], 1e-6F);
      const dvec3 n = after.rotation * dvec3(lane(a.normal, l));
      EXPECT_GT(glm::dot(n, dvec3(lane(b.normal, l))), 0.999);
      const dvec3 q =
          dvec3(lane(lanes_of(turned), l)) - static_cast<double>(b.distance.v[l]) * dvec3(lane(b.normal, l));
      const dvec3 was = before.position + before.rotation * (glm::conjugate(after.rotation) * q);
      EXPECT_LT(glm::distance(dvec3(lane(b.displacement, l)), after.position + q - was), 1e-6);
    }
  }
}

TEST(Colliders, TheHeadIsLeftOutWhereAsked) {
  CollisionSettings s;
  s.head = false;
  EXPECT_TRUE(Colliders(s, head_at(dvec3(0)), dvec3(0)).empty());
  s.head = true;
  s.field_cell_m = NAN;
  EXPECT_THROW(Colliders(s, head_at(dvec3(0)), dvec3(0)), UsageError);
  Mesh broken = head_at(dvec3(0));
  broken.vertices[2].z = INFINITY;
  EXPECT_THROW(Colliders(CollisionSettings{}, broken, dvec3(0)), InputError);
}

TEST(Colliders, ARootInsideIsLedOutAcrossOverlappingSolids) {
  // Inside both the head and a capsule that overlaps it: a few pushes along the normals lead out of both.
  const Colliders colliders(settings({{.from = {0, 0, 0}, .to = {0.1F, 0, 0}, .radius_m = 0.05F}}), head_at(dvec3(0)),
                            dvec3(0));
  for (unsigned seed = 0; seed < 50; ++seed) {
    std::vector<vec3> points = random_points(seed, 0.06F);
    for (int push = 0; push < 40; ++push) {
      const Nearest n = ask(colliders, points, 0.01F);
      for (int l = 0; l < kLanes; ++l)
        if (n.distance.v[l] < 0) points[static_cast<std::size_t>(l)] -= n.distance.v[l] * lane(n.normal, l);
    }
    const Nearest n = ask(colliders, points, 0.01F);
    for (int l = 0; l < kLanes; ++l) EXPECT_GT(n.distance.v[l], -1e-3F);
  }
}

TEST(Colliders, RefuseWhatIsNotFinite) {
  EXPECT_THROW(Colliders(settings({{.from = {NAN, 0, 0}}}), Mesh{}, dvec3(0)), UsageError);
  EXPECT_THROW(Colliders(settings({{.velocity_m_s = {0, INFINITY, 0}}}), Mesh{}, dvec3(0)), UsageError);
  EXPECT_THROW(Colliders(settings({{.radius_m = -1}}), Mesh{}, dvec3(0)), UsageError);
  EXPECT_THROW(Colliders(settings({{.radius_m = NAN}}), Mesh{}, dvec3(0)), UsageError);
}

}  // namespace
}  // namespace pelage
