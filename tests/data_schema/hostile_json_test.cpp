// Hard case 28 (NaN and Inf in any file) and files that were never meant well: each gets one sentence that says where.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/json_file.h"
#include "pelage/data_schema/scene.h"
#include "pelage/data_schema/validate.h"
#include "temporary.h"

namespace pelage {
namespace {

using nlohmann::json;
using test::message_of;
using ::testing::AllOf;
using ::testing::HasSubstr;

std::string parse_message(const std::string& text) {
  return message_of<InputError>([&] { parse_json(text, "f.json"); });
}
std::string scene_message(const std::string& rest) {
  const std::string text = R"({"version": 1, "hair": "x", )" + rest + "}";
  return message_of<InputError>([&] { validate(parse_json(text, "f.json"), "scene", "f.json"); });
}

TEST(HostileJson, ParseErrorsNameLineAndColumn) {
  EXPECT_THAT(parse_message("{\n  \"a\": 1,\n  b\n}"), HasSubstr("f.json: line 3, column 3: not JSON at"));
  EXPECT_THAT(parse_message(""), HasSubstr("line 1, column 1"));
  EXPECT_THAT(parse_message("{\"a\": 1"), HasSubstr("line 1, column"));
  EXPECT_THAT(parse_message("\"\xff\""), HasSubstr("not JSON"));
  EXPECT_THAT(parse_message(std::string("{}\0x", 4)), HasSubstr("not JSON"));
}

TEST(HostileJson, NumbersThatAreNotFiniteAreRefused) {
  for (const char* number : {"NaN", "nan", "Infinity", "-Infinity", "inf", "0x10", "1e", ".5", "+1"})
    EXPECT_THAT(parse_message("{\"a\":\n " + std::string(number) + "}"), HasSubstr("line 2")) << number;
  for (const char* number : {"1e999", "-1e999", "1e400"})
    EXPECT_THAT(parse_message("{\"a\": [0, " + std::string(number) + "]}"),
                HasSubstr("the number " + std::string(number) + " is too large"));
}

TEST(HostileJson, EveryNumberOfASceneHasBounds) {
  // Property: a number that float cannot hold is refused wherever a number may stand.
  const std::function<void(const json&, const std::string&)> walk = [&](const json& schema, const std::string& at) {
    const std::string type = schema.value("type", "");
    if (type == "number" || type == "integer") {
      EXPECT_TRUE(schema.contains("minimum") || schema.contains("exclusiveMinimum")) << at;
      EXPECT_TRUE(schema.contains("maximum") || schema.contains("exclusiveMaximum")) << at;
    }
    if (type == "array") {
      EXPECT_TRUE(schema.contains("maxItems")) << at;
    }
    if (type == "object") {
      EXPECT_EQ(schema.value("additionalProperties", true), false) << at;
    }
    if (schema.contains("items")) walk(schema["items"], at + "/items");
    for (const json& option : schema.value("oneOf", json::array())) walk(option, at + "/oneOf");
    const json properties = schema.value("properties", json::object());
    for (const auto& [key, child] : properties.items()) {
      EXPECT_TRUE(child.contains("description")) << at << "/" << key;
      walk(child, at + "/" + key);
    }
  };
  for (const char* name : {"hairstyle", "scene", "bake", "material"}) walk(resolved_schema(name), name);
}

TEST(HostileJson, UnknownKeysNameTheNearest) {
  EXPECT_EQ(scene_message(R"("satf": {"self_shaddow": "none"})"),
            "f.json: /satf: unknown key \"self_shaddow\"; the nearest known key is \"self_shadow\"");
  EXPECT_EQ(scene_message(R"("camra": {})"), "f.json: unknown key \"camra\"; the nearest known key is \"camera\"");
  EXPECT_THAT(scene_message(R"("lights": [{}, {"color": [1,1,1]}])"),
              HasSubstr("/lights/1: unknown key \"color\"; the nearest known key is \"colour\""));
  EXPECT_THAT(scene_message(R"("material": {"ambiant": 1})"), HasSubstr("/material: unknown key \"ambiant\""));
  EXPECT_THAT(scene_message("\"" + std::string(100'000, 'x') + "\": 1"), HasSubstr("unknown key"));
}

TEST(HostileJson, ViolationsNamePointerValueAndWhatIsAllowed) {
  EXPECT_THAT(scene_message(R"("camera": {"fov_deg": 200})"),
              HasSubstr("f.json: /camera/fov_deg is 200; allowed: a number above 0 and below 170 (Vertical"));
  EXPECT_THAT(scene_message(R"("camera": {"eye": [0, 1]})"),
              HasSubstr("/camera/eye is [0,1]; allowed: an array of 3 values"));
  EXPECT_THAT(scene_message(R"("camera": {"eye": [0, "a", 1]})"),
              HasSubstr("/camera/eye/1 is \"a\"; allowed: a number"));
  EXPECT_THAT(scene_message(R"("clusters": 1.5)"), HasSubstr("/clusters is 1.5; allowed: a whole number"));
  EXPECT_THAT(scene_message(R"("clusters": null)"), HasSubstr("/clusters is null"));
  EXPECT_THAT(scene_message(R"("clusters": true)"), HasSubstr("/clusters is true"));
  EXPECT_THAT(scene_message(R"("clusters": 99999999999999999999)"), HasSubstr("/clusters is"));
  EXPECT_THAT(scene_message(R"("material": "purple")"),
              HasSubstr(R"(/material is "purple"; allowed: one of "black", "brown", "blond", "red", "grey")"));
  EXPECT_THAT(scene_message(R"("image": {"background": [0, 0]})"), HasSubstr("/image/background is [0,0]"));
  EXPECT_THAT(scene_message(R"("image": {"background": 3})"), HasSubstr("allowed: \"transparent\", or an array of 3"));
  EXPECT_THAT(scene_message(R"("satf": {"drift": 1})"), HasSubstr("/satf/drift is 1; allowed: true or false"));
  EXPECT_THAT(scene_message(R"("bake": {"seed": -1})"), HasSubstr("/bake/seed is -1; allowed: a whole number"));
  EXPECT_THAT(scene_message(R"("unit": "km")"), HasSubstr("one of \"m\", \"cm\", \"mm\", \"in\""));
}

TEST(HostileJson, VersionAndHairAreRequired) {
  const auto message = [](const char* text) {
    return message_of<InputError>([&] { validate(parse_json(text, "f"), "scene", "f"); });
  };
  EXPECT_THAT(message(R"({"hair": "x"})"), HasSubstr("key \"version\" is missing (1)"));
  EXPECT_THAT(message(R"({"version": 1})"), HasSubstr("key \"hair\" is missing"));
  EXPECT_THAT(message(R"({"version": 2, "hair": "x"})"), HasSubstr("/version is 2; allowed: 1"));
  EXPECT_THAT(message("[]"), HasSubstr("allowed: an object"));
  EXPECT_THAT(message("3"), HasSubstr("allowed: an object"));
  EXPECT_THAT(message_of<InputError>([] { bake_settings_from_json("{}", "f"); }), HasSubstr("\"version\" is missing"));
}

TEST(HostileJson, DuplicateKeysAndDepthBombsAreRefused) {
  EXPECT_THAT(parse_message(R"({"a": 1, "b": {"a": 2}, "a": 3})"), HasSubstr("key \"a\" is given twice"));
  EXPECT_THAT(parse_message(std::string(1'000'000, '[')), HasSubstr("nested deeper than 64 levels"));
  std::string objects;
  for (int i = 0; i < 100'000; ++i) objects += "{\"a\":";
  EXPECT_THAT(parse_message(objects), HasSubstr("nested deeper"));
  EXPECT_EQ(parse_message(std::string(64, '[') + std::string(64, ']')), "nothing was thrown");
}

TEST(HostileJson, MissingFileAndFolderAreRefused) {
  const test::TemporaryFolder folder;
  EXPECT_THAT(message_of<InputError>([&] { load_scene(folder / "no.json"); }), HasSubstr("there is no such file"));
  EXPECT_THAT(message_of<InputError>([&] { load_scene(folder / ""); }), HasSubstr("is a folder"));
}

TEST(NearestWord, HasTheSmallestEditDistance) {
  const std::vector<std::string> words = {"views", "lights", "samples"};
  EXPECT_EQ(nearest_word("light", words), "lights");
  EXPECT_EQ(nearest_word("veiws", words), "views");
  EXPECT_EQ(nearest_word("", words), "views");
  EXPECT_EQ(nearest_word("x", {}), "");
}

}  // namespace
}  // namespace pelage
