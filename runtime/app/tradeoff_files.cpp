#include "pelage/app/tradeoff_files.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <type_traits>
#include <utility>
#include <vector>

#include "pelage/app/text_files.h"
#include "pelage/data_schema/errors.h"
#include "pelage/data_schema/json_file.h"

namespace pelage::app {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

// --- keys: reading and writing walk the same lists -----------------------------------------------------------------

template <class F, class T>
concept Of = std::is_same_v<std::remove_const_t<F>, T>;

void fields(auto&& f, Of<Origin> auto& origin) {
  f("scene_hash", origin.scene_hash);
  f("seed", origin.seed);
  f("revision", origin.revision);
  f("cpu", origin.cpu);
  f("threads", origin.threads);
}

void fields(auto&& f, Of<Times> auto& time) {
  f("min_ms", time.min_ms);
  f("median_ms", time.median_ms);
  f("max_ms", time.max_ms);
  f("repeats", time.repeats);
}

void fields(auto&& f, Of<TradeoffRow> auto& row) {
  f("id", row.id);
  f("knob", row.knob);
  f("label", row.label);
  f("amount", row.amount);
  f("settings", row.settings);
  f("command", row.command);
  f("paper", row.paper);
  f("failed", row.failed);
  f("origin", row.origin);
  f("error", row.error);
  f("error_bar", row.error_bar);
  f("others", row.others);
  f("time", row.time);
  f("prepare_ms", row.prepare_ms);
  f("bytes", row.bytes);
  f("picture", row.picture);
  f("on_front", row.on_front);
  f("dominated_by", row.dominated_by);
}

void fields(auto&& f, Of<Curve> auto& curve) {
  f("knob", curve.knob);
  f("what", curve.what);
  f("unit", curve.unit);
}

void fields(auto&& f, Of<Slope> auto& slope) {
  f("knob", slope.knob);
  f("against", slope.against);
  f("slope", slope.slope);
  f("standard_error", slope.standard_error);
  f("points", slope.points);
}

void fields(auto&& f, Of<Diagram> auto& diagram) {
  f("id", diagram.id);
  f("title", diagram.title);
  f("error_name", diagram.error_name);
  f("error_unit", diagram.error_unit);
  f("time_name", diagram.time_name);
  f("truth", diagram.truth);
  f("curves", diagram.curves);
  f("rows", diagram.rows);
  f("slopes", diagram.slopes);
}

template <class T>
concept Struct = requires(T& value) {
  fields([](const char*, auto&) {}, value);
};

// --- writing -------------------------------------------------------------------------------------------------------

template <class T>
ordered_json put(const T& value) {
  return value;
}

ordered_json put(double value) {
  if (std::isnan(value)) return nullptr;
  return std::isinf(value) ? ordered_json(value > 0 ? "inf" : "-inf") : ordered_json(value);
}

ordered_json put(const std::vector<std::pair<std::string, double>>& figures) {
  ordered_json list = ordered_json::array();
  for (const auto& [name, value] : figures) list.push_back({{"name", name}, {"value", put(value)}});
  return list;
}

template <Struct T>
ordered_json put(const T& value);

template <Struct T>
ordered_json put(const std::vector<T>& values) {
  ordered_json list = ordered_json::array();
  for (const T& value : values) list.push_back(put(value));
  return list;
}

template <Struct T>
ordered_json put(const T& value) {
  ordered_json object = ordered_json::object();
  fields([&](const char* key, const auto& member) { object[key] = put(member); }, value);
  return object;
}

std::string text_of(const ordered_json& document) {
  return document.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

// --- reading -------------------------------------------------------------------------------------------------------

/// A value of a file: where it is, for messages.
struct Place {
  const std::string& file;
  std::string key;  // "origin.seed"

  [[nodiscard]] Place of(const std::string& inner) const { return {file, key.empty() ? inner : key + "." + inner}; }
  void require(bool holds, const json& found, const char* wanted) const {
    if (holds) return;
    throw InputError(file, fmt::format("{} must be {}, not {}: remove the file, and the row is measured again",
                                       key.empty() ? "a row" : "\"" + key + "\"", wanted,
                                       found.dump(-1, ' ', false, json::error_handler_t::replace).substr(0, 60)));
  }
};

bool is_count(const json& j) {
  return j.is_number_unsigned() || (j.is_number_integer() && j.get<std::int64_t>() >= 0);
}

void get(const json& j, bool& value, const Place& place) {
  place.require(j.is_boolean(), j, "true or false");
  value = j.get<bool>();
}
void get(const json& j, int& value, const Place& place) {
  const bool fits = is_count(j) && j.get<std::uint64_t>() <= std::numeric_limits<int>::max();
  place.require(fits, j, "a count");
  value = j.get<int>();
}
void get(const json& j, std::uint64_t& value, const Place& place) {
  place.require(is_count(j), j, "a whole number from 0 to 2^64 - 1");
  value = j.get<std::uint64_t>();
}
void get(const json& j, double& value, const Place& place) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const bool up = j == "inf", down = j == "-inf";
  place.require(j.is_number() || j.is_null() || up || down, j, "a number, null, \"inf\" or \"-inf\"");
  value = up ? kInfinity : down ? -kInfinity : j.is_null() ? std::numeric_limits<double>::quiet_NaN() : j.get<double>();
}
void get(const json& j, std::string& value, const Place& place) {
  place.require(j.is_string(), j, "text");
  value = j.get<std::string>();
}

const json& member(const json& j, const std::string& key, const Place& place) {
  const auto found = j.find(key);
  if (found == j.end()) {
    throw InputError(place.file,
                     "\"" + place.of(key).key + "\" is missing: remove the file, and the row is measured again");
  }
  return *found;
}

void get(const json& j, std::vector<std::string>& values, const Place& place) {
  place.require(j.is_array(), j, "a list");
  for (std::size_t i = 0; i < j.size(); ++i) get(j[i], values.emplace_back(), place.of(std::to_string(i)));
}

void get(const json& j, std::vector<std::pair<std::string, double>>& values, const Place& place) {
  place.require(j.is_array(), j, "a list");
  for (std::size_t i = 0; i < j.size(); ++i) {
    const Place at = place.of(std::to_string(i));
    at.require(j[i].is_object() && j[i].size() == 2, j[i], "an object of a name and a value");
    auto& [name, value] = values.emplace_back();
    get(member(j[i], "name", at), name, at.of("name"));
    get(member(j[i], "value", at), value, at.of("value"));
  }
}

template <Struct T>
void get(const json& j, T& value, const Place& place) {
  place.require(j.is_object(), j, "an object");
  std::set<std::string> known;
  fields(
      [&](const char* key, auto& into) {
        known.insert(key);
        get(member(j, key, place), into, place.of(key));
      },
      value);
  for (const auto& item : j.items()) {
    if (!known.contains(item.key())) {
      throw InputError(place.file, "no row has a \"" + place.of(item.key()).key +
                                       "\": remove the file, and the row is measured again");
    }
  }
}

// --- CSV -----------------------------------------------------------------------------------------------------------

constexpr const char* kColumns =
    "diagram,id,knob,label,amount,paper,settings,scene_hash,seed,revision,cpu,threads,min_ms,median_ms,max_ms,repeats,"
    "prepare_ms,bytes,error,error_bar,others,on_front,dominated_by,failed,command\r\n";
constexpr int kFigures = 11;  // min_ms .. dominated_by

std::string joined(const std::vector<std::string>& texts) {
  std::string line;
  for (const std::string& text : texts) line += (line.empty() ? "" : "; ") + text;
  return line;
}

std::string figures_csv(const TradeoffRow& row) {
  if (!row.failed.empty()) return std::string(kFigures, ',');
  std::vector<std::string> others;
  for (const auto& [name, value] : row.others) others.push_back(fmt::format("{}={}", name, value));
  return fmt::format(",{},{},{},{},{},{},{},{},{},{},{}", row.time.min_ms, row.time.median_ms, row.time.max_ms,
                     row.time.repeats, row.prepare_ms, row.bytes, row.error, row.error_bar, csv_field(joined(others)),
                     row.on_front, csv_field(row.dominated_by));
}

std::string row_csv(const Diagram& diagram, const TradeoffRow& row) {
  const Origin& origin = row.origin;
  std::string line = csv_field(diagram.id);
  for (const std::string& text : {row.id, row.knob, row.label}) line += "," + csv_field(text);
  line += std::isnan(row.amount) ? "," : fmt::format(",{}", row.amount);
  for (const std::string& text : {row.paper, joined(row.settings), origin.scene_hash}) line += "," + csv_field(text);
  line += fmt::format(",{},{},{},{}", origin.seed, csv_field(origin.revision), csv_field(origin.cpu), origin.threads);
  return line + figures_csv(row) + "," + csv_field(row.failed) + "," + csv_field(row.command) + "\r\n";
}

}  // namespace

ordered_json row_json(const TradeoffRow& row) {
  return put(row);
}

TradeoffRow row_from_json(const json& document, const std::string& file) {
  TradeoffRow row;
  get(document, row, Place{file, ""});
  return row;
}

void write_row(const TradeoffRow& row, const std::filesystem::path& file) {
  write_text(text_of(row_json(row)), file);
}

TradeoffRow read_row(const std::filesystem::path& file) {
  return row_from_json(parse_json(read_text(file), file.string()), file.string());
}

ordered_json tradeoff_json(const Tradeoff& t) {
  return {{"name", t.name},   {"command", t.command},        {"origin", put(t.origin)},
          {"quick", t.quick}, {"diagrams", put(t.diagrams)}, {"scene", ordered_json::parse(t.scene)}};
}

std::string tradeoff_csv(const Tradeoff& t) {
  std::string text = kColumns;
  for (const Diagram& diagram : t.diagrams) {
    for (const TradeoffRow& row : diagram.rows) text += row_csv(diagram, row);
  }
  return text;
}

void write_tradeoff(const Tradeoff& t, const std::filesystem::path& folder) {
  write_text(text_of(tradeoff_json(t)), folder / "tradeoff.json");
  write_text(tradeoff_csv(t), folder / "tradeoff.csv");
}

}  // namespace pelage::app
