// Where hair grows on the parametric head: roots inside a hairline (forehead, temples, sideburns, above the ears,
// nape), evenly spaced in the neighbourhood. They are fewer along the hairline, which is soft, and at the lower back
// and sides, which hair from above covers.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "pelage/hair/head.h"

namespace pelage::hair {

struct Root {
  glm::vec3 position_m;
  glm::vec3 normal;  // of the scalp, outward
};

/// Centre from which directions on the skull are measured [m].
glm::vec3 skull_centre_m(const HeadParameters& head) noexcept;

/// The hairline: sine of the elevation above which hair grows in a direction (unit, from the centre).
float hairline_sine(glm::vec3 direction) noexcept;

/// Exactly `count` roots, from the crown downwards: a jittered Fibonacci lattice, of which some points are left out.
std::vector<Root> scalp_roots(const HeadParameters& head, const HeadField& field, std::uint32_t count,
                              std::uint64_t seed);

}  // namespace pelage::hair
