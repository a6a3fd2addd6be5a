// Private to this box: from what a decoder found to clean Strands.
#pragma once

#include <string>

#include "pelage/hair/hair_formats.h"

namespace pelage::hair {

/// Drops and repairs strands, converts unit and axes, believes thickness and opacity only where they are plausible, and
/// says so in the report. @throws InputError when no strand is usable, or none has a plausible length
Strands clean(const RawHair& raw, const ReadOptions& options, const std::string& where, ReadReport& report);

}  // namespace pelage::hair
