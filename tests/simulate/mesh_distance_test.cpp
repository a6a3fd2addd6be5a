#include "pelage/simulate/mesh_distance.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <glm/common.hpp>
#include <random>
#include <sstream>

#include "pelage/data_schema/errors.h"
#include "test_meshes.h"

namespace pelage {
namespace {

using glm::dvec3;
using glm::vec3;

std::vector<vec3> random_points(unsigned seed, std::size_t n, float half_m) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> u(-half_m, half_m);
  std::vector<vec3> points(n);
  for (vec3& p : points) p = {u(random), u(random), u(random)};
  return points;
}

double to_segment(const dvec3& p, const dvec3& a, const dvec3& b) {
  const double sq = glm::dot(b - a, b - a);
  return glm::distance(p, a + (sq > 0 ? std::clamp(glm::dot(p - a, b - a) / sq, 0.0, 1.0) : 0.0) * (b - a));
}

/// A second route to the distance: the plane where the foot lies inside, else the edges.
double to_triangle(const dvec3& p, const dvec3& a, const dvec3& b, const dvec3& c) {
  const dvec3 n = glm::cross(b - a, c - a);
  if (glm::dot(glm::cross(b - a, p - a), n) >= 0 && glm::dot(glm::cross(c - b, p - b), n) >= 0 &&
      glm::dot(glm::cross(a - c, p - c), n) >= 0)
    return std::abs(glm::dot(p - a, n)) / glm::length(n);
  return std::min({to_segment(p, a, b), to_segment(p, b, c), to_segment(p, c, a)});
}

/// Exact distance; the side from the winding number [Oosterom1983], which knows no pseudonormals.
double brute_force(const Mesh& m, const dvec3& p) {
  double nearest = INFINITY, solid_angle = 0;
  for (const glm::uvec3& t : m.triangles) {
    const dvec3 a(m.vertices[t.x]), b(m.vertices[t.y]), c(m.vertices[t.z]);
    nearest = std::min(nearest, to_triangle(p, a, b, c));
    const dvec3 u = a - p, v = b - p, w = c - p;
    const double lu = glm::length(u), lv = glm::length(v), lw = glm::length(w);
    solid_angle += 2 * std::atan2(glm::dot(u, glm::cross(v, w)),
                                  lu * lv * lw + glm::dot(u, v) * lw + glm::dot(v, w) * lu + glm::dot(w, u) * lv);
  }
  return solid_angle > 6.283185307179586 ? -nearest : nearest;
}

/// A place of the grid near p, where the field has no interpolation.
vec3 node_near(const MeshDistance& field, const vec3& p) {
  return field.origin_m() + field.cell_m() * glm::round((p - field.origin_m()) / field.cell_m());
}

Mesh bumpy_mesh() {
  return round_mesh(
      4, [](vec3 d) { return 0.1F + 0.025F * std::sin(7 * d.x) * std::sin(5 * d.y + 1) + 0.02F * std::cos(9 * d.z); });
}

TEST(MeshDistance, OfASphereIsThatOfTheSphere) {
  const MeshDistance field(sphere_mesh(5, 0.1F), 0.005F);
  ASSERT_EQ(field.cell_m(), 0.005F);
  // Trilinear: cell^2 / 8 along each of two bent axes over 0.08 m: 78 um; chords of 8 * 4^5 triangles: up to 70 um.
  for (const vec3& p : random_points(1, 5000, 0.12F)) {
    const float r = glm::length(p);
    if (r < 0.08F) continue;
    const SurfaceSample s = field.sample(p);
    EXPECT_NEAR(s.distance_m, r - 0.1F, 1.6e-4F);
    EXPECT_GT(glm::dot(s.normal, p / r), 0.998F);  // 3.6 degrees: half a cell over the radius
  }
}

TEST(MeshDistance, OfABoxIsExactAtNodesToItsEdgesAndCorners) {
  const vec3 half(0.1F, 0.06F, 0.08F);
  const MeshDistance field(box_mesh(half), 0.01F);
  for (const vec3& q : random_points(2, 3000, 0.12F)) {
    const vec3 p = node_near(field, q), out = glm::abs(p) - half;
    if (std::max({out.x, out.y, out.z}) > 0.03F) continue;  // beyond the grid
    const float exact = glm::length(glm::max(out, vec3(0))) + std::min(std::max({out.x, out.y, out.z}), 0.0F);
    EXPECT_NEAR(field.sample(p).distance_m, exact, 2e-6F) << p.x << " " << p.y << " " << p.z;
  }
}

TEST(MeshDistance, AgreesWithBruteForceAtNodes) {
  const Mesh mesh = bumpy_mesh();
  const MeshDistance field(mesh, 0.004F);
  int inside = 0, off = 0;
  for (const vec3& q : random_points(3, 1500, 0.14F)) {
    const vec3 p = node_near(field, q);
    const double exact = brute_force(mesh, dvec3(p));
    if (exact > 0.02) continue;  // beyond the grid
    const double found = static_cast<double>(field.sample(p).distance_m);
    inside += exact < 0;
    if (std::abs(exact) < 2 * 0.004) {
      EXPECT_NEAR(found, exact, 1e-6);  // in the band: rounding of the node's place and the float
      continue;
    }
    EXPECT_EQ(found < 0, exact < 0);
    EXPECT_GE(std::abs(found), std::abs(exact) - 1e-6);  // of a triangle of the mesh, so never less
    EXPECT_LE(std::abs(found), 1.02 * std::abs(exact) + 1e-6);
    off += std::abs(found) > std::abs(exact) + 1e-6;
  }
  EXPECT_GT(inside, 200);
  EXPECT_LT(off, 30);  // of 1500: carried triangles are nearly always the nearest
}

TEST(MeshDistance, HasUnitNormalsAndKnowsTheWayOutside) {
  for (const Mesh& mesh : {bumpy_mesh(), box_mesh({0.1F, 0.1F, 0.1F}), sphere_mesh(0, 0.1F)}) {
    const MeshDistance field(mesh, 0.005F);
    std::vector<vec3> points = random_points(4, 3000, 0.3F);
    for (const vec3& p : {vec3(0), vec3(-0.0F), vec3(1e6F), vec3(0.1F), vec3(1e-38F), field.origin_m()})
      points.push_back(p);
    for (const vec3& p : points) {
      const SurfaceSample s = field.sample(p);
      ASSERT_TRUE(std::isfinite(s.distance_m));
      ASSERT_NEAR(glm::length(s.normal), 1, 2e-6);
      if (glm::length(p) > 0.2F) {
        EXPECT_GT(s.distance_m, 0);
      }
    }
    const SurfaceSample odd = field.sample({NAN, INFINITY, -INFINITY});
    EXPECT_NEAR(glm::length(odd.normal), 1, 2e-6);
  }
}

TEST(MeshDistance, NormalIsTheGradientOfTheDistance) {
  const MeshDistance field(bumpy_mesh(), 0.005F);
  const float e = 2e-5F;
  for (const vec3& p : random_points(10, 3000, 0.12F)) {
    const vec3 share = glm::fract((p - field.origin_m()) / field.cell_m());
    if (std::min({share.x, share.y, share.z}) < 0.02F || std::max({share.x, share.y, share.z}) > 0.98F) continue;
    const auto slope = [&](const vec3& way) {
      return field.sample(p + way).distance_m - field.sample(p - way).distance_m;
    };
    const vec3 gradient = vec3(slope({e, 0, 0}), slope({0, e, 0}), slope({0, 0, e})) / (2 * e);
    if (glm::length(gradient) < 0.3F) continue;  // a ridge: digits are lost
    EXPECT_LT(glm::distance(glm::normalize(gradient), field.sample(p).normal), 5e-3F);
  }
}

TEST(MeshDistance, LanesAreTheScalarSamples) {
  const MeshDistance field(bumpy_mesh(), 0.005F);
  for (unsigned seed = 0; seed < 300; ++seed) {
    const std::vector<vec3> points = random_points(seed, kLanes, seed % 3 == 0 ? 0.3F : 0.12F);
    Lanes3 lanes, normal;
    Lanes distance;
    float least = INFINITY;
    for (int l = 0; l < kLanes; ++l) {
      const vec3& p = points[static_cast<std::size_t>(l)];
      lanes.x[l] = p.x, lanes.y[l] = p.y, lanes.z[l] = p.z;
      least = std::min(least, field.sample(p).distance_m);
    }
    if (!field.sample(lanes, 0.01F, distance, normal)) {
      EXPECT_GT(least, 0.01F);
      continue;
    }
    for (int l = 0; l < kLanes; ++l) {
      const SurfaceSample s = field.sample(points[static_cast<std::size_t>(l)]);
      EXPECT_EQ(distance.v[l], s.distance_m);
      EXPECT_EQ(normal.x[l], s.normal.x);
      EXPECT_EQ(normal.y[l], s.normal.y);
      EXPECT_EQ(normal.z[l], s.normal.z);
    }
  }
  Lanes3 far, normal;
  std::fill_n(far.x, kLanes, 0.3F), std::fill_n(far.y, kLanes, 0.0F), std::fill_n(far.z, kLanes, 0.0F);
  Lanes distance;
  EXPECT_FALSE(field.sample(far, 0.1F, distance, normal));
  EXPECT_TRUE(field.sample(far, 0.3F, distance, normal));
}

TEST(MeshDistance, OpenMeshesAreRightNearTheSurfaceAndClosedByACap) {
  const float radius = 0.1F, cell = 0.005F;
  const Mesh bowl = cut(sphere_mesh(4, radius), [](vec3 c) { return c.y < -0.05F; });
  const MeshDistance field(bowl, cell);
  for (const vec3& q : random_points(5, 5000, 1)) {
    const vec3 d = glm::normalize(q);
    if (d.y < -0.35F) continue;
    for (float off : {-0.004F, -0.002F, 0.002F, 0.004F, 0.01F})
      EXPECT_NEAR(field.sample((radius + off) * d).distance_m, off, 4e-4F) << d.y << " " << off;
  }
  // The distance nowhere jumps: along lines through everything, it changes by little more than the way.
  for (const vec3& d : random_points(6, 300, 1)) {
    const vec3 along = 0.001F * glm::normalize(d);
    float last = field.sample(-150.0F * along).distance_m;
    for (int k = -149; k < 150; ++k) {
      const float next = field.sample(static_cast<float>(k) * along).distance_m;
      EXPECT_LT(std::abs(next - last), 0.002F) << k;
      last = next;
    }
  }
  EXPECT_LT(field.sample({0, 0, 0}).distance_m, -0.03F);
  EXPECT_GT(field.sample({0, -0.09F, 0}).distance_m, 0);
}

TEST(MeshDistance, OneTriangleHasTwoSides) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {0, 0, 0.1F}, {0.1F, 0, 0}};  // its front looks up
  mesh.triangles = {{0, 1, 2}};
  const MeshDistance field(mesh, 0.005F);
  EXPECT_NEAR(field.sample({0.03F, 0.01F, 0.03F}).distance_m, 0.01F, 1e-4F);
  EXPECT_NEAR(field.sample({0.03F, -0.004F, 0.03F}).distance_m, -0.004F, 1e-4F);
  EXPECT_GT(field.sample({0.03F, 0.01F, 0.03F}).normal.y, 0.99F);
  EXPECT_GT(field.sample({0.03F, -0.02F, 0.03F}).distance_m, 0);  // a slab of two cells, then outside again
  EXPECT_GT(field.sample({0.3F, -0.001F, 0.3F}).distance_m, 0.1F);
}

TEST(MeshDistance, ManyTrianglesOnOneSideOfASpikeDoNotTiltItsTip) {
  // A spike of four faces, one of which is a fan of 40: the normals' plain sum at the tip looks to that side and calls
  // what is beside the tip inside; weighted by angles it looks up.
  Mesh spike;
  spike.vertices = {{0, 0.1F, 0}, {-0.02F, -0.1F, -0.02F}, {-0.02F, -0.1F, 0.02F}};
  for (int k = 0; k <= 40; ++k) spike.vertices.push_back({0.02F, -0.1F, 0.02F - 0.001F * static_cast<float>(k)});
  spike.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 43, 1}, {1, 43, 2}};
  for (std::uint32_t k = 3; k < 43; ++k) {
    spike.triangles.emplace_back(0, k, k + 1);
    spike.triangles.emplace_back(2, k + 1, k);
  }
  const MeshDistance field(spike, 0.002F);
  for (const vec3& way : {vec3(-1, 0.2F, 0), vec3(1, 0.2F, 0), vec3(-0.7F, 0.2F, 0.7F), vec3(0, 1, 0)})
    EXPECT_NEAR(field.sample(vec3(0, 0.1F, 0) + 0.006F * glm::normalize(way)).distance_m, 0.006F, 4e-4F);
}

TEST(MeshDistance, NeedlesAndTwinsChangeNothing) {
  Mesh mesh = sphere_mesh(3, 0.1F);
  const MeshDistance clean(mesh, 0.01F);
  const std::size_t n = mesh.triangles.size();
  for (std::size_t t = 0; t < n; t += 5) {
    mesh.triangles.emplace_back(mesh.triangles[t].x, mesh.triangles[t].x, mesh.triangles[t].y);  // no area
    mesh.triangles.push_back(mesh.triangles[t]);                                                 // twice
  }
  const MeshDistance dirty(mesh, 0.01F);
  for (const vec3& p : random_points(7, 2000, 0.13F)) EXPECT_EQ(dirty.sample(p).distance_m, clean.sample(p).distance_m);
}

TEST(MeshDistance, TurnsASolidThatIsInsideOut) {
  Mesh mesh = bumpy_mesh();
  const MeshDistance right(mesh, 0.01F);
  for (glm::uvec3& t : mesh.triangles) std::swap(t.y, t.z);
  const MeshDistance turned(mesh, 0.01F);
  for (const vec3& p : random_points(8, 500, 0.13F)) EXPECT_EQ(turned.sample(p).distance_m, right.sample(p).distance_m);
}

TEST(MeshDistance, OfNothingIsFar) {
  EXPECT_TRUE(MeshDistance(Mesh{}, 0.005F).empty());
  Mesh flat;
  flat.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  flat.triangles = {{0, 1, 2}, {1, 1, 1}};
  const MeshDistance field(flat, 0.005F);
  EXPECT_TRUE(field.empty());
  EXPECT_GT(field.sample({0, 0, 0}).distance_m, 1e5F);
}

TEST(MeshDistance, RefusesWhatIsNotFiniteOrOutOfRange) {
  Mesh mesh = sphere_mesh(0, 1);
  mesh.vertices[3].y = NAN;
  EXPECT_THROW(MeshDistance(mesh, 0.005F), InputError);
  mesh = sphere_mesh(0, 1);
  mesh.triangles[1].z = 99;
  EXPECT_THROW(MeshDistance(mesh, 0.005F), InputError);
}

TEST(MeshDistance, TakesLargerCellsRatherThanMoreThanItsMemory) {
  Mesh sheet;  // long and thin: many cells, few of them near the surface
  sheet.vertices = {{0, 0, 0}, {0, 0, 0.01F}, {40000, 0, 0}};
  sheet.triangles = {{0, 1, 2}};
  const MeshDistance field(sheet, 0.005F);
  EXPECT_GT(field.cell_m(), 0.005F);
  EXPECT_LE(field.nodes(), MeshDistance::kMostNodes);
}

TEST(MeshDistance, HasTheSameBitsForAnyNumberOfThreads) {
  const Mesh mesh = cut(bumpy_mesh(), [](vec3 c) { return c.y < -0.07F; });
  const std::vector<vec3> points = random_points(9, 20000, 0.14F);
  const auto values = [&](int threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    tbb::task_arena arena(threads);
    std::vector<float> found;
    arena.execute([&] {
      const MeshDistance field(mesh, 0.006F);
      for (const vec3& p : points) found.push_back(field.sample(p).distance_m);
    });
    return found;
  };
  const std::vector<float> one = values(1);
  for (int threads : {2, 3, 8}) {
    const std::vector<float> many = values(threads);
    EXPECT_EQ(std::memcmp(one.data(), many.data(), one.size() * sizeof(float)), 0) << threads;
  }
}

/// Vertices and polygons of an OBJ, enough for the files here (this box knows no file formats).
Mesh read_mesh(const std::filesystem::path& file) {
  Mesh mesh;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string keyword, corner;
    words >> keyword;
    if (keyword == "v") {
      vec3 p;
      words >> p.x >> p.y >> p.z;
      mesh.vertices.push_back(p);
    } else if (keyword == "f") {
      std::vector<std::uint32_t> corners;
      while (words >> corner) corners.push_back(static_cast<std::uint32_t>(std::stoul(corner)) - 1);
      for (std::size_t k = 2; k < corners.size(); ++k)
        mesh.triangles.emplace_back(corners[0], corners[k - 1], corners[k]);
    }
  }
  return mesh;
}

TEST(MeshDistance, OfARealHeadIsRightNextToItsSkull) {
  for (const char* name : {"sintel.obj", "sintel-collider.obj"}) {
    const std::filesystem::path file = std::filesystem::path(PELAGE_SOURCE_DIR "/../shared/data/sintel") / name;
    if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
    Mesh mesh = read_mesh(file);
    vec3 low(INFINITY), high(-INFINITY);
    for (const vec3& v : mesh.vertices) low = glm::min(low, v), high = glm::max(high, v);
    const float to_m = 0.3F / (high.y - low.y);
    for (vec3& v : mesh.vertices) v *= to_m;
    const auto begin = std::chrono::steady_clock::now();
    const MeshDistance field(mesh, 0.005F);
    const double build_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    std::printf("%s: %zu triangles, %zu nodes of %.1f mm in %.3f s\n", name, mesh.triangles.size(), field.nodes(),
                1000.0 * static_cast<double>(field.cell_m()), build_s);
    EXPECT_LT(build_s, 10);  // a sanitizer's build on a busy machine; 0.1 s otherwise
    // Where the triangle in question is the nearest surface and its neighbourhood is smooth on the scale of a cell.
    int right = 0, asked = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); t += 11) {
      const dvec3 a(mesh.vertices[mesh.triangles[t].x]), b(mesh.vertices[mesh.triangles[t].y]),
          c(mesh.vertices[mesh.triangles[t].z]);
      const dvec3 n = glm::cross(b - a, c - a);
      if (!(glm::length(n) > 0)) continue;
      for (double off_m : {0.004, -0.004}) {
        const dvec3 p = (a + b + c) / 3.0 + off_m * glm::normalize(n);
        if (std::abs(std::abs(brute_force(mesh, p)) - 0.004) > 1e-5) continue;
        right += std::abs(static_cast<double>(field.sample(vec3(p)).distance_m) - off_m) < 0.0015;
        ++asked;
      }
    }
    EXPECT_GT(asked, 50);
    EXPECT_GE(right, asked * 95 / 100) << name << " " << asked;
  }
}

}  // namespace
}  // namespace pelage
