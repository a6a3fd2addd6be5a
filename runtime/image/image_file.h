// Pictures on disk through OpenImageIO: PNG (8-bit sRGB, straight alpha) and EXR (half, linear, premultiplied).
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "pelage/image/image.h"

namespace pelage {

/// Writes by the extension, .png or .exr, to a temporary file that is renamed when complete. `attributes` become text
/// metadata. @throws UsageError for another extension, OutputError when it cannot be written
void write_image(const Image& image, const std::filesystem::path& file,
                 const std::map<std::string, std::string>& attributes);

/// Does the extension name a format that write_image writes? @throws UsageError naming them
void check_picture_name(const std::filesystem::path& file);

/// Reads any picture that OpenImageIO knows as linear premultiplied RGBA (8-bit files are taken as sRGB).
/// @throws InputError
Image read_image(const std::filesystem::path& file);

}  // namespace pelage
