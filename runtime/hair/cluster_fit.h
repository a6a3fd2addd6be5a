// Fits clusters (generalized disks [Xu2006 section 3.2], DESIGN section 5) to any groom: k-means on resampled strands,
// least-squares centre lines (a principal curve: project the strands to the line, fit the line to them, repeat),
// cross-sections from the strands' spread in the plate planes. Each strand keeps its own curve in (t, x, y) with its
// own t-range. A strand that turns back against its centre line loses the part that does (counted). The same result,
// bit for bit, for any number of threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pelage/data_schema/cluster.h"
#include "pelage/data_schema/strands.h"

namespace pelage::hair {

struct FitSettings {
  int clusters = 150;       // at most; [1, 10000]
  std::uint64_t seed = 1;   // of the k-means++ seeding
  double coverage = 0.95;   // share of strand length that the envelopes shall hold, [0.5, 1]
  float diameter_m = 0.0F;  // no cross-section is thinner; 0: that of the strands, else the default of their number
};

struct ClusterReport {
  std::size_t strands = 0;
  float length_m = 0, radius_m = 0;  // of the centre line; mean over t of sqrt(a b)
  double inside = 0;                 // share of strand length inside the envelope
  double rms_m = 0;                  // distance of reconstructed strands from the originals
  std::size_t points = 0, cut_points = 0;
  int overlapping_plates = 0;  // of kReportPlates
};

struct FitReport {
  std::size_t strands = 0;     // that are in a cluster
  std::size_t dropped = 0;     // no length, or nowhere along their centre line
  std::size_t reassigned = 0;  // moved to a cluster that fits better than k-means' choice
  double inside = 0, rms_m = 0;
  std::size_t points = 0, cut_points = 0;  // vertices of the strands; those cut because t does not increase there
  int overlapping_plates = 0, plates = 0;
  std::vector<ClusterReport> clusters;
};

inline constexpr int kReportPlates = 24;  // plates per cluster at which overlaps are counted

struct ClusterFit {
  std::vector<Cluster> clusters;
  FitReport report;
};

/// Diameter of the strands [m]: their own, else the default for their number.
float drawn_diameter_m(const Strands& strands) noexcept;

/// @throws InputError for no strands, or one that is not finite; UsageError for settings out of range
ClusterFit fit_clusters(const Strands& strands, const FitSettings& settings);

}  // namespace pelage::hair
