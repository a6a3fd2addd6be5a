// The lobes on the CPU: float against double, hard case 19, and where the highlights lie. Their GPU twin is compared in
// tests/render.
#include "pelage/shading/lobes.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <vector>

namespace pelage {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kEps = std::numeric_limits<float>::epsilon();

/// Directions on a grid of polar and azimuth angles, poles and axes included; exact opposites are among them.
std::vector<glm::vec3> directions(int polar, int around) {
  std::vector<glm::vec3> all{{0, 0, 1}, {0, 0, -1}};
  for (int i = 1; i < polar; ++i) {
    for (int j = 0; j < around; ++j) {
      const double theta = kPi * i / polar, phi = 2 * kPi * j / around;
      all.push_back(glm::normalize(
          glm::vec3(glm::dvec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)))));
    }
  }
  return all;
}

std::string text(const glm::vec3& v) {
  return "(" + std::to_string(v.x) + ", " + std::to_string(v.y) + ", " + std::to_string(v.z) + ")";
}

TEST(Lobes, FloatAgreesWithDouble) {
  // A component of t x l is a difference of two rounded products of at most 1: eps. Length and dot add about as much,
  // so a base of products of such is off by at most 8 eps; a power e multiplies that by e, and pow itself adds an ulp.
  const auto all = directions(7, 9);
  for (const glm::vec3& t : all) {
    for (const glm::vec3& l : all) {
      const glm::dvec3 td(t), ld(l);
      EXPECT_NEAR(double(diffuse_lobe(t, l)), diffuse_lobe(td, ld), 4 * kEps) << text(t) << text(l);
      for (const glm::vec3& v : all) {
        for (const float exponent : {1.0F, 20.0F, 80.0F, 1000.0F}) {
          const double e = double(exponent), expected = specular_lobe(td, ld, glm::dvec3(v), e);
          ASSERT_NEAR(double(specular_lobe(t, l, v, exponent)), expected, (8 * e + 2) * kEps)
              << text(t) << text(l) << text(v) << exponent;
        }
      }
    }
  }
}

TEST(Lobes, SineOfParallelVectorsIsZeroAndNeverNaN) {
  for (const glm::vec3& t : directions(60, 61)) {
    EXPECT_EQ(sine_between(t, t), 0.0F) << text(t);
    EXPECT_EQ(sine_between(t, -t), 0.0F) << text(t);
    // One ulp off in each component: as parallel as floats get without being equal.
    const glm::vec3 nearly{std::nextafter(t.x, 2.0F), std::nextafter(t.y, -2.0F), std::nextafter(t.z, 2.0F)};
    EXPECT_LE(sine_between(t, nearly), 4 * float(kEps)) << text(t);
    for (const glm::vec3& l : {t, -t, nearly}) {
      EXPECT_TRUE(std::isfinite(specular_lobe(t, l, nearly, 80.0F))) << text(t);
      EXPECT_GE(specular_lobe(t, l, nearly, 80.0F), 0.0F);
    }
  }
}

TEST(Lobes, StayBetweenZeroAndOne) {
  const auto all = directions(9, 8);
  bool negative_base = false;
  for (const glm::vec3& t : all) {
    for (const glm::vec3& l : all) {
      EXPECT_TRUE(diffuse_lobe(t, l) >= 0 && diffuse_lobe(t, l) <= 1);
      for (const glm::vec3& v : all) {
        // 2.5: the power of a negative base is NaN, and of 1 + eps more than 1.
        const float lobe = specular_lobe(t, l, v, 2.5F);
        ASSERT_TRUE(lobe >= 0 && lobe <= 1) << text(t) << text(l) << text(v) << lobe;
        negative_base |= sine_between(t, l) * sine_between(t, v) - glm::dot(t, l) * glm::dot(t, v) < -0.5F;
      }
    }
  }
  EXPECT_TRUE(negative_base) << "the grid holds cases that need the clamp";
}

TEST(Lobes, ShiftedTangentsHaveUnitLength) {
  const auto all = directions(7, 8);
  for (const glm::vec3& t : all) {
    for (const glm::vec3& n : all) {
      for (const float shift : {-0.99F, -0.2F, 0.0F, 0.12F, 0.99F}) {
        // t + shift n as short as 0.01 (n = -t / shift's sign): rounding of its components is relative to 1.
        EXPECT_NEAR(glm::length(shifted_tangent(t, n, shift)), 1.0F, 4 * float(kEps)) << text(t) << text(n) << shift;
      }
    }
  }
}

/// Highlights on a circular strand: at azimuth phi the tangent is (-sin, cos, 0) and the normal (cos, sin, 0), so phi
/// grows towards the tip. Azimuth in [-pi/2, pi/2] of the brightest place.
template <class Lobe>
double brightest(const Lobe& lobe) {
  constexpr int kSteps = 20'000;
  double best = -1, at = 0;
  for (int i = 0; i <= kSteps; ++i) {
    const double phi = kPi * (double(i) / kSteps - 0.5);
    const double value =
        lobe(glm::dvec3(-std::sin(phi), std::cos(phi), 0), glm::dvec3(std::cos(phi), std::sin(phi), 0));
    if (value > best) best = value, at = phi;
  }
  return at;
}
constexpr double kStep = kPi / 20'000;

TEST(Highlights, UnshiftedPeakIsWhereTheTangentIsAcrossLightPlusView) {
  for (const double view : {0.0, 0.3, -0.9, 1.2}) {
    const glm::dvec3 l(1, 0, 0), v(std::cos(view), std::sin(view), 0);
    const double at = brightest([&](const glm::dvec3& t, const glm::dvec3&) { return specular_lobe(t, l, v, 80.0); });
    EXPECT_NEAR(at, view / 2, kStep) << view;  // 0 for light = viewer: t across l
  }
}

TEST(Highlights, PrimaryMovesToTheTipSecondaryToTheRoot) {
  // t + s n is across l where tan phi = s.
  const glm::dvec3 l(1, 0, 0);
  for (const double shift : {0.05, 0.12, 0.2, 0.5}) {
    const auto shifted = [&](double s) {
      return brightest([&](const glm::dvec3& t, const glm::dvec3& n) {
        return specular_lobe(shifted_tangent(t, n, s), l, l, 80.0);
      });
    };
    EXPECT_NEAR(shifted(shift), std::atan(shift), kStep);
    EXPECT_NEAR(shifted(-shift), -std::atan(shift), kStep);
  }
  // hair_lighting() gives each lobe its side.
  HairMaterial m;
  const auto at = [&](const LobeSwitches& on) {
    return brightest([&](const glm::dvec3& t, const glm::dvec3& n) {
      return double(hair_lighting(m, on, glm::vec3(t), glm::vec3(n), glm::vec3(l), glm::vec3(l)).g);
    });
  };
  // In float the top of pow(cos^2 phi, 20) is flat to sqrt(eps): 3e-4 / sqrt(20).
  EXPECT_NEAR(at({false, true, false}), std::atan(double(m.primary_shift)), 1e-3);
  EXPECT_NEAR(at({false, false, true}), -std::atan(double(m.secondary_shift)), 1e-3);
}

TEST(HairLighting, IsTheSumOfItsSwitchedTerms) {
  HairMaterial m;
  m.diffuse_colour = {0.1F, 0.2F, 0.3F};
  const auto all = directions(4, 5);
  for (const glm::vec3& t : all) {
    for (const glm::vec3& l : all) {
      const glm::vec3 n = glm::normalize(glm::vec3(t.y + 0.1F, -t.x, 0.3F)), v = glm::normalize(glm::vec3(1, 2, 3));
      const auto lit = [&](bool d, bool p, bool s) { return hair_lighting(m, {d, p, s}, t, n, l, v); };
      EXPECT_EQ(lit(false, false, false), glm::vec3(0));
      EXPECT_LT(glm::length(lit(true, false, false) + lit(false, true, false) + lit(false, false, true) -
                            lit(true, true, true)),
                4 * float(kEps));
      EXPECT_EQ(lit(true, false, false), m.diffuse * diffuse_lobe(t, l) * m.diffuse_colour);
    }
  }
}

}  // namespace
}  // namespace pelage
