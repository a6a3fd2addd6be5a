// Every shadow method behind the one interface: slabs against the formula, order along the light, odd input.
#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <random>

#include "fixture.h"
#include "pelage/data_schema/errors.h"

namespace pelage {
namespace {

using test::clumped_hair;
using test::light_from;
using ::testing::HasSubstr;

class EveryMethod : public ::testing::TestWithParam<Method> {};
INSTANTIATE_TEST_SUITE_P(Methods, EveryMethod,
                         ::testing::Values(Method::density_map, Method::deep_opacity, Method::opacity_shadow));

float at(const HairShadow& shadow, glm::vec3 p) {
  float t = 0;
  shadow.transmittance(std::span(&p, 1), std::span(&t, 1));
  return t;
}

/// Fibres along z, evenly jittered in 0 <= y <= 2 cm, |x| <= 3 cm; E[T] behind them = exp(-a rho D h) [NUMBERS.md].
TEST_P(EveryMethod, SlabObeysBeerLambert) {
  Strands slab;
  slab.diameter_m = 2e-4F;
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(-0.5F, 0.5F);
  constexpr float kStep = 2.5e-4F;
  for (float x = -0.03F; x < 0.03F; x += kStep) {
    for (float y = 0; y < 0.02F; y += kStep) {
      const glm::vec3 p{x + kStep * uniform(random), y + kStep * uniform(random), 0};
      slab.append(std::array{p - glm::vec3(0, 0, 0.03F), p + glm::vec3(0, 0, 0.03F)});
    }
  }
  const auto shadow = make_shadow(GetParam(), {}, slab, 0.02F, light_from({0, 1, 0}));
  const double depth = 0.02 * 2e-4 * 0.02 / double(kStep * kStep);
  double sum = 0;
  for (int i = 0; i < 1000; ++i) sum += double(at(*shadow, 0.04F * glm::vec3(uniform(random), -1, uniform(random))));
  EXPECT_NEAR(-std::log(sum / 1000), depth, 0.02 * depth) << "80 jittered rows over 4 cm";
  // Half-way through, half of the depth: a layer of the coarsest method is 16 % of the slab.
  sum = 0;
  for (int i = 0; i < 1000; ++i)
    sum += double(at(*shadow, glm::vec3(0.04F * uniform(random), 0.01F, 0.04F * uniform(random))));
  EXPECT_NEAR(-std::log(sum / 1000), depth / 2, 0.05 * depth);
  for (int i = 0; i < 100; ++i) {
    const glm::vec3 before{0.04F * uniform(random), 0.021F, 0.04F * uniform(random)};
    EXPECT_EQ(at(*shadow, before), 1.0F);
  }
}

TEST_P(EveryMethod, LightNeverComesBack) {
  const Strands hair = clumped_hair(500);
  const glm::vec3 towards = glm::normalize(glm::vec3(1, 2, -1));
  const auto shadow = make_shadow(GetParam(), {}, hair, 0.5F, light_from(towards));
  std::mt19937 random(9);
  std::uniform_real_distribution<float> uniform(-0.15F, 0.15F);
  for (int column = 0; column < 100; ++column) {
    const glm::vec3 p{uniform(random), uniform(random), uniform(random)};
    float last = 1;
    for (float x = -0.5F; x < 0.5F; x += 0.002F) {
      const float t = at(*shadow, p - x * towards);
      ASSERT_LE(t, last + 2e-4F) << "rounding moves a point across a pixel's middle";
      ASSERT_GE(t, 0.0F);
      last = std::min(last, t);
    }
    EXPECT_EQ(at(*shadow, p + 10.0F * towards), 1.0F);
  }
}

TEST_P(EveryMethod, BuiltAgainIsBuiltNew) {
  const Strands a = clumped_hair(300, 1), b = clumped_hair(200, 2);
  const auto reused = make_shadow(GetParam(), {}, a, 0.5F, light_from({0, 1, 0}));
  reused->build(b, 0.7F, light_from({1, 1, 0}));
  const auto fresh = make_shadow(GetParam(), {}, b, 0.7F, light_from({1, 1, 0}));
  for (const glm::vec3& p : b.vertices) ASSERT_EQ(at(*reused, p), at(*fresh, p));
}

TEST_P(EveryMethod, OddHairGivesFiniteShadows) {
  Strands none, one, dots, tiny;
  for (Strands* s : {&one, &dots, &tiny}) s->diameter_m = 1e-4F;
  one.append(std::array{glm::vec3(0.1F)});
  for (int i = 0; i < 100; ++i) dots.append(std::array{glm::vec3(0.1F), glm::vec3(0.1F), glm::vec3(0.1F)});
  for (int i = 0; i < 100; ++i) tiny.append(std::array{glm::vec3(0), glm::vec3(1e-9F)});
  for (const Strands& hair : {none, one, dots, tiny}) {
    const auto shadow = make_shadow(GetParam(), {}, hair, 1.0F, light_from({0, 0, 1}));
    for (const glm::vec3 p : {glm::vec3(0), glm::vec3(0.1F), glm::vec3(-0.0F), glm::vec3(1e30F), glm::vec3(-1e30F)}) {
      const float t = at(*shadow, p);
      ASSERT_TRUE(t >= 0 && t <= 1) << t;
    }
    EXPECT_TRUE(std::isnan(at(*shadow, {0, NAN, 0})));
  }
}

TEST_P(EveryMethod, SaysWhatItRefuses) {
  const auto why = [&](const Strands& hair, float opacity, const Light& light) -> std::string {
    try {
      make_shadow(GetParam(), {}, hair, opacity, light);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  Strands good = clumped_hair(3), bad = good, unknown = good;
  bad.vertices[7].y = INFINITY;
  unknown.diameter_m = 0;
  const Light light = light_from({0, 1, 0});
  EXPECT_EQ(why(good, 0.5F, light), "accepted");
  EXPECT_THAT(why(bad, 0.5F, light), HasSubstr("vertex 7"));
  EXPECT_THAT(why(unknown, 0.5F, light), HasSubstr("diameter"));
  unknown.diameters_m.assign(unknown.vertices.size(), 1e-4F);
  EXPECT_EQ(why(unknown, 0.5F, light), "accepted");
  unknown.diameters_m[4] = -1e-4F;
  EXPECT_THAT(why(unknown, 0.5F, light), HasSubstr("diameter at vertex 4"));
  EXPECT_THAT(why(good, NAN, light), HasSubstr("opacity"));
  EXPECT_THAT(why(good, 1.5F, light), HasSubstr("opacity"));
  EXPECT_THAT(why(good, 0.5F, light_from({0, 0, 0})), HasSubstr("direction"));
}

TEST_P(EveryMethod, StrandsOfOneVertexChangeNothing) {
  const Strands hair = clumped_hair(200);
  Strands dotted;
  dotted.diameter_m = hair.diameter_m;
  for (std::size_t s = 0; s < hair.count(); ++s) {
    dotted.append(hair.strand(s));
    dotted.append(std::array{hair.strand(s)[7]});
  }
  const auto without = make_shadow(GetParam(), {}, hair, 0.5F, light_from({1, 2, 3}));
  const auto with = make_shadow(GetParam(), {}, dotted, 0.5F, light_from({1, 2, 3}));
  for (const glm::vec3& p : hair.vertices) ASSERT_EQ(at(*with, p), at(*without, p));
}

TEST(DeepOpacityMap, BeginsAtTheFirstHairWhateverTheirOrder) {
  for (const bool near_last : {true, false}) {
    Strands hair;
    hair.diameter_m = 0.01F;
    for (const float y : near_last ? std::array{-0.1F, 0.1F} : std::array{0.1F, -0.1F})
      hair.append(std::array{glm::vec3(0, y, -0.1F), glm::vec3(0, y, 0.1F)});
    ShadowSettings settings;
    settings.opacity_map.resolution = 16;
    const auto shadow = make_shadow(Method::deep_opacity, settings, hair, 0.5F, light_from({0, 1, 0}));
    EXPECT_EQ(at(*shadow, {0, 0.11F, 0}), 1.0F);
    const float between = at(*shadow, {0, 0, 0}), behind = at(*shadow, {0, -0.2F, 0});
    EXPECT_LT(between, 0.9F) << near_last;
    EXPECT_NEAR(behind, between * between, 1e-3F) << "two fibres";
  }
}

TEST(OpacityShadowMap, RefusesMoreCellsThanItCanCount) {
  ShadowSettings settings;
  settings.opacity_map.resolution = 4096;
  settings.opacity_map.slices = 1024;
  try {
    make_shadow(Method::opacity_shadow, settings, clumped_hair(100), 0.5F, light_from({0, 1, 0}));
    FAIL() << "17 thousand million cells";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("choose a lower resolution or fewer slices"));
  }
}

}  // namespace
}  // namespace pelage
