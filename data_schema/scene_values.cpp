#include "pelage/data_schema/scene_values.h"

#include <nlohmann/json.hpp>

#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/validate.h"

namespace pelage {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

std::vector<std::string> parts_of(const std::string& place) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (std::size_t end; (end = place.find('.', begin)) != std::string::npos; begin = end + 1)
    parts.push_back(place.substr(begin, end - begin));
  parts.push_back(place.substr(begin));
  return parts;
}

bool is_index(const std::string& part) {
  return !part.empty() && part.size() < 9 && part.find_first_not_of("0123456789") == std::string::npos;
}

[[noreturn]] void no_place(const std::string& text, const std::string& part, const ordered_json& at) {
  std::vector<std::string> known;
  for (const auto& [key, value] : at.items()) known.push_back(key);
  throw UsageError("--set " + text + ": there is no '" + part + "' there" +
                   (known.empty() ? "" : "; the nearest is '" + nearest_word(part, known) + "'"));
}

/// Keys that a scene may leave out, or that name what there is (effects).
bool may_be_absent(const std::vector<std::string>& parts) {
  return parts[0] == "camera" || parts[0] == "effects" || (parts[0] == "lights" && parts.size() > 2);
}

void set(ordered_json& document, const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0)
    throw UsageError("--set " + text + ": give PLACE=VALUE, e.g. shadow.density_map.resolution=64");
  const std::vector<std::string> parts = parts_of(text.substr(0, equals));
  const std::string word = text.substr(equals + 1);
  ordered_json* at = &document;
  for (const std::string& part : parts) {
    if (at->is_array()) {
      if (!is_index(part) || std::stoul(part) >= at->size())
        throw UsageError("--set " + text + ": '" + part + "' is none of the list's " + std::to_string(at->size()) +
                         " elements, counted from 0");
      at = &(*at)[std::stoul(part)];
    } else {
      if (!at->is_null() && !at->is_object())
        throw UsageError("--set " + text + ": there is nothing below '" + part + "'");
      if (!at->contains(part) && !may_be_absent(parts)) no_place(text, part, *at);
      at = &(*at)[part];
    }
  }
  const ordered_json value = ordered_json::parse(word, nullptr, false);
  *at = value.is_discarded() ? ordered_json(word) : value;
}

std::string word_of(const ordered_json& value) {
  if (!value.is_string()) return value.dump();
  // A word that would be read as JSON keeps its quotes.
  const auto word = value.get<std::string>();
  return ordered_json::parse(word, nullptr, false).is_discarded() ? word : value.dump();
}

void differ(const std::string& place, const ordered_json& from, const ordered_json& to,
            std::vector<std::string>& words) {
  if (from == to) return;
  if (from.is_object() && to.is_object()) {
    for (const auto& [key, value] : to.items())
      differ(place.empty() ? key : place + "." + key, from.contains(key) ? from[key] : ordered_json(), value, words);
    return;
  }
  if (from.is_array() && to.is_array() && from.size() == to.size() && !to.empty() && to[0].is_object()) {
    for (std::size_t i = 0; i < to.size(); ++i) differ(place + "." + std::to_string(i), from[i], to[i], words);
    return;
  }
  words.push_back(place + "=" + word_of(to));
}

}  // namespace

Scene with_values(const Scene& scene, std::span<const std::string> values) {
  if (values.empty()) return scene;
  auto document = ordered_json::parse(to_json(scene));
  for (const std::string& value : values) set(document, value);
  std::string all;
  for (const std::string& value : values) all += (all.empty() ? "" : ", ") + value;
  try {
    return scene_from_json(document.dump(), "--set " + all);
  } catch (const InputError& error) {
    throw UsageError(error.what());
  }
}

std::vector<std::string> changed_values(const Scene& from, const Scene& to) {
  std::vector<std::string> words;
  differ("", ordered_json::parse(to_json(from)), ordered_json::parse(to_json(to)), words);
  return words;
}

}  // namespace pelage
