// Keys of bake settings, shared by the bake file and the scene file.
#pragma once

#include "pelage/data_schema/bake_settings.h"
#include "pelage/data_schema/hairstyle.h"
#include "pelage/data_schema/json_fields.h"

namespace pelage::json_fields {

template <>
inline constexpr std::array<std::string_view, 3> kNames<FeatureSet>{"paper3", "moments5", "profile11"};
template <>
inline constexpr std::array<std::string_view, 2> kNames<Storage>{"u8", "half"};

}  // namespace pelage::json_fields

namespace pelage {

template <class F>
void fields(F&& f, PlanarPhong& p) {
  f("diffuse", p.diffuse);
  f("specular", p.specular);
  f("exponent", p.exponent);
}

template <class F>
void fields(F&& f, BakeSettings& s) {
  f("seed", s.seed);
  f("sectors", s.sectors);
  f("grid", s.grid);
  f("sigma", s.sigma);
  f("views", s.views);
  f("lights", s.lights);
  f("samples", s.samples);
  f("smoothing", s.smoothing);
  f("reference_scale", s.reference_scale);
  f("max_path", s.max_path);
  f("early_stop", s.early_stop);
  f("max_strands", s.max_strands);
  f("phong", s.phong);
  f("features", s.features);
  f("storage", s.storage);
}

template <class F>
void fields(F&& f, Division& d) {
  f("layers", d.layers);
  f("sectors", d.sectors);
  f("plates", d.plates);
  f("core", d.core);
}

/// What the schema cannot say. @throws InputError
void check(const BakeSettings& settings, const std::string& where);

}  // namespace pelage
