// Tangents, segments and their order, without OpenGL.
#include <gtest/gtest.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <random>

#include "pelage/render/strand_geometry.h"

namespace pelage {
namespace {

Strands strands_of(std::initializer_list<std::vector<glm::vec3>> all) {
  Strands strands;
  for (const auto& points : all) strands.append(points);
  return strands;
}

TEST(StrandGeometry, TangentsAreHalfWay) {
  const auto t = strand_tangents(strands_of({{{0, 0, 0}, {1, 0, 0}, {1, 5, 0}}, {{0, 0, 1}, {0, 0, 2}}}));
  const float h = std::sqrt(0.5F);
  const std::vector<glm::vec3> expected{{1, 0, 0}, {h, h, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 1}};
  for (std::size_t i = 0; i < t.size(); ++i) EXPECT_LT(glm::distance(glm::vec3(t[i]), expected[i]), 1e-6F) << i;
}

TEST(StrandGeometry, TangentsAreUnitWhateverThePoints) {
  const glm::vec3 p{0.1F, 1.6F, 0.2F}, tiny{1e-30F, 0, 0};
  const auto t = strand_tangents(strands_of({{p, p, p + glm::vec3(0.01F, 0, 0), p + glm::vec3(0.01F, 0, 0)},  // again
                                             {p, p + glm::vec3(0, 1, 0), p},                                  // back
                                             {p, p, p},
                                             {p},
                                             {},
                                             {tiny, 2.0F * tiny, glm::vec3(0)},
                                             {glm::vec3(-1e30F), glm::vec3(1e30F)}}));
  for (const glm::vec4& x : t) EXPECT_NEAR(glm::length(glm::vec3(x)), 1.0F, 1e-6F);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(glm::vec3(t[i]), glm::vec3(1, 0, 0)) << i;
}

TEST(StrandGeometry, SegmentsKnowTheirEnds) {
  const auto s = strand_segments(strands_of({{{}, {}, {}, {}}, {{}}, {}, {{}, {}}}));
  ASSERT_EQ(s.size(), 4U);
  EXPECT_EQ(s[0].vertex_and_flags, 0U | StrandSegment::kFirst);
  EXPECT_EQ(s[1].vertex_and_flags, 1U);
  EXPECT_EQ(s[2].vertex_and_flags, 2U | StrandSegment::kLast);
  EXPECT_EQ(s[3].vertex_and_flags, 5U | StrandSegment::kFirst | StrandSegment::kLast);
  EXPECT_EQ(s[3].strand, 3U);
}

TEST(StrandGeometry, SortIsThatOfTheLibrary) {
  std::mt19937 random(1);
  Strands strands;
  for (int i = 0; i < 20000; ++i) {
    const float z = i % 7 == 0 ? 0.25F : static_cast<float>(random() >> 8) * 0x1p-22F - 2.0F;  // before and behind
    strands.append(std::vector<glm::vec3>{{0, 0, z}, {0, 1, z}});
  }
  const auto segments = strand_segments(strands);
  const glm::vec3 eye{0, 0, 1}, forward{0, 0, -1};
  std::vector<StrandSegment> sorted(segments.size()), expected = segments;
  sort_by_depth(segments, strands.vertices, eye, forward, sorted);
  std::stable_sort(expected.begin(), expected.end(), [&](const StrandSegment& a, const StrandSegment& b) {
    return strands.vertices[a.first()].z < strands.vertices[b.first()].z;
  });
  for (std::size_t i = 0; i < sorted.size(); ++i) ASSERT_EQ(sorted[i].strand, expected[i].strand) << i;
  sort_by_depth({}, strands.vertices, eye, forward, {});
}

}  // namespace
}  // namespace pelage
