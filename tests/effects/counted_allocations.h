// Allocations that this test program has made so far, of all threads.
#pragma once

#include <cstdint>

namespace pelage::test {

std::uint64_t allocations() noexcept;
/// Bytes that are allocated now.
std::int64_t allocated_bytes() noexcept;

}  // namespace pelage::test
