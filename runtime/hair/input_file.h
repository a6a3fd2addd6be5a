// Private to this box: what its readers share.
#pragma once

#include <cstddef>
#include <filesystem>
#include <glm/vec3.hpp>
#include <vector>

#include "pelage/hair/hair_file.h"

namespace pelage::hair {

/// The whole file. @throws InputError when it is missing, not a regular file, or cannot be read
std::vector<std::byte> read_bytes(const std::filesystem::path& file);

/// From the file's unit and axes to metres, Y up.
glm::vec3 to_metres(glm::vec3 p, const ReadOptions& options) noexcept;

/// Finite and within 1000 km: farther out, squares of lengths lose all meaning in float.
bool is_usable(glm::vec3 p) noexcept;

/// A number of metres that a unit may have: with others, coordinates would all be zero or infinite.
bool is_unit(double metres) noexcept;

/// @throws UsageError for a unit that is none
void check_options(const ReadOptions& options);

}  // namespace pelage::hair
