// The page of `pelage tradeoff`: one HTML file that needs nothing beside it. Without a script it holds every chart,
// figure and picture; its script (web/tradeoff.js) adds what a point under the pointer says, the panel of a point with
// its picture beside others, and curves that can be hidden.
#pragma once

#include <filesystem>
#include <string>

#include "pelage/tradeoff/tradeoff.h"

namespace pelage::app {

/// `folder` holds the pictures that the rows name; they go into the page. @throws InputError where one cannot be read
std::string tradeoff_page(const Tradeoff& tradeoff, const std::filesystem::path& folder);

}  // namespace pelage::app
