// The smallest databases with all that a database has: 4 views x 4 lights x 4 samples, made-up values.
#pragma once

#include <filesystem>

#include "pelage/db/database.h"

namespace pelage::fuzz {

BakeSettings tiny_settings(Storage storage, int records);
StoredSector tiny_sector(const BakeSettings& settings, int index);
/// Begins or resumes `file` and finishes it.
void write_tiny_database(const std::filesystem::path& file, const BakeSettings& settings);

}  // namespace pelage::fuzz
