// Text as files, and text in CSV.
#pragma once

#include <filesystem>
#include <string>

namespace pelage::app {

/// Whole or not at all. @throws OutputError
void write_text(const std::string& text, const std::filesystem::path& file);

/// A field of a line [RFC 4180]: quoted where a comma, a quote or a line break asks for it.
std::string csv_field(const std::string& text);

}  // namespace pelage::app
