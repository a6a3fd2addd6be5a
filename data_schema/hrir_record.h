// HRIR record [Xu2006 section 4]: how one sector looks from every direction in its plate, lit from every direction.
//
// Angles lie in the sector's own coordinates, measured from outward r, positive towards +s, on the regular periodic
// grid theta_i = 2 pi i / count. `tau` is the unstopped line integral of density times the reference scale c0 along the
// view ray that enters at s = (x + 1/2) / samples on the side that the viewer sees; opacity at another scale c is 1 -
// exp(-tau c / c0). `re` is straight (un-premultiplied) reflectance with mean 1 over light angles.
#pragma once

#include <vector>

namespace pelage {

struct RecordShape {
  int views = 0, lights = 0, samples = 0;
  bool operator==(const RecordShape&) const = default;
  std::size_t tau_size() const noexcept { return static_cast<std::size_t>(views) * static_cast<std::size_t>(samples); }
  std::size_t re_size() const noexcept { return tau_size() * static_cast<std::size_t>(lights); }
};

struct HrirRecord {
  RecordShape shape;
  std::vector<float> tau;  // [view][sample], >= 0
  std::vector<float> re;   // [view][light][sample], >= 0
};

}  // namespace pelage
