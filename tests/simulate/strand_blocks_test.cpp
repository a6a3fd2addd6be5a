#include "pelage/simulate/strand_blocks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "pelage/data_schema/errors.h"

namespace pelage {
namespace {

/// `n` strands of 2 to 20 vertices, in no order.
Strands mixed_strands(std::size_t n) {
  Strands strands;
  for (std::size_t s = 0; s < n; ++s) {
    const std::size_t vertices = 2 + (s * 7) % 19;
    std::vector<glm::vec3> points;
    for (std::size_t i = 0; i < vertices; ++i)
      points.push_back(
          {0.01F * static_cast<float>(s), 1.0F - 0.01F * static_cast<float>(i), 0.1F * static_cast<float>(s % 5)});
    strands.append(points);
  }
  return strands;
}

TEST(StrandBlocks, HoldEveryStrandOnceAndGiveItBack) {
  const Strands strands = mixed_strands(100);
  const glm::dvec3 pivot(0.3, 1.0, -0.2);
  const StrandBlocks blocks = make_blocks(strands, pivot);
  ASSERT_EQ(blocks.count(), 7U);
  Strands out = strands;
  for (glm::vec3& p : out.vertices) p = glm::vec3(NAN);
  world_positions(blocks, pivot, out);
  for (std::size_t v = 0; v < out.vertices.size(); ++v)
    for (int a = 0; a < 3; ++a) EXPECT_NEAR(out.vertices[v][a], strands.vertices[v][a], 2e-7F) << v;
}

TEST(StrandBlocks, KeepLanesOfOneBlockOfLikeLength) {
  const StrandBlocks blocks = make_blocks(mixed_strands(1600), glm::dvec3(0));
  std::size_t held = 0, used = 0;
  for (std::size_t b = 0; b < blocks.count(); ++b) {
    for (const float n : blocks.vertices[b].v) used += static_cast<std::size_t>(n);
    held += blocks.length(b) * kLanes;
  }
  EXPECT_LT(static_cast<double>(held), 1.05 * static_cast<double>(used));
}

TEST(StrandBlocks, RepeatTheTipBeyondAStrand) {
  const StrandBlocks blocks = make_blocks(mixed_strands(40), glm::dvec3(0));
  for (std::size_t b = 0; b < blocks.count(); ++b) {
    for (std::size_t l = 0; l < kLanes; ++l) {
      const auto count = static_cast<std::uint32_t>(blocks.vertices[b].v[l]);
      for (std::uint32_t i = std::max(count, 1U); i < blocks.length(b); ++i) {
        const Lanes3 &here = blocks.rest[blocks.first[b] + i], &tip = blocks.rest[blocks.first[b] + i - 1];
        EXPECT_EQ(here.y[l], tip.y[l]) << "block " << b << ", lane " << l;
      }
    }
  }
}

TEST(StrandBlocks, HoldNeighbours) {
  // 16 x 16 x 16 roots a centimetre apart: 16 of one block lie within 4 x 2 x 2 of them.
  Strands strands;
  for (int k = 0; k < 4096; ++k) {
    const glm::vec3 root(0.01F * static_cast<float>(k % 16), 0.01F * static_cast<float>(k / 16 % 16),
                         0.01F * static_cast<float>(k / 256));
    strands.append(std::vector<glm::vec3>{root, root + glm::vec3(0, 0.1F, 0)});
  }
  const StrandBlocks blocks = make_blocks(strands, glm::dvec3(0));
  for (std::size_t b = 0; b < blocks.count(); ++b) {
    const Lanes3& r = blocks.root_rest[b];
    float spread = 0;
    for (const float* axis : {r.x, r.y, r.z}) {
      const auto [low, high] = std::minmax_element(axis, axis + kLanes);
      spread += *high - *low;
    }
    EXPECT_LT(spread, 0.0501F) << "block " << b;
  }
}

TEST(StrandBlocks, RefuseWhatIsNotFiniteByStrand) {
  Strands strands = mixed_strands(5);
  strands.vertices[strands.offsets[3] + 1].y = NAN;
  try {
    make_blocks(strands, glm::dvec3(0));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("strand 3"), std::string::npos) << error.what();
  }
}

TEST(StrandBlocks, AreEmptyForNoStrands) {
  EXPECT_EQ(make_blocks(Strands{}, glm::dvec3(0)).count(), 0U);
}

}  // namespace
}  // namespace pelage
