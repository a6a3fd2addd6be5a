#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/scene.h"
#include "pelage/data_schema/validate.h"
#include "temporary.h"

namespace pelage {
namespace {

using nlohmann::json;
using test::message_of;
using ::testing::HasSubstr;
const std::filesystem::path kExamples = PELAGE_SOURCE_DIR "/data_schema/examples";

TEST(SceneJson, ExampleLoads) {
  const Scene scene = load_scene(kExamples / "lock.scene.json");
  EXPECT_TRUE(std::filesystem::exists(scene.hair)) << scene.hair;
  EXPECT_EQ(scene.lights.size(), 2U);
  EXPECT_EQ(scene.material.name, "brown");
  EXPECT_EQ(scene.image.background, std::nullopt);
  EXPECT_EQ(scene.bake.sectors, 500);
  ASSERT_TRUE(scene.camera);
  EXPECT_EQ(scene.camera->eye, glm::vec3(0, 0.1F, 0.7F));
}

TEST(SceneJson, ResolvedSceneReadsBackAsItself) {
  const test::TemporaryFolder folder;
  Scene scene = load_scene(kExamples / "lock.scene.json");
  scene.hair = std::filesystem::absolute(scene.hair).string();
  const std::string text = to_json(scene);
  EXPECT_EQ(to_json(load_scene(folder.write("again.json", text))), text);
}

/// The defaults that the schema documents, group by group.
void expect_defaults(const json& schema, const json& values, const std::string& at) {
  for (const auto& [key, property] : schema["properties"].items()) {
    if (key == "version" || key == "hair" || !values.contains(key)) continue;
    if (property.contains("properties")) {
      expect_defaults(property, values[key], at + "/" + key);
    } else if (key == "material" || key == "simulation") {
      EXPECT_EQ(values[key]["name"], property["default"]);
    } else if (property.contains("default")) {
      EXPECT_EQ(values[key], property["default"]) << at << "/" << key;
    }
  }
}

void expect_same_keys(const json& schema, const json& values, const std::string& at) {
  EXPECT_EQ(values.size(), schema["properties"].size()) << at;
  for (const auto& [key, property] : schema["properties"].items())
    if (property.contains("properties") && key != "effects")  // whose keys are data: written where given
      expect_same_keys(property, values[key], at + "/" + key);
}

TEST(SceneJson, EffectsThatDoNotExistAreRefused) {
  const test::TemporaryFolder folder;
  const auto message = [&](const std::string& effects) {
    return message_of<InputError>(
        [&] { load_scene(folder.write("s.json", R"({"version": 1, "hair": "x", "effects": )" + effects + "}")); });
  };
  EXPECT_THAT(message(R"({"frictoin": "on"})"), HasSubstr("nearest known key is \"friction\""));
  EXPECT_THAT(message(R"({"capsule-x": "on"})"), HasSubstr("capsule-x"));
  EXPECT_THAT(message(R"({"friction": "maybe"})"), HasSubstr("friction"));
  EXPECT_THAT(message(R"({"capsule-0": "off"})"), HasSubstr("has 0 capsules"));
  EXPECT_THAT(message(R"({"capsule-0": "maybe"})"), HasSubstr("/effects/capsule-0 is \"maybe\"; allowed: "));
  EXPECT_THAT(message(R"({"capsule-0": {"a": 1}})"), HasSubstr("/effects/capsule-0"));
}

TEST(SceneJson, DocumentedDefaultsAreTheDefaults) {
  const test::TemporaryFolder folder;
  Scene scene = load_scene(folder.write("s.json", R"({"version": 1, "hair": "x.hair"})"));
  EXPECT_EQ(scene.hair, (folder / "x.hair").string());
  EXPECT_EQ(to_json(scene.bake), to_json(BakeSettings{}));
  scene.camera = Camera{};
  const json simulation = resolved_schema("scene")["properties"]["simulation"]["oneOf"][1];
  const json written = json::parse(to_json(scene)), schema = resolved_schema("scene");
  expect_defaults(schema, written, "");
  expect_defaults(schema["properties"]["lights"]["items"], written["lights"][0], "/lights/0");
  expect_defaults(resolved_schema("material"), written["material"], "/material");
  expect_defaults(simulation, written["simulation"], "/simulation");
  // Every key of the schema is written, so none was forgotten by the code.
  for (const char* group : {"satf", "image", "bake", "division", "camera"})
    EXPECT_EQ(written[group].size() + schema["properties"][group]["properties"].count("version"),
              schema["properties"][group]["properties"].size())
        << group;
  EXPECT_EQ(written.size(), schema["properties"].size());
  expect_same_keys(simulation, written["simulation"], "/simulation");
  EXPECT_EQ(written["material"].size() + 1, resolved_schema("material")["properties"].size());
}

TEST(SceneJson, EachKeyIsRead) {
  const test::TemporaryFolder folder;
  const std::string text =
      R"({"version":1,"hair":"/a.hair","head":"/b.obj","database":"/c.db","unit":"cm","up":"z","curve":"bspline",)"
      R"("diameter_um":90.0,"opacity":0.25,"clusters":7,)"
      R"("division":{"layers":2,"sectors":5,"plates":6,"core":0.5},)"
      R"("camera":{"eye":[1.0,2.0,3.0],"target":[4.0,5.0,6.0],"up":[0.0,0.0,1.0],"fov_deg":50.0},)"
      R"("lights":[{"direction":[1.0,0.0,0.0],"colour":[0.5,0.25,2.0],"intensity":3.0,"size_deg":12.5},)"
      R"({"direction":[0.4,0.7,0.6],"position":[7.0,8.0,9.0],"colour":[1.0,1.0,1.0],"intensity":1.0,"size_deg":0.0}],)"
      R"("material":{"name":"x","diffuse_colour":[0.1,0.2,0.3],"primary_colour":[0.4,0.5,0.6],)"
      R"("secondary_colour":[0.7,0.8,0.9],"diffuse":2.0,"primary":3.0,"secondary":4.0,"primary_exponent":5.0,)"
      R"("secondary_exponent":6.0,"primary_shift":0.3,"secondary_shift":0.4,"ambient":0.5,"variation":0.75},)"
      R"("method":"opacity-shadow",)"
      R"("satf":{"diffuse":false,"primary_highlight":false,"secondary_highlight":false,"self_shadow":"paper",)"
      R"("self_shadow_strength":2.0,"global_shadow":false,"shadow_resolution":9,"fade_ends":false,"drift":false,)"
      R"("curvature":false,"draw_order":"exact","records":"direct","neighbours":3},)"
      R"("strands":{"shape":"lines","order":"weighted","lobes":"kajiya-kay","shadow_at":"fragment","smoothing":5,)"
      R"("diffuse":false,"primary_highlight":false,"secondary_highlight":false,"azimuth":false},)"
      R"("shadow":{"density_map":{"resolution":33,"factor":2.0,"area":false,"split":false,"trilinear_deposit":true,)"
      R"("centred_lookup":false,"interpolate_depth":true,"footprint_m":0.5,"filter":false,"fitted":false,)"
      R"("extent_m":0.75,"adaptive_slices":true},"opacity_map":{"resolution":44,"layers":3,"slices":55}},)"
      R"("truth":{"rays":66,"footprint_m":0.25,"samples":77,"stop_below":0.125,"azimuth":false},)"
      R"("image":{"width":10,"height":11,"supersampling":3,"exposure":2.5,"background":"transparent",)"
      R"("backdrop":"gradient"},)"
      R"("simulation":{"name":"wet","vertices":9,"detail":false,"wisps":8,)"
      R"("chain":{"solver":"tridiagonal","iterations":7,"ftl_correction":0.75,"gravity":[1.0,2.0,3.0],)"
      R"("damping_per_s":5.5},"interaction":{"cell_m":0.02,"friction_per_s":1.5,"repulsion_m_s2":2.5,)"
      R"("repulsion":"overfull","overfull":3.5},"wind":{"velocity_m_s":[4.0,5.0,6.0],"gust":0.75,"gust_s":2.5,)"
      R"("gust_m":0.5,"drag_per_s":3.5,"shelter":0.5},"shape":{"hold_rad_s":4.5,"hold_tip":0.125,"sag_free":true,)"
      R"("cone_deg":44.0,"cone_end":0.75,"curl":{"radius_m":0.0625,"pitch_m":0.5,"frequency_growth":1.5,"start":0.5,)"
      R"("phase_spread":0.75,"subdivision":6}},"collision":{"head":false,"margin_m":0.03125,"friction":0.75,)"
      R"("field_cell_m":0.0625,"capsules":[{"from":[1.0,2.0,3.0],"to":[4.0,5.0,6.0],"radius_m":0.5,)"
      R"("velocity_m_s":[7.0,8.0,9.0],"with_head":true}]},"motion":{"kind":"keyframes","amplitude":2.5,"speed":1.5,)"
      R"("keys":[{"time_s":1.5,"position_m":[1.0,2.0,3.0],"turn_deg":[4.0,5.0,6.0]}]},"life":{"step_s":0.001953125,)"
      R"("catch_up_s":0.5,"settle_s":2.0,"max_speed_m_s":7.0,"explosion_m_s":8.0,"sleep_m_s":0.25,)"
      R"("sleep_after_s":1.5}},"effects":{"capsule-0":"on","friction":"off","self-shadow":"auto"},)"
      R"("bake":{"seed":9007199254740991,"sectors":3,"grid":9,"sigma":0.02,"views":4,"lights":5,"samples":6,)"
      R"("smoothing":0.5,"reference_scale":0.05,"max_path":2.0,"early_stop":0.5,"max_strands":7.0,)"
      R"("phong":{"diffuse":1.0,"specular":2.0,"exponent":3.0},"features":"paper3","storage":"half"}})";
  EXPECT_EQ(to_json(load_scene(folder.write("s.json", text))), text);
}

TEST(SceneJson, SimulationIsAPresetOrChangesOne) {
  const test::TemporaryFolder folder;
  const auto simulation = [&](const std::string& text) {
    return load_scene(folder.write("s.json", R"({"version": 1, "hair": "x", "simulation": )" + text + "}")).simulation;
  };
  EXPECT_EQ(simulation(R"("curly")"), simulation_preset("curly"));
  SimulationSettings wet = simulation_preset("wet");
  wet.chain.damping_per_s = 3;
  EXPECT_EQ(simulation(R"({"name": "wet", "chain": {"damping_per_s": 3}})"), wet);
  SimulationSettings otherwise = simulation_preset("hold-shape");
  otherwise.wisps = 5;
  EXPECT_EQ(simulation(R"({"wisps": 5})"), otherwise);
  EXPECT_THAT(message_of<UsageError>([] { simulation_preset("curl"); }), HasSubstr("\"curly\""));
}

TEST(SceneJson, ImpossibleScenesAreRefused) {
  const test::TemporaryFolder folder;
  const auto message = [&](const std::string& rest) {
    const auto file = folder.write("s.json", R"({"version": 1, "hair": "x", )" + rest + "}");
    return message_of<InputError>([&] { load_scene(file); });
  };
  EXPECT_THAT(message(R"("camera": {"eye": [1,1,1], "target": [1,1,1]})"), HasSubstr("eye and target coincide"));
  EXPECT_THAT(message(R"("camera": {"eye": [0,1,0]})"), HasSubstr("up is parallel"));
  EXPECT_THAT(message(R"("lights": [{}, {"direction": [0,0,0]}])"), HasSubstr("lights/1: direction has no length"));
  EXPECT_THAT(message(R"("bake": {"phong": {"diffuse": 0, "specular": 0}})"), HasSubstr("both 0"));
}

TEST(Materials, PresetsAreFiveAndDiffer) {
  for (const char* name : {"black", "brown", "blond", "red", "grey"}) EXPECT_EQ(material_preset(name).name, name);
  EXPECT_EQ(material_preset("brown").diffuse_colour, HairMaterial{}.diffuse_colour);
  EXPECT_EQ(material_preset("brown").secondary_colour, HairMaterial{}.secondary_colour);
  EXPECT_LT(material_preset("black").diffuse_colour.r, material_preset("blond").diffuse_colour.r);
  EXPECT_THAT(message_of<UsageError>([] { material_preset("blonde"); }), HasSubstr("is \"blond\""));
}

TEST(Materials, ExampleLoads) {
  const HairMaterial material = load_material(kExamples / "material.json");
  EXPECT_EQ(material.name, "chestnut");
  EXPECT_EQ(material.primary, 0.3F);
  EXPECT_EQ(material.secondary, HairMaterial{}.secondary);
}

TEST(BakeSettingsJson, ExampleLoadsAndTextIsCanonical) {
  const BakeSettings settings = load_bake_settings(kExamples / "bake.json");
  EXPECT_EQ(settings, BakeSettings{});
  EXPECT_EQ(bake_settings_from_json(to_json(settings), "text"), settings);
  EXPECT_THAT(to_json(settings), HasSubstr(R"("sigma":0.05,"views":128)"));
}

TEST(Validate, ResolvedSchemaHoldsNoReferences) {
  for (const char* name : {"hairstyle", "scene", "bake", "material"})
    EXPECT_EQ(resolved_schema(name).dump().find("$ref"), std::string::npos) << name;
}

}  // namespace
}  // namespace pelage
