#include "pelage/db/checksum.h"

#include <bit>
#include <cstring>
#include <initializer_list>

namespace pelage {
namespace {

static_assert(std::endian::native == std::endian::little, "words are read as they lie in memory");

std::uint64_t word_at(const unsigned char* at, std::size_t size = sizeof(std::uint64_t)) noexcept {
  std::uint64_t word = 0;
  std::memcpy(&word, at, size);
  return word;
}

}  // namespace

void Checksum::add(const void* bytes, std::size_t size) noexcept {
  const auto* at = static_cast<const unsigned char*>(bytes);
  std::size_t left = size;
  if (left >= 32) {
    std::uint64_t a = state_, b = ~state_, c = state_ + 1, d = ~state_ + 1;
    for (; left >= 32; left -= 32, at += 32) {
      a = step(a, word_at(at));
      b = step(b, word_at(at + 8));
      c = step(c, word_at(at + 16));
      d = step(d, word_at(at + 24));
    }
    for (const std::uint64_t lane : {a, b, c, d}) state_ = step(state_, lane);
  }
  for (; left >= 8; left -= 8, at += 8) state_ = step(state_, word_at(at));
  state_ = step(state_, left > 0 ? word_at(at, left) : 0);
  state_ = step(state_, size);
}

}  // namespace pelage
