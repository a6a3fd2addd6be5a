// Chains for tests: strands of equal segments, stepped without grid.
#pragma once

#include <cmath>
#include <vector>

#include "pelage/simulate/chain_step.h"
#include "pelage/simulate/hanging_chain.h"

namespace pelage {

/// A strand of `links` equal links from `root` along `direction`.
inline std::vector<glm::vec3> straight_chain(int links, float length_m, glm::vec3 direction = {0, -1, 0},
                                             glm::vec3 root = {0, 0, 0}) {
  std::vector<glm::vec3> points;
  for (int i = 0; i <= links; ++i)
    points.push_back(root + direction * (length_m * static_cast<float>(i) / static_cast<float>(links)));
  return points;
}

inline StrandBlocks one_chain(const std::vector<glm::vec3>& points) {
  Strands strands;
  strands.append(points);
  return make_blocks(strands, glm::dvec3(0));
}

inline void step_all(StrandBlocks& blocks, const ChainStep& step) {
  std::vector<float> fastest(blocks.count());
  step_chains(blocks, 0, blocks.count(), step, fastest);
}

inline glm::vec3 at(const StrandBlocks& blocks, std::size_t strand, std::uint32_t vertex) {
  const std::uint32_t k = blocks.block_of[strand];
  const Lanes3& p = blocks.position[blocks.first[k / kLanes] + vertex];
  return {p.x[k % kLanes], p.y[k % kLanes], p.z[k % kLanes]};
}

inline ChainStep undamped(double step_s) {
  ChainStep step;
  step.step_s = static_cast<float>(step_s);
  step.chain.damping_per_s = 0;
  return step;
}

/// Greatest relative error of a segment's length.
inline double worst_stretch(const StrandBlocks& blocks) {
  double worst = 0;
  for (std::size_t s = 0; s < blocks.strands; ++s) {
    const std::uint32_t k = blocks.block_of[s];
    const double rest = static_cast<double>(blocks.segment_m[k / kLanes].v[k % kLanes]);
    if (rest <= 0) continue;
    for (std::uint32_t i = 1; i < static_cast<std::uint32_t>(blocks.vertices[k / kLanes].v[k % kLanes]); ++i) {
      const glm::dvec3 d = glm::dvec3(at(blocks, s, i)) - glm::dvec3(at(blocks, s, i - 1));
      worst = std::fmax(worst, std::abs(std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z) / rest - 1));
    }
  }
  return worst;
}

}  // namespace pelage
