// Results as JSON on stdout: one way for all verbs.
#pragma once

#include <iostream>
#include <nlohmann/json.hpp>

namespace pelage::console {

/// Indented, a newline at the end. Text out of somebody's file that is not UTF-8 shows as U+FFFD instead of failing.
template <class Json>
void print_json(const Json& json) {
  std::cout << json.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
}

}  // namespace pelage::console
