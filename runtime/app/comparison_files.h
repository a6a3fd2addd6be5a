// A comparison as files for other programs.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "pelage/app/comparison.h"

namespace pelage::app {

/// Every field of Comparison under its own name; psnr_db is null where it is infinite, and what does not hold
/// (figures of a method that failed, frames of a still) is left out.
nlohmann::ordered_json comparison_json(const Comparison& comparison);

/// A line of names, then one line per method [RFC 4180]; figures of a failed method are empty, PSNR may be "inf".
std::string comparison_csv(const Comparison& comparison);

/// One line per method and frame.
std::string comparison_frames_csv(const Comparison& comparison);

/// comparison.json, comparison.csv and, of an animation, comparison-frames.csv; each whole or not at all.
/// @throws OutputError
void write_comparison(const Comparison& comparison, const std::filesystem::path& folder);

}  // namespace pelage::app
