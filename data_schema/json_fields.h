// Values to and from JSON, one overload per type. A struct lists its keys once, in a `fields(f, value)` overload that
// calls f(key, member) for each; reading and writing both walk that list. Documents are validated before they are read.
#pragma once

#include <array>
#include <charconv>
#include <cstdint>
#include <glm/vec3.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace pelage::json_fields {

using nlohmann::json;
using nlohmann::ordered_json;

/// The double whose shortest decimal text is that of `value`: 0.1F becomes 0.1, and reads back as 0.1F.
inline double shortest(float value) {
  std::array<char, 64> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  double result = 0;
  std::from_chars(text.data(), end, result);
  return result;
}

inline void get(const json& j, bool& value) {
  value = j.get<bool>();
}
inline void get(const json& j, int& value) {
  value = j.get<int>();
}
inline void get(const json& j, std::uint64_t& value) {
  value = j.get<std::uint64_t>();
}
inline void get(const json& j, double& value) {
  value = j.get<double>();
}
inline void get(const json& j, float& value) {
  value = static_cast<float>(j.get<double>());
}
inline void get(const json& j, std::string& value) {
  value = j.get<std::string>();
}
inline void get(const json& j, glm::vec3& value) {
  for (int i = 0; i < 3; ++i) get(j[static_cast<std::size_t>(i)], value[i]);
}

inline ordered_json put(bool value) {
  return value;
}
inline ordered_json put(int value) {
  return value;
}
inline ordered_json put(std::uint64_t value) {
  return value;
}
inline ordered_json put(double value) {
  return value;
}
inline ordered_json put(float value) {
  return shortest(value);
}
inline ordered_json put(const std::string& value) {
  return value;
}
inline ordered_json put(const glm::vec3& v) {
  return {shortest(v.x), shortest(v.y), shortest(v.z)};
}

/// Names of an enumeration in the order of its values: specialised as `template <> constexpr auto kNames<E> = ...`.
template <class E>
inline constexpr std::array<std::string_view, 0> kNames{};

template <class E>
requires std::is_enum_v<E>
void get(const json& j, E& value) {
  const auto& names = kNames<E>;
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == j.get_ref<const std::string&>()) value = static_cast<E>(i);
}
template <class E>
requires std::is_enum_v<E> ordered_json put(E value) {
  return std::string(kNames<E>[static_cast<std::size_t>(value)]);
}

/// A key that may be absent: read where it is there, written where it has a value.
template <class T>
void get(const json& j, std::optional<T>& value) {
  get(j, value.emplace());
}
template <class T>
ordered_json put(const std::optional<T>& value) {
  return value ? put(*value) : ordered_json();
}

template <class T>
void get(const json& j, std::vector<T>& values);
template <class T>
ordered_json put(const std::vector<T>& values);

template <class S>
concept Struct = requires(S& s) {
  fields([](const char*, auto&) {}, s);
};

template <Struct S>
void get(const json& j, S& value) {
  fields(
      [&](const char* key, auto& member) {
        if (const auto found = j.find(key); found != j.end()) get(*found, member);
      },
      value);
}
template <Struct S>
ordered_json put(S value) {
  ordered_json j = ordered_json::object();
  fields(
      [&](const char* key, auto& member) {
        if (ordered_json written = put(std::as_const(member)); !written.is_null()) j[key] = std::move(written);
      },
      value);
  return j;
}

template <class T>
void get(const json& j, std::vector<T>& values) {
  values.assign(j.size(), T{});
  for (std::size_t i = 0; i < j.size(); ++i) get(j[i], values[i]);
}
template <class T>
ordered_json put(const std::vector<T>& values) {
  ordered_json j = ordered_json::array();
  for (const T& value : values) j.push_back(put(value));
  return j;
}

/// An object whose keys are data.
template <class T>
void get(const json& j, std::map<std::string, T>& values) {
  values.clear();
  for (const auto& [key, value] : j.items()) get(value, values[key]);
}
template <class T>
ordered_json put(const std::map<std::string, T>& values) {
  ordered_json j = ordered_json::object();
  for (const auto& [key, value] : values) j[key] = put(value);
  return j;
}

/// Text that is valid UTF-8 whatever the strings in it hold (paths need not be).
inline std::string text_of(const ordered_json& j) {
  return j.dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace pelage::json_fields
