#include "pelage/data_schema/mesh.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

namespace pelage {
namespace {

TEST(Mesh, NormalsAreWeightedByArea) {
  // Triangle 0 looks along z with area 2, triangle 1 along x with area 1; vertex 0 belongs to both.
  Mesh mesh{{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 1, 0}, {0, 0, 2}}, {}, {{0, 1, 2}, {0, 3, 4}}};
  compute_normals(mesh);
  const glm::vec3 expected = glm::normalize(glm::vec3(1, 0, 2));
  EXPECT_LT(glm::length(mesh.normals[0] - expected), 1e-6F);
  EXPECT_LT(glm::length(mesh.normals[1] - glm::vec3(0, 0, 1)), 1e-6F);
  EXPECT_LT(glm::length(mesh.normals[4] - glm::vec3(1, 0, 0)), 1e-6F);
}

TEST(Mesh, NormalsAreUnitOrUpWhereThereIsNoArea) {
  Mesh mesh{{{0, 0, 0}, {1e-12F, 0, 0}, {0, 1e-12F, 0}, {5, 5, 5}}, {}, {{0, 1, 2}, {3, 3, 3}}};
  compute_normals(mesh);
  for (const glm::vec3& n : mesh.normals) EXPECT_NEAR(glm::length(n), 1.0F, 1e-6F);
  EXPECT_EQ(mesh.normals[0], glm::vec3(0, 0, 1));
  EXPECT_EQ(mesh.normals[3], glm::vec3(0, 1, 0));
}

}  // namespace
}  // namespace pelage
