// Private to this box: one BasisCurves prim of a USD stage, and its curves as strands.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "pelage/hair/hair_formats.h"

namespace pelage::hair {

struct Primvar {
  std::vector<float> values;
  std::string interpolation;
  bool indexed = false;
};

/// What a BasisCurves prim says, with the schema's fallbacks.
struct CurvesPrim {
  std::size_t line = 0;
  std::vector<std::uint64_t> counts;
  std::vector<float> points;  // 3 per point
  Primvar widths{{}, "vertex"}, widths_primvar{{}, "constant"};
  Primvar display_colour{{}, "constant"}, groom_colour{{}, "constant"}, opacity{{}, "constant"};
  bool textured = false;  // has texture coordinates
  std::string type = "cubic", basis = "bezier", wrap = "nonperiodic";
};

/// Adds its curves to `raw`, cubic ones evaluated. Widths, colours and opacity that do not fit are told and left out.
/// @throws InputError for counts, type, basis or wrap that make no strands
void append_curves(CurvesPrim& prim, RawHair& raw, const std::string& where);

}  // namespace pelage::hair
