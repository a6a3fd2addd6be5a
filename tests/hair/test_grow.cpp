// Roots on head meshes and strands grown on them: as many as asked for, even, on the scalp, outside of the head.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/glm.hpp>
#include <limits>

#include "pelage/data_schema/errors.h"
#include "pelage/hair/grow.h"
#include "pelage/hair/mesh_obj.h"
#include "pelage/hair/resample.h"
#include "pelage/simulate/mesh_distance.h"

namespace pelage::hair {
namespace {

using glm::vec3;

/// A head, what is known of its surface, and its skull.
struct Scalp {
  Mesh mesh;
  MeshDistance distance;
  Skull skull;
  DistanceField field;

  Scalp(Mesh head, float height_m, const vec3& face)
      : mesh(std::move(head)), distance(mesh, 0.005F), skull(find_skull(mesh, height_m, face)) {
    field = [this](vec3 p) {
      const SurfaceSample s = distance.sample(p);
      return HeadField::Sample{s.distance_m, s.normal};
    };
  }
  Scalp(const Scalp&) = delete;
  Scalp& operator=(const Scalp&) = delete;

  std::vector<Root> roots(std::uint32_t count, std::uint64_t seed = 1) const {
    return mesh_roots(mesh, skull, field, count, seed);
  }
};

const Scalp& parametric() {
  static const Scalp scalp(parametric_head({}), 0.24F, {0, 0, 1});
  return scalp;
}

float nearest_other(const std::vector<Root>& roots, std::size_t k) {
  float nearest = INFINITY;
  for (std::size_t i = 0; i < roots.size(); ++i)
    if (i != k) nearest = std::min(nearest, glm::distance(roots[i].position_m, roots[k].position_m));
  return nearest;
}

TEST(MeshRoots, FindTheParametricSkull) {
  EXPECT_LT(glm::distance(parametric().skull.centre_m, skull_centre_m({})), 0.012F);
}

TEST(MeshRoots, AreAsManyAsAskedOnTheSurfaceAndTheScalp) {
  for (const std::uint32_t count : {1U, 2U, 17U, 1000U, 5000U}) {
    const std::vector<Root> roots = parametric().roots(count);
    ASSERT_EQ(roots.size(), count);
    for (const Root& root : roots) {
      EXPECT_LT(std::abs(parametric().field(root.position_m).distance_m), 5e-4F);
      EXPECT_NEAR(glm::length(root.normal), 1, 1e-5);
      EXPECT_GT(glm::dot(root.normal, parametric().field(root.position_m + 0.005F * root.normal).gradient),
                0.5F);  // the folds behind ears
      EXPECT_TRUE(parametric().skull.grows_at(root.position_m));
    }
  }
}

TEST(MeshRoots, AreEvenByArea) {
  const std::vector<Root> roots = parametric().roots(1500);
  std::vector<float> gaps;
  for (std::size_t k = 0; k < roots.size(); ++k) gaps.push_back(nearest_other(roots, k));
  std::sort(gaps.begin(), gaps.end());
  // Random points have a tenth of their neighbours nearer than 0.39 of the median; darts keep a distance.
  EXPECT_GT(gaps.front(), 0.6F * gaps[gaps.size() / 2]);
  EXPECT_LT(gaps.back(), 2 * gaps[gaps.size() / 2]);
  // As many per area on a fine mesh as on one whose left half has four times the triangles.
  std::size_t left = 0;
  for (const Root& root : roots) left += root.position_m.x > 0;
  EXPECT_NEAR(static_cast<double>(left) / 1500, 0.5, 0.03);
}

TEST(MeshRoots, CoverTheScalpThatTheParametricHeadHas) {
  const std::vector<Root> mesh = parametric().roots(2000);
  const std::vector<Root> own = scalp_roots({}, HeadField({}), 2000, 1);
  // Nearly every root of the one has one of the other within three spacings.
  int missed = 0;
  for (const Root& a : own) {
    float nearest = INFINITY;
    for (const Root& b : mesh) nearest = std::min(nearest, glm::distance(a.position_m, b.position_m));
    missed += nearest > 0.018F;
  }
  EXPECT_LT(missed, 40);
}

TEST(MeshRoots, TurnWithTheFace) {
  Mesh turned = parametric().mesh;  // its face towards +X
  for (vec3& v : turned.vertices) v = {v.z, v.y, -v.x};
  for (vec3& n : turned.normals) n = {n.z, n.y, -n.x};
  const Scalp scalp(turned, 0.24F, parse_face("+x"));
  float behind = 0, before = 0;
  for (const Root& root : scalp.roots(800)) {
    behind = std::min(behind, root.position_m.x), before = std::max(before, root.position_m.x);
    if (root.position_m.x > 0.06F) {
      EXPECT_GT(root.position_m.y, 0.02F);  // no hair in the face
    }
  }
  EXPECT_LT(behind, -0.07F);
  EXPECT_THROW(parse_face("z"), UsageError);
}

TEST(MeshRoots, RefuseAMeshThatIsNoHead) {
  Mesh small = parametric().mesh;
  for (vec3& v : small.vertices) v *= 0.01F;
  EXPECT_THROW(find_skull(small, 0.24F, {0, 0, 1}), UsageError);
  EXPECT_THROW(find_skull(Mesh{}, 0.24F, {0, 0, 1}), UsageError);
  for (float height_m : {0.0F, -1.0F, NAN, 101.0F})
    EXPECT_THROW(find_skull(parametric().mesh, height_m, {0, 0, 1}), UsageError);
  Skull elsewhere = parametric().skull;
  elsewhere.centre_m += vec3(0, 5, 0);
  EXPECT_THROW(mesh_roots(parametric().mesh, elsewhere, parametric().field, 10, 1), InputError);
}

TEST(Grow, StaysOutsideAndKeepsItsLength) {
  const std::vector<Root> roots = parametric().roots(1000);
  for (const float length_m : {0.02F, 0.1F, 0.3F, 0.6F}) {
    for (const int vertices : {2, 5, 16, 64}) {
      const Strands s = grow(roots, parametric().skull, parametric().field, {length_m, vertices, 3});
      ASSERT_EQ(s.count(), roots.size());
      ASSERT_EQ(s.vertices.size(), roots.size() * static_cast<std::size_t>(vertices));
      int bent = 0;
      for (std::size_t i = 0; i < s.count(); ++i) {
        EXPECT_EQ(s.strand(i)[0], roots[i].position_m);
        for (const vec3& p : s.strand(i).subspan(1)) {
          ASSERT_TRUE(std::isfinite(p.x + p.y + p.z));
          EXPECT_GT(parametric().field(p).distance_m, 0) << length_m << " " << vertices << " strand " << i;
        }
        const double measured = arc_length_m(s.strand(i));
        EXPECT_LT(measured, 1.06 * static_cast<double>(length_m));
        bent += measured < 0.85 * static_cast<double>(length_m);
      }
      if (vertices >= 16) {  // chords of few vertices cut corners
        EXPECT_LT(bent, 20) << length_m << " " << vertices;
      }
    }
  }
}

TEST(Grow, HangsAtTheEnd) {
  const Strands s = grow(parametric().roots(500), parametric().skull, parametric().field, {0.4F, 32, 1});
  int down = 0;
  for (std::size_t i = 0; i < s.count(); ++i) {
    const auto points = s.strand(i);
    down += glm::normalize(points[31] - points[28]).y < -0.8F;
  }
  EXPECT_GT(down, 450);
}

TEST(Grow, DoesNotDependOnThreads) {
  const auto run = [](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return grow(parametric().roots(300), parametric().skull, parametric().field, {}).vertices;
  };
  const std::vector<vec3> one = run(1);
  for (const std::size_t threads : {2U, 3U, 8U}) EXPECT_EQ(run(threads), one) << threads;
  EXPECT_NE(parametric().roots(300, 2)[0].position_m, parametric().roots(300, 1)[0].position_m);
}

TEST(Grow, RefusesSettingsOutOfRange) {
  const std::vector<Root> roots = parametric().roots(1);
  for (const GrowSettings& bad : {GrowSettings{NAN, 16, 1}, {0.001F, 16, 1}, {3, 16, 1}, {0.1F, 1, 1}, {0.1F, 1001, 1}})
    EXPECT_THROW(grow(roots, parametric().skull, parametric().field, bad), UsageError);
}

TEST(Grow, OnARealHeadStaysOutside) {
  const std::filesystem::path file = PELAGE_SOURCE_DIR "/../shared/data/sintel/sintel.obj";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
  const Scalp scalp(read_obj(file), 0.24F, {0, 0, 1});
  const std::vector<Root> roots = scalp.roots(2000);
  const Strands s = grow(roots, scalp.skull, scalp.field, {0.3F, 16, 1});
  std::size_t inside = 0;
  for (std::size_t i = 0; i < s.count(); ++i)
    for (const vec3& p : s.strand(i).subspan(1)) inside += scalp.field(p).distance_m < 0;
  EXPECT_EQ(inside, 0U);
}

}  // namespace
}  // namespace pelage::hair
