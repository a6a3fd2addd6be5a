#include "pelage/data_schema/json_file.h"

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <system_error>
#include <vector>

#include "pelage/data_schema/errors.h"

namespace pelage {
namespace {

using nlohmann::json;
constexpr std::size_t kMaxDepth = 64;
constexpr std::size_t kMaxBytes = std::size_t{1} << 30U;

/// "line 3, column 7" of a byte offset.
std::string position_text(const std::string& text, std::size_t offset) {
  const std::size_t end = std::min(offset, text.size());
  const auto line = std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(end), '\n') + 1;
  const std::size_t previous_end = end == 0 ? std::string::npos : text.rfind('\n', end - 1);
  const std::size_t column = previous_end == std::string::npos ? end : end - previous_end - 1;
  return "line " + std::to_string(line) + ", column " + std::to_string(std::max<std::size_t>(column, 1));
}

/// Builds the value from the parser's events, in the form that nlohmann::json::sax_parse calls.
class Builder {
 public:
  Builder(const std::string& text, const std::string& where) : text_(text), where_(where) {}
  json take() { return std::move(root_); }

  bool null() { return add(nullptr); }
  bool boolean(bool value) { return add(value); }
  bool number_integer(json::number_integer_t value) { return add(value); }
  bool number_unsigned(json::number_unsigned_t value) { return add(value); }
  bool number_float(json::number_float_t value, const std::string&) { return add(value); }
  bool string(std::string& value) { return add(std::move(value)); }
  bool binary(json::binary_t& value) { return add(std::move(value)); }
  bool start_object(std::size_t) { return open(json::object()); }
  bool start_array(std::size_t) { return open(json::array()); }
  bool end_object() { return close(); }
  bool end_array() { return close(); }

  bool key(std::string& name) {
    if (open_.back()->contains(name)) throw InputError(where_, "key \"" + name + "\" is given twice: keep one");
    key_ = std::move(name);
    return true;
  }

  bool parse_error(std::size_t offset, const std::string& token, const json::exception& error) {
    const std::string place = position_text(text_, offset);
    if (error.id == 406) throw InputError(where_, place + ": the number " + token + " is too large");
    const std::string shown = token.size() > 60 ? token.substr(0, 60) + "..." : token;
    if (token.empty()) throw InputError(where_, place + ": not JSON: the text ends too early");
    throw InputError(where_, place + ": not JSON at '" + shown + "'");
  }

 private:
  json* place(json value) {
    if (open_.empty()) return &(root_ = std::move(value));
    json& parent = *open_.back();
    if (parent.is_object()) return &(parent[key_] = std::move(value));
    parent.push_back(std::move(value));
    return &parent.back();
  }
  bool add(json value) { return place(std::move(value)) != nullptr; }
  bool open(json value) {
    if (open_.size() == kMaxDepth)
      throw InputError(where_, "nested deeper than " + std::to_string(kMaxDepth) + " levels");
    open_.push_back(place(std::move(value)));
    return true;
  }
  bool close() {
    open_.pop_back();
    return true;
  }

  const std::string& text_;
  const std::string& where_;
  json root_;
  std::vector<json*> open_;  // a parent's element does not move while it is open: it is the last one
  std::string key_;
};

}  // namespace

std::string read_text(const std::filesystem::path& file) {
  std::error_code none;
  const auto status = std::filesystem::status(file, none);
  if (std::filesystem::is_directory(status)) throw InputError(file.string(), "is a folder: name a file in it");
  if (!std::filesystem::exists(status)) throw InputError(file.string(), "there is no such file");
  errno = 0;
  std::ifstream in(file, std::ios::binary);
  std::string text;
  std::vector<char> block(std::size_t{1} << 16U);
  while (in && text.size() <= kMaxBytes) {
    in.read(block.data(), static_cast<std::streamsize>(block.size()));
    text.append(block.data(), static_cast<std::size_t>(in.gcount()));
  }
  if (text.size() > kMaxBytes) throw InputError(file.string(), "is larger than 1 GiB");
  if (!in.eof()) throw InputError(file.string(), "cannot be read: " + std::generic_category().message(errno));
  return text;
}

json parse_json(const std::string& text, const std::string& where) {
  if (const std::size_t zero = text.find('\0'); zero != std::string::npos)  // the parser would stop there, content
    throw InputError(where, position_text(text, zero) + ": not JSON: a zero byte");
  Builder builder(text, where);
  json::sax_parse(text, &builder);
  return builder.take();
}

}  // namespace pelage
