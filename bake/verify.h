// How far a database is from the truth: records traced again, and the accuracy ladder on a hairstyle (DESIGN section
// 4).
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "pelage/data_schema/hairstyle.h"
#include "pelage/db/record_bank.h"

namespace pelage {

struct RetraceResult {
  std::uint64_t records = 0;
  double worst_tau = 0, worst_re = 0;  // largest difference, in units of what the storage allows; <= 1: as baked
};
/// Traces `count` evenly spaced records of the database again from their stored strands.
RetraceResult retrace(const DatabaseReader& reader, std::uint64_t count);

/// One rung of the ladder against direct tracing of the same sectors.
struct LadderRung {
  std::string name;
  double radiance_rmse = 0;  // of re alpha, alpha = 1 - exp(-tau c / c0) at each sector's c
  double radiance_bias = 0;  // mean of (rung - direct)
  double alpha_rmse = 0;
  double seam = 0;         // RMS change of alpha from plate to plate, seen along r, after moving by the drift
  double attach_ms = 0;    // features, search, choice
  double evaluate_ns = 0;  // per sample
};

struct LadderSettings {
  int sectors = 2000;   // about; whole tracks, evenly spaced
  int angle_pairs = 6;  // (view, light) pairs per sector, evenly spread
};

/// Rungs from "predict the mean" to "direct" (error 0 by definition) for the sectors of `style`.
std::vector<LadderRung> accuracy_ladder(const std::shared_ptr<const RecordBank>& bank, const Hairstyle& style,
                                        const LadderSettings& settings = {});

}  // namespace pelage
