// What there is to know about a hair file before using it: counts, sizes, and what looks implausible. `pelage info
// FILE`.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "pelage/hair/hair_file.h"

namespace pelage::hair {

/// Of some quantity over strands, segments or roots.
struct Spread {
  double min = 0, p10 = 0, median = 0, p90 = 0, max = 0, mean = 0;
};

struct HairFacts {
  std::string format;
  std::size_t strands_in_file = 0, strands = 0, vertices = 0;
  Spread vertices_per_strand;
  glm::vec3 box_min_m{0}, box_max_m{0};
  Spread length_m, spacing_m;  // of strands; of neighbouring vertices
  double uneven = 0;           // median over strands of (longest - shortest segment) / mean segment
  Spread diameter_m;           // of the file, or the default for this count of strands (all equal)
  bool diameter_from_file = false;
  bool coloured = false;
  float opacity = kDefaultOpacity;
  bool opacity_from_file = false;
  std::optional<Spread> root_spacing_m;                  // from each root to the nearest other, where there is one
  std::size_t repeated_roots = 0, repeated_strands = 0;  // at the place of an earlier one
  std::vector<std::size_t> short_strands;                // kept strands shorter than 1 % of the mean (their index here)
  std::size_t dropped = 0, repaired = 0;                 // by the reader
  std::vector<StrandIssue> issues;                       // the first of them
  std::vector<std::string> remarks;                      // what looks implausible, in words
};

HairFacts hair_facts(const Strands& strands, const ReadReport& report, double metres_per_unit);

std::string to_text(const HairFacts& facts);
std::string to_json(const HairFacts& facts);

}  // namespace pelage::hair
