// The straightforward version of DFTL, to measure against: particles as structures, one strand after the other, three
// passes as [Mueller2012] and [Almeida2014 Algorithm 1 and eq. 3.1] write them.
#pragma once

#include <glm/geometric.hpp>
#include <vector>

#include "pelage/data_schema/strands.h"

namespace paper {

struct ChainParticle {
  glm::vec3 x, p, v, d;
};
struct Strand {
  std::vector<ChainParticle> particles;
  float length;  // of a segment [m]
};

inline std::vector<Strand> strands_of(const pelage::Strands& hair) {
  std::vector<Strand> result;
  for (std::size_t s = 0; s < hair.count(); ++s) {
    const auto strand = hair.strand(s);
    Strand plain{{}, glm::distance(strand[0], strand[1])};
    for (const glm::vec3& p : strand) plain.particles.push_back({p, p, {}, {}});
    result.push_back(std::move(plain));
  }
  return result;
}

inline void step_chains(std::vector<Strand>& strands, float dt, float s_damping) {
  const glm::vec3 gravity(0, -9.81F, 0);
  for (Strand& strand : strands) {
    auto& q = strand.particles;
    for (std::size_t i = 1; i < q.size(); ++i) q[i].p = q[i].x + dt * q[i].v + dt * dt * gravity;
    for (std::size_t i = 1; i < q.size(); ++i) {
      const glm::vec3 wish = q[i].p;
      q[i].p = q[i - 1].p + strand.length * glm::normalize(q[i].p - q[i - 1].p);
      q[i].d = q[i].p - wish;
    }
    for (std::size_t i = 1; i < q.size(); ++i) {
      q[i].v = (q[i].p - q[i].x) / dt;
      if (i + 1 < q.size()) q[i].v += s_damping * -q[i + 1].d / dt;
      q[i].x = q[i].p;
    }
  }
}

}  // namespace paper
