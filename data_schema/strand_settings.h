// Settings of what draws and shadows strand by strand: the strand renderer, the shadow methods, the ray-traced truth.
// Plain values of a scene file (schemas/scene.schema.json).
#pragma once

#include <cstdint>

namespace pelage {

/// The light-oriented density map [Bertails2005]. The defaults are the corrected form of DESIGN section 6; each
/// correction can be switched off alone, and printed() is the paper's own.
struct DensityMapSettings {
  int resolution = 128;            // cells along the longest side of the map, [1, 1024]
  float factor = 1.0F;             // the paper's f as a multiple of its calibrated value, >= 0
  bool area = true;                // deposit a D len sin(segment, light); off: count vertices
  bool split = true;               // pieces of at most half a cell; off: one deposit per vertex or segment
  bool trilinear_deposit = false;  // on: into the eight nearest cells; off: into the nearest
  bool centred_lookup = true;      // off: a cell's value sits at its far corner
  bool interpolate_depth = false;  // on: depth is interpolated, the exponential taken at lookup
  float footprint_m =
      0.002F;          // where cells are finer: mean over a disc of this radius [m], as the truth has it; 0: off
  bool filter = true;  // off: the nearest cell's value (A Fig. 5, left)
  bool fitted = true;  // box around the hair; off: 2 l_max + h_max wide, cells anchored in space (A 2.2)
  float extent_m = 0;  // side of the map [m] instead of either; 0: none given
  bool adaptive_slices = false;  // slices along the light of equal content instead of equal thickness
  bool operator==(const DensityMapSettings&) const = default;

  /// As the paper prints it: counts, nearest cell, corner lookup, interpolated transmittance, box of constant size.
  static DensityMapSettings printed() noexcept {
    DensityMapSettings s;
    s.area = s.split = s.trilinear_deposit = s.centred_lookup = s.fitted = false;
    s.footprint_m = 0;
    return s;
  }
};

/// Deep opacity maps [YukselKeyser2008] and opacity shadow maps [KimNeumann2001]: few layers of a fine picture from the
/// light.
struct OpacityMapSettings {
  int resolution = 256;  // pixels along the longer side of the light's picture, [1, 4096]
  int layers = 7;        // of deep opacity maps, behind the first hair of each pixel, [1, 64]
  int slices = 32;       // of opacity shadow maps, evenly through the box, [1, 1024]
  bool operator==(const OpacityMapSettings&) const = default;
};

struct ShadowSettings {
  DensityMapSettings density_map;
  OpacityMapSettings opacity_map;
  bool operator==(const ShadowSettings&) const = default;
};

enum class StrandShape { lines, ribbons, automatic };  // a sample wide; camera-facing, D wide; lines while all are thin
enum class StrandOrder { exact, sorted, weighted };    // per-pixel lists; segments by depth; order-independent mean
enum class StrandLobes { kajiya_kay, scheuermann };    // one highlight, or two shifted ones
enum class ShadowAt { vertex, fragment };              // where transmittance is looked up

/// The strand renderer.
struct StrandSettings {
  StrandShape shape = StrandShape::automatic;
  StrandOrder order = StrandOrder::sorted;
  StrandLobes lobes = StrandLobes::scheuermann;
  ShadowAt shadow_at = ShadowAt::vertex;
  int smoothing = 1;  // Catmull-Rom pieces per segment, [1, 32]; 1: the polyline as it is
  bool diffuse = true, primary_highlight = true, secondary_highlight = true;
  bool azimuth = true;  // reflectance around the fibre, the mean over its width; off: its mean over light angles, 1
  bool operator==(const StrandSettings&) const = default;
};

/// The ray-traced truth.
struct TruthSettings {
  int rays = 8192;             // per point of a measured transmittance, [1, 1000000]
  float footprint_m = 0.002F;  // r_f: radius of the disc over which its rays are spread
  int samples = 16;            // per pixel of a picture, [1, 65536]
  float stop_below = 0.0F;     // a shadow ray ends when its transmittance falls below this; 0: never
  bool azimuth = true;         // the azimuthal term of DESIGN section 3 at the true normal; off: its mean, 1
  bool operator==(const TruthSettings&) const = default;
};

}  // namespace pelage
