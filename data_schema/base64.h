// Base64 [RFC 4648 section 4], padded. Used for the packed strands of a hairstyle file.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace pelage {

std::string base64_encode(std::span<const std::byte> bytes);
/// Nothing where the text is not base64: a foreign character, a wrong length or padding, set bits behind the last byte.
std::optional<std::vector<std::byte>> base64_decode(std::string_view text);

}  // namespace pelage
