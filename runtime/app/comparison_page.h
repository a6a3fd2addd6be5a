// The page of `pelage compare`: one HTML file that needs nothing beside it. Without a script it holds every figure and
// picture; its script (web/compare.js) adds the slider, zoom, insets and sorting.
#pragma once

#include <filesystem>
#include <string>

#include "pelage/app/comparison.h"

namespace pelage::app {

/// `folder` holds the pictures that the rows name; they go into the page. @throws InputError where one cannot be read
std::string comparison_page(const Comparison& comparison, const std::filesystem::path& folder);

}  // namespace pelage::app
