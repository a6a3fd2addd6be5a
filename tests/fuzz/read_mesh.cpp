// Harness of the mesh reader.
#include <cmath>
#include <glm/geometric.hpp>

#include "harness.h"
#include "pelage/hair/mesh_obj.h"

namespace pelage::fuzz {
namespace {

void check(const Mesh& mesh) {
  for (const glm::vec3& p : mesh.vertices)
    require(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z), "vertices are finite");
  require(mesh.normals.size() == mesh.vertices.size(), "one normal per vertex");
  for (const glm::vec3& n : mesh.normals) require(std::abs(glm::length(n) - 1.0F) < 1e-4F, "normals are unit vectors");
  require(!mesh.triangles.empty(), "there are triangles");
  for (const glm::uvec3& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) require(t[k] < mesh.vertices.size(), "triangles name vertices");
}

}  // namespace

void read_obj_mesh(std::string_view bytes) {
  const auto mesh = accepted([&] { return hair::parse_obj(bytes, "fuzz.obj"); });
  if (!mesh) return;
  check(*mesh);
  const std::filesystem::path file = scratch("again.obj");
  hair::write_obj(*mesh, file);
  const Mesh again = hair::read_obj(file);
  require(again.vertices == mesh->vertices && again.triangles == mesh->triangles,
          "written and read again it is the same");
}

}  // namespace pelage::fuzz
