#include "pelage/data_schema/scene_values.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/knob.h"

namespace pelage {
namespace {

using testing::HasSubstr;
using testing::UnorderedElementsAre;

Scene base() {
  Scene scene;
  scene.hair = "a.hair";
  return scene;
}

Scene with(std::vector<std::string> values) {
  return with_values(base(), values);
}

std::string refusal(const std::string& value) {
  try {
    with({value});
  } catch (const UsageError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(SceneValues, SetsNumbersWordsSwitchesAndLists) {
  EXPECT_EQ(with({"shadow.density_map.resolution=64"}).shadow.density_map.resolution, 64);
  EXPECT_EQ(with({"method=truth"}).method, Method::truth);
  EXPECT_FALSE(with({"strands.azimuth=false"}).strands.azimuth);
  EXPECT_EQ(with({"lights.0.intensity=2.5"}).lights[0].intensity, 2.5F);
  EXPECT_EQ(with({"lights.0.direction=[0,0,1]"}).lights[0].direction, glm::vec3(0, 0, 1));
  EXPECT_EQ(with({"simulation.life.step_s=0.004"}).simulation.life.step_s, 0.004);
  EXPECT_EQ(with({"effects.fade-ends=off"}).effects.at("fade-ends"), EffectState::off);
  EXPECT_EQ(with({"hair=b=c.hair"}).hair, "b=c.hair");
  const Scene seen = with({R"(camera={"eye":[0,0,2],"target":[0,0,0]})", "camera.fov_deg=12"});
  EXPECT_EQ(seen.camera.value().fov_deg, 12);
}

TEST(SceneValues, LastOfOnePlaceWins) {
  EXPECT_EQ(with({"clusters=7", "clusters=9"}).clusters, 9);
}

TEST(SceneValues, LeavesAllElseAsItWas) {
  Scene expected = base();
  expected.clusters = 7;
  EXPECT_EQ(to_json(with({"clusters=7"})), to_json(expected));
}

TEST(SceneValues, RefusesWithPlaceAndRemedy) {
  EXPECT_THAT(refusal("shadow.density_map.resolutoin=64"), HasSubstr("nearest is 'resolution'"));
  EXPECT_THAT(refusal("shadow.density_map.resolution=0"), HasSubstr("resolution"));
  EXPECT_THAT(refusal("shadow.density_map.resolution=many"), HasSubstr("resolution"));
  EXPECT_THAT(refusal("clusters"), HasSubstr("PLACE=VALUE"));
  EXPECT_THAT(refusal("=7"), HasSubstr("PLACE=VALUE"));
  EXPECT_THAT(refusal("lights.3.intensity=2"), HasSubstr("list's 1 elements"));
  EXPECT_THAT(refusal("lights.-1.intensity=2"), HasSubstr("list's 1 elements"));
  EXPECT_THAT(refusal("clusters.of=2"), HasSubstr("nothing below"));
  EXPECT_THAT(refusal("..=2"), HasSubstr("there is no"));
  EXPECT_THAT(refusal("camera.eye=[0,0]"), HasSubstr("camera"));
  EXPECT_THAT(refusal("effects.fade-end=off"), HasSubstr("fade-end"));
}

TEST(SceneValues, ChangesTellOneSceneFromAnother) {
  Scene to = base();
  EXPECT_TRUE(changed_values(base(), to).empty());
  to.shadow.density_map.resolution = 64;
  to.satf.neighbours = 3;
  to.method = Method::satf;
  to.lights[0].intensity = 2;
  EXPECT_THAT(changed_values(base(), to),
              UnorderedElementsAre("lights.0.intensity=2.0", "method=satf", "satf.neighbours=3",
                                   "shadow.density_map.resolution=64"));
}

TEST(SceneValues, ChangesMakeTheOtherSceneAgain) {
  Scene to = base();
  to.hair = "12";  // would be read as a number
  to.camera = Camera{};
  to.camera->fov_deg = 11;
  to.lights.resize(3);
  to.lights[1].position = glm::vec3(1, 2, 3);
  to.image.background.reset();
  to.effects["drift"] = EffectState::off;
  to.simulation.chain.solver = ChainSolver::tridiagonal;
  to.bake.features = FeatureSet::paper3;
  to.strands.azimuth = !to.strands.azimuth;
  const std::vector<std::string> words = changed_values(base(), to);
  EXPECT_EQ(to_json(with_values(base(), words)), to_json(to));
}

TEST(Knobs, ValuesAreTheirNumbersAndWords) {
  const std::vector<KnobValue> cells = numbers("a.b", {16, 0.5, 1e-3});
  EXPECT_EQ(cells[0].label, "16");
  EXPECT_EQ(cells[1].settings, std::vector<std::string>{"a.b=0.5"});
  EXPECT_EQ(cells[2].amount, 1e-3);
  const std::vector<KnobValue> words = choices("a", {"x", "y"});
  EXPECT_EQ(words[1].settings, std::vector<std::string>{"a=y"});
  EXPECT_TRUE(std::isnan(words[0].amount));
}

}  // namespace
}  // namespace pelage
