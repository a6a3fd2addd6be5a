// From a drawing's linear image to the file that people look at.
#pragma once

#include <filesystem>

#include "pelage/data_schema/scene.h"
#include "pelage/image/image.h"

namespace pelage::app {

/// As people see it: exposed and over its background, where it has one.
Image finished(Image image, const ImageSettings& settings);

/// Counts what is not finite (a warning), exposes, lays over the background and writes, with the scene's settings.
void write_picture(Image image, const Scene& scene, const std::filesystem::path& file);

}  // namespace pelage::app
