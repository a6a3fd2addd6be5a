#include "pelage/simulate/head_motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "pelage/data_schema/errors.h"

namespace pelage {
namespace {

using glm::dquat;
using glm::dvec3;

constexpr MotionKind kBuiltIn[] = {MotionKind::shake, MotionKind::nod, MotionKind::turn, MotionKind::jump,
                                   MotionKind::dance};

double angle_deg(const dquat& a, const dquat& b) {
  const dquat q = glm::conjugate(a) * b;
  return 2 * std::atan2(glm::length(dvec3(q.x, q.y, q.z)), std::abs(q.w)) * 57.29577951308232;
}

/// Greatest change of pose per second between samples of a motion, and of that speed from one sample to the next.
struct Rates {
  double m_s = 0, deg_s = 0, jerk_m_s = 0, jerk_deg_s = 0;
};

Rates rates(const MotionSettings& motion, double length_s, double h) {
  Rates r;
  dvec3 last_v(0), last_w(0);  // at rest before time 0
  RigidPose a = head_pose(motion, dvec3(0), 0);
  for (int k = 1; k * h < length_s; ++k) {
    const RigidPose b = head_pose(motion, dvec3(0), k * h);
    const dvec3 v = (b.position - a.position) / h;
    dquat q = b.rotation * glm::conjugate(a.rotation);
    if (q.w < 0) q = -q;
    const dvec3 w = 2 / h * 57.29577951308232 * dvec3(q.x, q.y, q.z);
    r.m_s = std::max(r.m_s, glm::length(v));
    r.deg_s = std::max(r.deg_s, glm::length(w));
    r.jerk_m_s = std::max(r.jerk_m_s, glm::length(v - last_v));
    r.jerk_deg_s = std::max(r.jerk_deg_s, glm::length(w - last_w));
    a = b, last_v = v, last_w = w;
  }
  return r;
}

TEST(HeadMotion, BeginsAtRest) {
  const dvec3 pivot(1e6, -2, 3);
  for (MotionKind kind : kBuiltIn) {
    const RigidPose pose = head_pose({.kind = kind, .amplitude = 3, .speed = 2, .keys = {}}, pivot, 0);
    EXPECT_EQ(pose.position, pivot);
    EXPECT_EQ(pose.rotation, dquat(1, 0, 0, 0));
  }
  EXPECT_EQ(head_pose({.kind = MotionKind::none, .keys = {}}, pivot, 7.7).position, pivot);
}

TEST(HeadMotion, BuiltInsMoveAsFastAsStatedWithContinuousVelocity) {
  struct Case {
    MotionKind kind;
    double least_deg_s, most_deg_s, most_m_s;
  };
  // The bounds are those of the comments in head_motion.cpp; two periods, so that the end of one meets the next.
  const Case cases[] = {{MotionKind::shake, 370, 378, 0},
                        {MotionKind::nod, 150, 158, 0},
                        {MotionKind::turn, 448, 451, 0},
                        {MotionKind::dance, 300, 520, 0.55}};
  for (const Case& c : cases) {
    const MotionSettings motion{.kind = c.kind, .keys = {}};
    const double h = 1e-4;
    const Rates r = rates(motion, 2 * motion_length_s(motion), h);
    EXPECT_GT(r.deg_s, c.least_deg_s) << static_cast<int>(c.kind);
    EXPECT_LT(r.deg_s, c.most_deg_s) << static_cast<int>(c.kind);
    EXPECT_LE(r.m_s, c.most_m_s) << static_cast<int>(c.kind);
    EXPECT_LT(r.jerk_deg_s, 10000 * h) << static_cast<int>(c.kind);  // a bounded acceleration; a kink leaves > 10
    EXPECT_LT(r.jerk_m_s, 10 * h) << static_cast<int>(c.kind);
  }
}

TEST(HeadMotion, TurnsHalfRoundAndJumpsAside) {
  const RigidPose turned = head_pose({.kind = MotionKind::turn, .keys = {}}, dvec3(0), 1.0);
  EXPECT_NEAR(angle_deg(turned.rotation, {1, 0, 0, 0}), 180, 1e-6);
  const MotionSettings jump{.kind = MotionKind::jump, .amplitude = 2, .keys = {}};
  EXPECT_EQ(head_pose(jump, dvec3(0), 0.5 - 1e-9).position, dvec3(0));
  EXPECT_NEAR(head_pose(jump, dvec3(0), 0.5).position.x, 0.6, 1e-12);
}

TEST(HeadMotion, SpeedAndAmplitudeScaleTheBuiltIn) {
  const MotionSettings slow{.kind = MotionKind::nod, .keys = {}};
  const MotionSettings fast{.kind = MotionKind::nod, .amplitude = 0.5F, .speed = 2, .keys = {}};
  EXPECT_EQ(motion_length_s(fast), motion_length_s(slow) / 2);
  EXPECT_NEAR(angle_deg(head_pose(slow, dvec3(0), 1.3).rotation, {1, 0, 0, 0}),
              2 * angle_deg(head_pose(fast, dvec3(0), 0.65).rotation, {1, 0, 0, 0}), 1e-6);
  const RigidPose down = head_pose(slow, dvec3(0), 1.25);  // a quarter into the second nod
  EXPECT_LT((down.rotation * dvec3(0, 0, 1)).y, -0.4);
}

MotionSettings keys_motion(std::vector<MotionKey> keys) {
  return {.kind = MotionKind::keyframes, .keys = std::move(keys)};
}

const std::vector<MotionKey> kKeys = {{0.5, {0.1F, 0, 0}, {20, 0, 0}},
                                      {0.8, {0.3F, 0.1F, 0}, {20, 60, 10}},
                                      {1.7, {0.3F, -0.2F, 0}, {-30, 170, 0}},
                                      {1.9, {0.0F, -0.2F, 0.5F}, {-30, 190, 0}},
                                      {4.0, {0.0F, 0, 0}, {0, 350, 0}}};

TEST(HeadMotion, KeyframesAreHit) {
  const MotionSettings motion = keys_motion(kKeys);
  const dvec3 pivot(5, 6, 7);
  EXPECT_EQ(head_pose(motion, pivot, 0).position, pivot);
  for (const MotionKey& key : kKeys) {
    for (double to_s : {0.0, -1e-9, 1e-9}) {
      const RigidPose pose = head_pose(motion, pivot, key.time_s + to_s);
      EXPECT_LT(glm::distance(pose.position, pivot + dvec3(key.position_m)), 1e-7) << key.time_s;
      const MotionSettings only = keys_motion({{0, {}, key.turn_deg}});
      EXPECT_LT(angle_deg(pose.rotation, head_pose(only, pivot, 0).rotation), 1e-5) << key.time_s;
    }
  }
  EXPECT_EQ(motion_length_s(motion), 4.0);
  EXPECT_EQ(head_pose(motion, pivot, 99).position, pivot + dvec3(kKeys.back().position_m));
}

TEST(HeadMotion, KeyframesKeepTheirVelocityAndDoNotOvershoot) {
  const MotionSettings motion = keys_motion(kKeys);
  const double h = 1e-5;
  const Rates r = rates(motion, 4.2, h);
  EXPECT_LT(r.jerk_m_s, 150 * h);  // 0.5 m in 0.2 s; a kink leaves > 1
  EXPECT_LT(r.jerk_deg_s, 10000 * h);
  for (int k = 0; k < 420; ++k) {
    const dvec3 p = head_pose(motion, dvec3(0), 0.01 * k).position;
    EXPECT_LE(p.x, 0.3000001);
    EXPECT_GE(p.x, -1e-12);
    EXPECT_GE(p.y, -0.2000001);
  }
}

TEST(HeadMotion, KeyframesTurnTheShorterWay) {
  // 170 to 190 to 350 degrees: euler angles wrap, the head does not turn back through 0.
  const MotionSettings motion = keys_motion({{0, {}, {0, 0, 0}}, {1, {}, {0, 170, 0}}, {1.2, {}, {0, -170, 0}}});
  for (double t = 1; t <= 1.2; t += 0.01)
    EXPECT_GE(angle_deg(head_pose(motion, dvec3(0), t).rotation, {1, 0, 0, 0}), 169.999) << t;
  for (double t = 0; t <= 1; t += 0.01) {
    const dquat q = head_pose(motion, dvec3(0), t).rotation;
    EXPECT_LT(std::hypot(q.x, q.z), 1e-9);
    EXPECT_NEAR(glm::length(q), 1, 1e-12);
  }
}

TEST(HeadMotion, AxesAreNodTurnTilt) {
  const auto at = [](glm::vec3 turn) { return head_pose(keys_motion({{0, {}, turn}}), dvec3(0), 0).rotation; };
  EXPECT_LT(glm::distance(at({90, 0, 0}) * dvec3(0, 0, 1), dvec3(0, -1, 0)), 1e-9);
  EXPECT_LT(glm::distance(at({0, 90, 0}) * dvec3(0, 0, 1), dvec3(1, 0, 0)), 1e-9);
  EXPECT_LT(glm::distance(at({0, 0, 90}) * dvec3(0, 1, 0), dvec3(-1, 0, 0)), 1e-9);
  EXPECT_LT(glm::distance(at({90, 90, 0}) * dvec3(0, 1, 0), dvec3(1, 0, 0)), 1e-9);  // the nod first
}

TEST(HeadMotion, RefusesKeysOutOfOrderOrNotFinite) {
  EXPECT_THROW(head_pose(keys_motion({}), dvec3(0), 0), UsageError);
  EXPECT_THROW(head_pose(keys_motion({{1, {}, {}}, {1, {}, {}}}), dvec3(0), 0), UsageError);
  EXPECT_THROW(head_pose(keys_motion({{-1, {}, {}}}), dvec3(0), 0), UsageError);
  EXPECT_THROW(head_pose(keys_motion({{0, {NAN, 0, 0}, {}}}), dvec3(0), 0), UsageError);
  EXPECT_THROW(motion_length_s(keys_motion({{INFINITY, {}, {}}})), UsageError);
}

}  // namespace
}  // namespace pelage
