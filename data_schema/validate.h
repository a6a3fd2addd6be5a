// JSON against the published schemas (schemas/*.schema.json, embedded).
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>

namespace pelage {

/// Checks `document` against a schema: "hairstyle", "scene", "bake" or "material".
/// @throws InputError naming file, JSON pointer, value and what is allowed; for an unknown key, the nearest known one
void validate(const nlohmann::json& document, std::string_view schema, const std::string& where);

/// The schema with every $ref resolved, as validate() uses it.
const nlohmann::json& resolved_schema(std::string_view schema);

/// The candidate with the smallest edit distance (Levenshtein 1966) to `word`; the first of several. Empty without any.
std::string nearest_word(std::string_view word, std::span<const std::string> candidates);

}  // namespace pelage
