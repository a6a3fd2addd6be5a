// pelage info of a database: coverage in words, and the picture of database_picture.h.
#pragma once

#include <filesystem>

namespace pelage::app {

/// @param against  hairstyle whose sectors are compared, or empty      @param picture  PNG or EXR to write, or empty
void info_of_database(const std::filesystem::path& database, const std::filesystem::path& against,
                      const std::filesystem::path& picture);

}  // namespace pelage::app
