// The methods that `pelage compare` knows, each as what it makes of a scene.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "pelage/data_schema/scene.h"

namespace pelage::app {

struct CompareMethod {
  std::string id, title, what;                                // as in ComparedMethod
  std::function<std::vector<std::string>(Scene& scene)> set;  // what it changes; @return the same as options of render
};

/// The truth first. @param database  generic records to use; empty: a generic database is baked and cached
std::vector<CompareMethod> known_methods(const std::string& database);

/// Those named, in the order in which they are known, the truth with them; all where none is named.
/// @throws UsageError with the nearest name
std::vector<CompareMethod> chosen_methods(const std::string& database, std::span<const std::string> ids);

}  // namespace pelage::app
