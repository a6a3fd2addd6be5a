// OBJ: polygons, negative indices, hostile text; and the parametric head, which is written with it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <glm/glm.hpp>
#include <map>
#include <random>

#include "../data_schema/temporary.h"
#include "pelage/data_schema/errors.h"
#include "pelage/hair/head.h"
#include "pelage/hair/mesh_obj.h"

namespace pelage::hair {
namespace {

namespace fs = std::filesystem;

constexpr const char* kQuad =
    "# a square\r\nv 0 0 0\nv 1 0 0 1.0\nv 1 1 0\nv 0 1 0\nvt 0 0\nusemtl x\nf 1/1 2/1/1 3//1 4\nf -4 -3 -2\n";

TEST(MeshObj, TriangulatesPolygonsAndCountsBackwards) {
  const Mesh mesh = parse_obj(kQuad, "x.obj");
  EXPECT_EQ(mesh.vertices.size(), 4U);
  EXPECT_EQ(mesh.triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {0, 2, 3}, {0, 1, 2}}));
  for (const glm::vec3& n : mesh.normals) EXPECT_NEAR(n.z, 1.0F, 1e-6F);
}

TEST(MeshObj, ReadsContinuedLinesCommentsAndAByteOrderMark) {
  const Mesh mesh = parse_obj(
      "\xEF\xBB\xBFv 0 0 0# C:\\\nv 1 0 \\\n 0\nv 1 1 0 # 9\nv 0 1 +0\nf 1 2 3 \\\r\n4 # the square\nf -4 -3 +3",
      "x.obj");
  EXPECT_EQ(mesh.vertices.size(), 4U);
  EXPECT_EQ(mesh.triangles, (std::vector<glm::uvec3>{{0, 1, 2}, {0, 2, 3}, {0, 1, 2}}));
}

TEST(MeshObj, RefusesWithTheLine) {
  const auto refuses = [](const std::string& line) {
    EXPECT_THAT([&] { parse_obj("v 0 0 0\nv 1 0 0\nv 0 1 0\n" + line + "\nf 1 2 3\n", "x.obj"); },
                testing::ThrowsMessage<InputError>(testing::HasSubstr("line 4")))
        << line;
  };
  for (const char* bad :
       {"f 1 2 4", "f 0 1 2", "f 1 2 -4", "f 1 2", "f", "f 1 2 99999999999999999999", "f a b c", "v 1 2", "v nan 0 0",
        "v inf 0 0", "v 1e30 0 0", "v 1 2 x", "f 1 2 4294967297", "v 1e99 0 0"}) {
    refuses(bad);
  }
  EXPECT_THROW(parse_obj("", "x.obj"), InputError);
}

TEST(MeshObj, SurvivesTruncationAndFlips) {
  const std::string whole = kQuad;
  std::mt19937 random(3);
  const auto attempt = [](std::string_view text) {
    try {
      const Mesh mesh = parse_obj(text, "x.obj");
      for (const glm::uvec3& t : mesh.triangles) ASSERT_LT(std::max({t.x, t.y, t.z}), mesh.vertices.size());
    } catch (const InputError&) {
    }
  };
  for (std::size_t n = 0; n < whole.size(); ++n) attempt(std::string_view(whole).substr(0, n));
  for (int round = 0; round < 5000; ++round) {
    std::string text = whole;
    text[random() % text.size()] ^= static_cast<char>(1 << (random() % 8));
    attempt(text);
  }
}

TEST(MeshObj, WritesWhatItReads) {
  const Mesh mesh = parametric_head({});
  const test::TemporaryFolder folder;
  const fs::path file = folder / "head.obj";
  write_obj(mesh, file);
  const Mesh read = read_obj(file);
  EXPECT_EQ(read.vertices, mesh.vertices);
  EXPECT_EQ(read.triangles, mesh.triangles);
}

TEST(MeshObj, ReadsTheSintelBust) {
  const fs::path file = PELAGE_SOURCE_DIR "/../shared/data/sintel/sintel.obj";
  if (!fs::exists(file)) GTEST_SKIP() << file << " is not here";
  EXPECT_EQ(read_obj(file).vertices.size(), 3'046U);
}

TEST(Head, MeshIsClosedAndFacesOutwards) {
  const Mesh mesh = parametric_head({});
  EXPECT_GT(mesh.triangles.size(), 20'000U);
  EXPECT_LT(mesh.triangles.size(), 35'000U);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  double volume_m3 = 0;
  for (const glm::uvec3& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
    const glm::dvec3 a(mesh.vertices[t.x]), b(mesh.vertices[t.y]), c(mesh.vertices[t.z]);
    volume_m3 += glm::dot(a, glm::cross(b, c)) / 6;
  }
  for (const auto& [edge, count] : edges) {  // each edge once in each direction
    ASSERT_EQ(count, 1);
    ASSERT_EQ(edges.count({edge.second, edge.first}), 1U);
  }
  // An adult's head and neck have 4 to 5 litres, shoulders and chest of this bust 6; positive: counter-clockwise
  // outside.
  EXPECT_GT(volume_m3, 9.0e-3);
  EXPECT_LT(volume_m3, 13.0e-3);
}

TEST(Head, TrianglesAroundAVertexMakeOneFan) {
  const Mesh mesh = parametric_head({});
  std::vector<std::map<std::uint32_t, std::uint32_t>> next(mesh.vertices.size());  // around each vertex
  for (const glm::uvec3& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) next[t[k]][t[(k + 1) % 3]] = t[(k + 2) % 3];
  for (const auto& around : next) {
    ASSERT_GE(around.size(), 3U);
    std::size_t steps = 0;
    std::uint32_t at = around.begin()->first;
    do {
      ASSERT_EQ(around.count(at), 1U);
      at = around.at(at);
      ++steps;
    } while (at != around.begin()->first && steps <= around.size());
    ASSERT_EQ(steps, around.size());
  }
}

/// Half of the mesh's width between two heights.
float half_width_m(const Mesh& mesh, float from_m, float to_m) {
  float widest = 0;
  for (const glm::vec3& p : mesh.vertices)
    if (p.y > from_m && p.y < to_m) widest = std::max(widest, std::abs(p.x));
  return widest;
}

TEST(Head, IsABustWithShoulders) {
  const Mesh mesh = parametric_head({});
  EXPECT_NEAR(half_width_m(mesh, -0.115F, -0.105F), 0.050F, 0.012F);  // a slender neck
  EXPECT_NEAR(half_width_m(mesh, -0.26F, -0.20F), 0.190F, 0.010F);
  EXPECT_LT(half_width_m(mesh, -1.0F, -0.335F), 0.06F);  // rounded off below
  float lowest = 1, highest = -1;
  for (const glm::vec3& p : mesh.vertices) lowest = std::min(lowest, p.y), highest = std::max(highest, p.y);
  EXPECT_NEAR(highest, 0.116F, 1e-3F);  // the crown stays where it was: hairline and skull_centre_m() rely on it
  EXPECT_NEAR(lowest, -0.340F, 2e-3F);
}

TEST(Head, IsMirrored) {
  for (const glm::vec3& p : parametric_head({}).vertices)
    ASSERT_EQ(head_distance_m({}, p), head_distance_m({}, {-p.x, p.y, p.z}));
}

TEST(Head, VerticesLieOnTheFieldAndNormalsPointOut) {
  const HeadParameters head;
  const Mesh mesh = parametric_head(head);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    ASSERT_NEAR(head_distance_m(head, mesh.vertices[i]), 0.0F, 3e-4F);
    ASSERT_NEAR(glm::length(mesh.normals[i]), 1.0F, 1e-5F);
    ASSERT_GT(head_distance_m(head, mesh.vertices[i] + 1e-3F * mesh.normals[i]), 0.0F);
  }
}

TEST(Head, ScalesAndRefusesNonsense) {
  EXPECT_NEAR(head_distance_m({.height_m = 0.48F}, {0, 0.5F, 0}), 2 * head_distance_m({}, {0, 0.25F, 0}), 1e-6F);
  for (const float bad : {0.0F, -1.0F, NAN, HUGE_VALF}) EXPECT_THROW(parametric_head({.height_m = bad}), UsageError);
}

TEST(Head, SampledFieldAgrees) {
  const HeadField field{HeadParameters{}};
  std::mt19937 random(1);
  std::uniform_real_distribution<float> u(-0.1F, 0.1F);
  for (int k = 0; k < 60'000; ++k) {
    const glm::vec3 p{2 * u(random), -0.115F + 2.3F * u(random), u(random)};
    const float exact = head_distance_m({}, p);
    if (std::abs(exact) < 0.01F) {
      ASSERT_NEAR(field.sample(p).distance_m, exact, 2.0e-3F);
    }
  }
  EXPECT_GT(field.sample({5, 5, 5}).distance_m, 4.0F);
}

}  // namespace
}  // namespace pelage::hair
