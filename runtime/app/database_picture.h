// A database as a picture: what its records look like, where in feature space they lie, and where they lie thin.
#pragma once

#include <string>
#include <vector>

#include "pelage/db/coverage.h"
#include "pelage/db/record_bank.h"
#include "pelage/image/image.h"

namespace pelage::app {

/// What the picture shows besides the records; distances as in db/coverage.h.
struct CoverageShown {
  std::vector<float> spacing;           // [record] to the nearest other record
  std::string hairstyle;                // name, or empty: the next two are empty
  std::vector<float> sector_features;   // [sector][dimension], unscaled
  std::vector<float> sector_distances;  // [sector] to the nearest record
};

/// Records far from all others, the farthest first.
std::vector<std::uint32_t> thinnest(const std::vector<float>& spacing, std::size_t count);

/// Cards of records (strands; opacity, and reflectance lit from the viewer and from the side, over views and s) from
/// sparse to dense and of the thinnest places; scatter plots of feature pairs, coloured by spacing; distances.
Image draw_database(const RecordBank& bank, const std::string& name, const CoverageShown& coverage);

}  // namespace pelage::app
