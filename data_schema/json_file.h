// JSON text to values. Stricter than JSON where files go wrong: no duplicate keys, no numbers beyond double, no more
// than 64 levels, at most 1 GiB.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace pelage {

/// Bytes of a file. @throws InputError: missing, a folder, unreadable, too large
std::string read_text(const std::filesystem::path& file);

/// @param where  what the text is, for messages     @throws InputError naming line and column, or key and path
nlohmann::json parse_json(const std::string& text, const std::string& where);

}  // namespace pelage
