// How densely a database covers the space of density features, and how well it covers the sectors of a hairstyle: the
// distance to the nearest record, which is what the lookup's error grows with.
//
// Distances are RMS over the features, in standard deviations of the records (FeatureScale): 1 means that an average
// feature is off by as much as records differ from their mean.
#pragma once

#include <vector>

#include "pelage/db/record_bank.h"
#include "pelage/db/sectors.h"

namespace pelage {

/// [record] distance to its nearest other record; 0 for a database of one.
std::vector<float> record_spacing(const RecordBank& bank);

/// [non-empty sector][dimension] unscaled features, as the database was baked with.
std::vector<float> used_sector_features(const RecordBank& bank, const SectorSet& sectors);

/// [point] distance of unscaled features to the nearest record.
std::vector<float> distances_to_records(const RecordBank& bank, std::vector<float> features);

/// Share of `distances` (of sectors) beyond what 95 % of the records are from each other.
double uncovered_share(const std::vector<float>& spacing, const std::vector<float>& distances);

/// Value below which a share `p` in [0, 1] of `values` lies; 0 without any.
float quantile(std::vector<float> values, double p);

}  // namespace pelage
