// How far a source of records is from the truth on a hairstyle's own sectors: alpha and radiance of each, seen and lit
// from evenly spread directions (DESIGN section 4).
#pragma once

#include <vector>

#include "pelage/data_schema/bake_settings.h"
#include "pelage/data_schema/hairstyle.h"
#include "pelage/db/record_source.h"
#include "pelage/db/sectors.h"

namespace pelage {

/// Whole tracks of a hairstyle, evenly spaced, with what turns optical depth into opacity.
struct SectorSample {
  SectorSet sectors;
  std::vector<glm::mat2> jacobians;  // [sector] plate plane [m] per (s, r)
  std::vector<char> used;            // [sector] holds strands
  std::vector<char> counted;         // [sector] is used, and its error counts
  int angle_pairs = 6;               // (view, light) pairs per sector, evenly spread
  double sigma = 0.05;               // of strands, sector coordinates
  double blocked_m = 0;              // opacity a times diameter D of the hairstyle's strands [m]
};

/// Which sectors' errors count.
enum class Counted {
  all,
  between  // on plates half-way between the hairstyle's own, which no bake has seen; the style's own are there too
};

/// @param sectors  about so many     @throws InputError where no strand crosses any
SectorSample sample_sectors(const Hairstyle& style, const BakeSettings& baked, int sectors, int angle_pairs,
                            Counted counted = Counted::all);

/// What a source shows of a sample.
struct SeenSectors {
  int samples = 0;                     // along s
  std::vector<float> alpha, radiance;  // [counted sector][pair][sample]; radiance is re alpha
  std::vector<float> along_r;          // [sector][sample] alpha seen along r; 0 of sectors without strands
  double evaluate_ms = 0;              // of alpha and radiance
};

/// @param source   attached to the sample's sectors
/// @param samples  interpolate to so many values along s; 0: the source's own
SeenSectors look(const RecordSource& source, const SectorSample& sample, int samples = 0);
/// Time to evaluate all that look() evaluates of the counted sectors [ms].
double evaluate_ms(const RecordSource& source, const SectorSample& sample);

/// Against the truth: another source's view of the same sample with as many samples along s.
struct RecordError {
  double radiance_rmse = 0;
  double radiance_rmse_error = 0;  // standard error of it, tracks being what varies: those of one are alike
  double radiance_bias = 0;        // mean of (seen - truth)
  double alpha_rmse = 0;
  double seam = 0;  // RMS change of `seen`'s alpha from plate to plate, along r, after moving by the drift
};
RecordError record_error(const SeenSectors& seen, const SeenSectors& truth, const SectorSample& sample);

}  // namespace pelage
