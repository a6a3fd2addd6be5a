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

/// The same without the byte order mark that some editors put first.
inline std::string_view text_of(std::span<const std::byte> bytes) {
  std::string_view text = as_text(bytes);
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  return text;
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

/// Takes the statements of an OBJ off the front of a text: lines without `# comment`, those that end in a backslash
/// with the line that continues them. A comment ends with its line, backslash or not.
class ObjLines {
 public:
  explicit ObjLines(std::string_view text) : lines_(text) {}

  bool at_end() const noexcept { return lines_.at_end(); }
  std::size_t number() const noexcept { return lines_.number(); }  // of the last line of the statement, from 1

  /// Valid until the next call.
  std::string_view next() {
    std::string_view line = without_comment(lines_.next());
    if (!line.ends_with('\\')) return line;
    whole_.clear();
    for (; line.ends_with('\\'); line = lines_.at_end() ? std::string_view{} : without_comment(lines_.next())) {
      line.remove_suffix(1);
      whole_.append(line) += ' ';
    }
    return whole_.append(line);
  }

 private:
  static std::string_view without_comment(std::string_view line) { return line.substr(0, line.find('#')); }

  Lines lines_;
  std::string whole_;  // of several lines
};

/// std::from_chars takes no '+'.
inline std::string_view without_plus(std::string_view word) {
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  return word;
}

/// The whole word as an integer that fits into T, a leading '+' allowed.
template <class T>
std::optional<T> parse_integer(std::string_view word) {
  word = without_plus(word);
  T value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// The whole word as a number of type T: decimal, "inf", "nan", a leading '+' allowed. What T cannot hold becomes
/// infinity or zero, as rounding has it.
template <class T>
std::optional<T> parse_real(std::string_view word) {
  word = without_plus(word);
  const char* const last = word.data() + word.size();
  T value = 0;
  const auto [end, error] = std::from_chars(word.data(), last, value);
  if (end != last || error == std::errc::invalid_argument) return std::nullopt;
  if (error == std::errc{}) return value;
  const std::size_t exponent = std::min(word.find_first_of("eE"), word.size());
  const bool whole_digits =
      word.substr(0, std::min(word.find('.'), exponent)).find_first_of("123456789") != std::string_view::npos;
  const bool tiny = exponent < word.size() ? word.substr(exponent + 1).starts_with('-') : !whole_digits;
  const T size = tiny ? T(0) : std::numeric_limits<T>::infinity();
  return word.starts_with('-') ? -size : size;
}
inline std::optional<float> parse_float(std::string_view word) {
  return parse_real<float>(word);
}
inline std::optional<double> parse_double(std::string_view word) {
  return parse_real<double>(word);
}

template <class T>
void append_number(std::string& out, T value) {
  char buffer[32];
  const auto [end, error] = std::to_chars(buffer, buffer + sizeof buffer, value);
  out.append(buffer, error == std::errc{} ? end : buffer);
}

}  // namespace pelage::hair
