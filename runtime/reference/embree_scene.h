// Private to this box: owners of Embree's handles, and its errors as exceptions.
#pragma once

#include <embree3/rtcore.h>

#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace pelage {

struct ReleaseDevice {
  void operator()(RTCDevice d) const noexcept { rtcReleaseDevice(d); }
};
struct ReleaseScene {
  void operator()(RTCScene s) const noexcept { rtcReleaseScene(s); }
};
using EmbreeDevice = std::unique_ptr<std::remove_pointer_t<RTCDevice>, ReleaseDevice>;
using EmbreeScene = std::unique_ptr<std::remove_pointer_t<RTCScene>, ReleaseScene>;

/// @throws std::bad_alloc, std::runtime_error
inline void check_embree(RTCDevice device) {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  if (error != RTC_ERROR_NONE) throw std::runtime_error("Embree reports error " + std::to_string(int(error)));
}

inline EmbreeDevice embree_device() {
  EmbreeDevice device(rtcNewDevice(nullptr));
  if (!device) check_embree(nullptr);
  return device;
}

}  // namespace pelage
