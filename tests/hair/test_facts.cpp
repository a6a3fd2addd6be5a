// Facts of a hair file: counts, and what looks implausible.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <glm/glm.hpp>
#include <nlohmann/json.hpp>

#include "pelage/hair/facts.h"
#include "pelage/hair/groom.h"

namespace pelage::hair {
namespace {

using testing::Contains;
using testing::HasSubstr;
namespace fs = std::filesystem;

Strands hanging(glm::vec3 down, int count) {
  Strands s;
  for (int i = 0; i < count; ++i) {
    const glm::vec3 root = 0.01F * static_cast<float>(i) * glm::vec3(1, 1, 1);
    s.append(std::vector<glm::vec3>{root, root + 0.05F * down, root + 0.10F * down});
  }
  return s;
}

TEST(Facts, CountsAndSizes) {
  const HairFacts f = hair_facts(hanging({0, -1, 0}, 11), {.format = "HAIR", .strands_in_file = 12}, 1.0);
  EXPECT_EQ(f.strands, 11U);
  EXPECT_EQ(f.vertices, 33U);
  EXPECT_NEAR(f.length_m.median, 0.1, 1e-7);
  EXPECT_NEAR(f.spacing_m.max, 0.05, 1e-7);
  EXPECT_NEAR(f.root_spacing_m->median, 0.01 * std::sqrt(3.0), 1e-7);
  EXPECT_NEAR(f.box_max_m.x, 0.1F, 1e-7F);
  EXPECT_EQ(f.repeated_roots, 0U);
}

TEST(Facts, EveryRootHasItsNearest) {
  Strands s;
  for (const glm::vec3 root : {glm::vec3(0, 0, 0), {0, 0.01F, 0}, {1, 0, 0}})
    s.append(std::vector<glm::vec3>{root, root - glm::vec3(0, 0.1F, 0)});
  const std::string text = to_text(hair_facts(s, {}, 1.0));
  EXPECT_THAT(text, HasSubstr("root spacing        min 10, 10% 10, median 10, 90% 1000, max 1000 mm")) << text;
  EXPECT_EQ(nlohmann::json::parse(to_json(hair_facts(s, {}, 1.0)))["root_spacing_m"]["max"], 1.0);
}

TEST(Facts, ASingleStrandHasNoRootSpacing) {
  const HairFacts f = hair_facts(hanging({0, -1, 0}, 1), {}, 1.0);
  EXPECT_THAT(to_text(f), testing::Not(HasSubstr("root spacing")));
  EXPECT_TRUE(nlohmann::json::parse(to_json(f))["root_spacing_m"].is_null());
}

TEST(Facts, GuessesTheUpAxisAndNamesShortAndRepeatedStrands) {
  Strands s = hanging({0, 0, -1}, 5);
  s.append(std::vector<glm::vec3>{{1, 1, 1}, {1, 1, 1.0001F}});
  s.append(std::vector<glm::vec3>{{1, 1, 1}, {1, 1, 1.0001F}});
  const HairFacts f = hair_facts(s, {}, 1.0);
  EXPECT_THAT(f.short_strands, testing::ElementsAre(5, 6));
  EXPECT_EQ(f.repeated_strands, 1U);
  EXPECT_THAT(f.remarks, Contains(HasSubstr("--up z")));
  EXPECT_THAT(f.remarks, Contains(HasSubstr("5, 6")));
}

TEST(Facts, ProposesAUnit) {
  Strands s = hanging({0, -1, 0}, 3);
  for (glm::vec3& p : s.vertices) p *= 1000;
  EXPECT_THAT(hair_facts(s, {}, 1.0).remarks, Contains(HasSubstr("--unit mm")));
}

TEST(Facts, AGroomIsPlausible) {
  const HairFacts f = hair_facts(groom({.strands = 1500}), {}, 1.0);
  EXPECT_TRUE(f.remarks.empty()) << f.remarks.front();
}

TEST(Facts, JsonIsWellFormed) {
  const HairFacts f = hair_facts(hanging({0, -1, 0}, 3), {.format = "HAIR", .issues = {{7, true, "NaN"}}}, 1.0);
  const nlohmann::json json = nlohmann::json::parse(to_json(f));
  EXPECT_EQ(json["strands"], 3);
  EXPECT_EQ(json["issues"][0]["strand"], 7);
  EXPECT_THAT(to_text(f), HasSubstr("strand 7 dropped"));
}

TEST(Facts, NamesRatboysShortStrands) {
  const fs::path file = PELAGE_SOURCE_DIR "/../shared/data/ratboy/Ratboy_mohawk.tfx";
  if (!fs::exists(file)) GTEST_SKIP() << file << " is not here";
  ReadReport report;
  const Strands s = read_hair(file, {}, &report);
  EXPECT_EQ(hair_facts(s, report, 1.0).short_strands.size(), 9U);
}

}  // namespace
}  // namespace pelage::hair
