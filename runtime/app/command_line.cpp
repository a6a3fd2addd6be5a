#include "pelage/app/command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>

namespace pelage::app {

std::string shell_word(const std::string& word) {
  const std::string plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./,:=+-@%";
  if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string words_of(const CLI::App& verb, const std::vector<std::string>& left_out) {
  std::string line;
  for (const CLI::Option* const option : verb.get_options()) {
    const std::string name = option->get_name();
    if (option->count() == 0 || std::find(left_out.begin(), left_out.end(), name) != left_out.end()) continue;
    const bool positional = name.empty() || name[0] != '-';
    for (const std::string& value : option->results()) {
      if (!positional) line += " " + name;
      if (!positional && option->get_expected_min() == 0) break;  // a flag
      line += (!positional && value.starts_with('-') ? "=" : " ") + shell_word(value);
    }
  }
  return line;
}

}  // namespace pelage::app
