// One of the names that an option knows.
#pragma once

#include <map>
#include <string>

#include "pelage/data_schema/errors.h"

namespace pelage::app {

/// @throws UsageError naming the known ones
template <class T>
T choose(const std::map<std::string, T>& known, const std::string& value, const std::string& option) {
  const auto it = known.find(value);
  if (it != known.end()) return it->second;
  std::string list;
  for (const auto& [name, unused] : known) list += (list.empty() ? "" : ", ") + name;
  throw UsageError(option + ": '" + value + "' is not one of " + list);
}

}  // namespace pelage::app
