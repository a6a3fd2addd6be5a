// Unknown keys and missing ones are found by walking schema and document side by side, because the message names the
// nearest known key; everything else is valijson's judgement, told in our words from the schema node it stumbled over.
#include "pelage/data_schema/validate.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>
#include <regex>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>
#include <vector>

#include "pelage/data_schema/errors.h"
#include "schema_texts.h"

namespace pelage {
namespace {

using nlohmann::json;
using Pointer = json::json_pointer;

const json& schema_document(const std::string& file) {
  static const std::map<std::string, json, std::less<>> documents = {
      {"hairstyle.schema.json", json::parse(schema_texts::hairstyle_schema_json)},
      {"scene.schema.json", json::parse(schema_texts::scene_schema_json)},
      {"bake.schema.json", json::parse(schema_texts::bake_schema_json)},
      {"material.schema.json", json::parse(schema_texts::material_schema_json)},
      {"simulation.schema.json", json::parse(schema_texts::simulation_schema_json)}};
  return documents.at(file);
}

/// `node` with each $ref (also one inside allOf) replaced by what it names; keys beside it win. The schemas do not
/// recur.
json resolve(const json& node, const std::string& file) {
  if (node.is_array()) {
    json list = json::array();
    for (const json& item : node) list.push_back(resolve(item, file));
    return list;
  }
  if (!node.is_object()) return node;
  json result = json::object();
  const auto merge_reference = [&](const std::string& reference) {
    const std::size_t hash = reference.find('#');
    const std::string target = hash == 0 ? file : reference.substr(0, hash);
    result.update(resolve(schema_document(target).at(Pointer(reference.substr(hash + 1))), target));
  };
  if (node.contains("$ref")) merge_reference(node["$ref"]);
  json rest = json::array();
  for (const json& part : node.value("allOf", json::array()))
    if (part.contains("$ref"))
      merge_reference(part["$ref"]);
    else
      rest.push_back(resolve(part, file));
  for (const auto& [key, value] : node.items())
    if (key != "$ref" && key != "allOf" && key != "definitions") result[key] = resolve(value, file);
  if (!rest.empty()) result["allOf"] = rest;
  return result;
}

bool has_type(const json& value, const json& schema) {
  if (schema.contains("enum")) return value.is_string();
  const std::string type = schema.value("type", "");
  return (type == "object" && value.is_object()) || (type == "array" && value.is_array()) ||
         (type == "number" && value.is_number());
}

/// The alternative of a oneOf that is of the value's type, or the schema itself.
const json& alternative(const json& schema, const json& value) {
  if (schema.contains("oneOf"))
    for (const json& option : schema["oneOf"])
      if (has_type(value, option)) return option;
  return schema;
}

std::vector<std::string> known_keys(const json& schema) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : schema["properties"].items()) keys.push_back(key);
  return keys;
}

std::string quoted(const std::string& text) {
  return '"' + text + '"';
}

/// A value as the message shows it: short, whatever the file holds.
std::string shown(const json& value) {
  if (value.is_object()) return "an object";
  const auto replace = json::error_handler_t::replace;
  if (value.is_array() && value.size() > 8) return "an array of " + std::to_string(value.size()) + " values";
  const std::string text = value.dump(-1, ' ', false, replace);
  return text.size() > 60 ? text.substr(0, 60) + "..." : text;
}

std::string number_range(const json& schema) {
  std::string text;
  const auto add = [&](const char* key, const char* words) {
    if (schema.contains(key)) text += (text.empty() ? " " : " and ") + std::string(words) + " " + schema[key].dump();
  };
  add("minimum", "of at least");
  add("exclusiveMinimum", "above");
  add("maximum", "at most");
  add("exclusiveMaximum", "below");
  return text;
}

std::string joined(const std::vector<std::string>& words, const std::string& separator) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : separator) + word;
  return text;
}

/// What a schema node allows, in words.
std::string allowed(const json& schema) {
  if (schema.contains("const")) return schema["const"].dump();
  std::vector<std::string> words;
  if (schema.contains("enum")) {
    for (const json& name : schema["enum"]) words.push_back(name.dump());
    return (words.size() > 1 ? "one of " : "") + joined(words, ", ");
  }
  if (schema.contains("oneOf")) {
    for (const json& option : schema["oneOf"]) words.push_back(allowed(option));
    return joined(words, ", or ");
  }
  const std::string type = schema.value("type", "");
  if (type == "integer") return "a whole number" + number_range(schema);
  if (type == "number") return "a number" + number_range(schema);
  if (type == "boolean") return "true or false";
  if (type == "object") return "an object";
  if (type == "string")
    return schema.contains("maxLength") ? "text of at most " + schema["maxLength"].dump() + " characters" : "text";
  const json least = schema.value("minItems", json(0)), most = schema.value("maxItems", json(nullptr));
  std::string count = least == most ? least.dump() : least.dump() + " to " + most.dump();
  return "an array of " + count + " values, each " + allowed(schema["items"]);
}

/// What the schema says of a key, by its name or by a pattern; null where it does not know it.
const json* node_of(const json& schema, const std::string& key) {
  if (const auto named = schema["properties"].find(key); named != schema["properties"].end()) return &*named;
  if (!schema.contains("patternProperties")) return nullptr;
  for (const auto& [pattern, node] : schema["patternProperties"].items())
    if (std::regex_search(key, std::regex(pattern))) return &node;
  return nullptr;
}

/// One walk's state: throws at the first key that is unknown or missing.
struct KeyWalk {
  const std::string& where;

  [[noreturn]] void refuse(const Pointer& at, const std::string& what) const {
    throw InputError(where, (at.empty() ? "" : at.to_string() + ": ") + what);
  }

  void unknown(const json& object, const json& schema, const Pointer& at) const {
    for (const auto& [key, value] : object.items())
      if (node_of(schema, key) == nullptr) {
        const std::vector<std::string> keys = known_keys(schema);
        refuse(at, "unknown key " + shown(key) + "; the nearest known key is " + quoted(nearest_word(key, keys)));
      }
  }

  void missing(const json& object, const json& schema, const Pointer& at) const {
    for (const json& key : schema.value("required", json::array()))
      if (!object.contains(key.get<std::string>())) {
        const json& wanted = schema["properties"][key.get<std::string>()];
        refuse(at, "key " + key.dump() + " is missing (" + allowed(wanted) + ")");
      }
  }

  /// {"oneOf": [{"required": [a]}, {"required": [b]}]}
  void exactly_one(const json& object, const json& schema, const Pointer& at) const {
    for (const json& part : schema.value("allOf", json::array())) {
      std::vector<std::string> keys;
      for (const json& option : part["oneOf"]) keys.push_back(option["required"][0]);
      const auto given = std::count_if(keys.begin(), keys.end(), [&](const auto& key) { return object.contains(key); });
      if (given != 1) refuse(at, "give exactly one of the keys " + joined(keys, ", "));
    }
  }

  void walk(const json& value, const json& schema_or_choice, const Pointer& at) const {
    const json& schema = alternative(schema_or_choice, value);
    if (value.is_object() && schema.contains("properties")) {
      unknown(value, schema, at);
      missing(value, schema, at);
      exactly_one(value, schema, at);
      for (const auto& [key, child] : value.items()) walk(child, *node_of(schema, key), at / key);
    }
    if (value.is_array() && schema.contains("items") && may_hold_keys(schema["items"]))
      for (std::size_t i = 0; i < value.size(); ++i) walk(value[i], schema["items"], at / i);
  }

  /// Long arrays of numbers need no walk.
  static bool may_hold_keys(const json& schema) {
    if (schema.contains("properties")) return true;
    return schema.contains("items") && may_hold_keys(schema["items"]);
  }
};

/// Document and schema nodes under valijson's context: "<root>", "[clusters]", "[0]", ...
struct Place {
  Pointer at;
  const json* value;
  const json* schema;
};
Place find(const std::vector<std::string>& context, const json& document, const json& schema) {
  Place place{Pointer(), &document, &schema};
  for (std::size_t i = 1; i < context.size(); ++i) {
    const std::string token = context[i].substr(1, context[i].size() - 2);
    place.schema = &alternative(*place.schema, *place.value);
    const bool is_array = place.value->is_array();
    place.at /= token;
    place.value = is_array ? &place.value->at(std::stoul(token)) : &place.value->at(token);
    place.schema = is_array ? &place.schema->at("items") : node_of(*place.schema, token);
  }
  return place;
}

[[noreturn]] void refuse(const valijson::ValidationResults& results, const json& document, const json& schema,
                         const std::string& where) {
  const auto deepest = std::max_element(
      results.begin(), results.end(), [](const auto& a, const auto& b) { return a.context.size() < b.context.size(); });
  const Place place = find(deepest->context, document, schema);
  const json& node = alternative(*place.schema, *place.value);
  const std::string description = place.schema->value("description", "");
  throw InputError(where, (place.at.empty() ? "/" : place.at.to_string()) + " is " + shown(*place.value) +
                              "; allowed: " + allowed(node) + (description.empty() ? "" : " (" + description + ")"));
}

struct Compiled {
  json text;
  valijson::Schema schema;
};

const Compiled& compiled(std::string_view name) {
  static const std::map<std::string, Compiled, std::less<>> all = [] {
    std::map<std::string, Compiled, std::less<>> map;
    for (const char* each : {"hairstyle", "scene", "bake", "material"}) {
      Compiled& entry = map[each];
      const std::string file = std::string(each) + ".schema.json";
      entry.text = resolve(schema_document(file), file);
      entry.text.erase("$id");
      valijson::SchemaParser parser;
      parser.populateSchema(valijson::adapters::NlohmannJsonAdapter(entry.text), entry.schema);
    }
    return map;
  }();
  return all.find(name)->second;
}

}  // namespace

const json& resolved_schema(std::string_view schema) {
  return compiled(schema).text;
}

void validate(const json& document, std::string_view name, const std::string& where) {
  const Compiled& entry = compiled(name);
  KeyWalk{where}.walk(document, entry.text, Pointer());
  valijson::Validator validator;
  valijson::ValidationResults results;
  if (!validator.validate(entry.schema, valijson::adapters::NlohmannJsonAdapter(document), &results))
    refuse(results, document, entry.text, where);
}

std::string nearest_word(std::string_view word, std::span<const std::string> candidates) {
  word = word.substr(0, 64);  // bounds the work that a hostile key can ask for
  const auto distance = [&](const std::string& other) {
    std::vector<std::size_t> row(other.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < word.size(); ++i) {
      std::size_t diagonal = std::exchange(row[0], i + 1);
      for (std::size_t j = 0; j < other.size(); ++j) {
        const std::size_t replaced = diagonal + (word[i] == other[j] ? 0 : 1);
        diagonal = std::exchange(row[j + 1], std::min({replaced, row[j] + 1, row[j + 1] + 1}));
      }
    }
    return row.back();
  };
  std::string best;
  std::optional<std::size_t> least;
  for (const std::string& candidate : candidates)
    if (const std::size_t d = distance(candidate); !least || d < *least) {
      least = d;
      best = candidate;
    }
  return best;
}

}  // namespace pelage
