// Private to this box: what its readers and writers of text share. Linear in the text, the same in every locale;
// numbers are written with the fewest digits that read back to the same bits.
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace pelage::hair {

inline std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Takes words off the front of a line.
class Words {
 public:
  explicit Words(std::string_view line, std::string_view separators = " \t\r") : rest_(line), separators_(separators) {}

  /// The next word, empty at the end.
  std::string_view next() {
    const std::size_t begin = rest_.find_first_not_of(separators_);
    if (begin == std::string_view::npos) return rest_ = {};
    const std::size_t end = std::min(rest_.find_first_of(separators_, begin), rest_.size());
    const std::string_view word = rest_.substr(begin, end - begin);
    rest_.remove_prefix(end);
    return word;
  }

 private:
  std::string_view rest_, separators_;
};

/// Takes lines off the front of a text, and counts them.
class Lines {
 public:
  explicit Lines(std::string_view text) : rest_(text) {}

  bool at_end() const noexcept { return rest_.empty(); }
  std::size_t number() const noexcept { return number_; }  // of the line that next() returned last, from 1
  std::string_view rest() const noexcept { return rest_; }

  std::string_view next() {
    ++number_;
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
  }

 private:
  std::string_view rest_;
  std::size_t number_ = 0;
};

/// The whole word as an integer that fits into T.
template <class T>
std::optional<T> parse_integer(std::string_view word) {
  T value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// The whole word as a number: decimal, "inf", "nan", a leading '+' allowed. What float cannot hold becomes infinity or
/// zero, as rounding has it.
inline std::optional<float> parse_float(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  const char* const last = word.data() + word.size();
  float value = 0;
  const auto [end, error] = std::from_chars(word.data(), last, value);
  if (end != last || error == std::errc::invalid_argument) return std::nullopt;
  if (error == std::errc{}) return value;
  const bool tiny = word.find("e-") != std::string_view::npos || word.find("E-") != std::string_view::npos;
  const float size = tiny ? 0.0F : std::numeric_limits<float>::infinity();
  return word.starts_with('-') ? -size : size;
}

template <class T>
void append_number(std::string& out, T value) {
  char buffer[32];
  const auto [end, error] = std::to_chars(buffer, buffer + sizeof buffer, value);
  out.append(buffer, error == std::errc{} ? end : buffer);
}

}  // namespace pelage::hair
