// OBJ meshes: positions and polygons read, materials, texture coordinates and normals ignored (normals are computed);
// positions, normals and triangles written. Metres and Y up unless ReadOptions say otherwise.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "pelage/data_schema/mesh.h"
#include "pelage/hair/hair_file.h"

namespace pelage::hair {

/// @throws InputError naming file and line. Unit and up axis as for hair; its other options have no meaning here.
Mesh read_obj(const std::filesystem::path& file, const ReadOptions& options = {});

/// The same from memory; `where` names the file in messages.
Mesh parse_obj(std::string_view text, const std::string& where, const ReadOptions& options = {});

/// Written atomically, with the fewest digits that read back to the same bits: reading gives the same positions and
/// triangles. @throws OutputError
void write_obj(const Mesh& mesh, const std::filesystem::path& file);

}  // namespace pelage::hair
