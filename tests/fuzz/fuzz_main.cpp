// One libFuzzer program per harness: PELAGE_HARNESS names it.
#include <algorithm>
#include <cstdint>

#include "harness.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace pelage::fuzz;
  static const Harness& harness = *std::ranges::find(harnesses(), std::string_view(PELAGE_HARNESS), &Harness::name);
  harness.run({reinterpret_cast<const char*>(data), size});
  return 0;
}
