// Folders that verbs write many files into.
#pragma once

#include <filesystem>
#include <string>

namespace pelage::app {

/// Makes the folder if there is none; an empty name is no folder. @param first_file  that will be written there
/// @throws OutputError before any work where it cannot be made or written into
void make_folder(const std::filesystem::path& folder, const std::string& first_file);

}  // namespace pelage::app
