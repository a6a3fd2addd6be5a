#include "pelage/app/page_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <span>
#include <vector>

#include "pelage/data_schema/base64.h"
#include "pelage/data_schema/errors.h"

namespace pelage::app {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD";  // U+FFFD

/// Bytes of the UTF-8 character that the text begins with [RFC 3629, section 4]; 0 where there is none.
std::size_t character_size(std::string_view text) noexcept {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
  if (byte(0) < 0x80) return 1;
  const std::size_t size = byte(0) >= 0xF0 ? 4 : byte(0) >= 0xE0 ? 3 : 2;
  if (byte(0) < 0xC2 || byte(0) > 0xF4 || text.size() < size) return 0;
  for (std::size_t i = 1; i < size; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return 0;
  }
  const bool overlong = (byte(0) == 0xE0 && byte(1) < 0xA0) || (byte(0) == 0xF0 && byte(1) < 0x90);
  const bool foreign = (byte(0) == 0xED && byte(1) >= 0xA0) || (byte(0) == 0xF4 && byte(1) >= 0x90);
  return overlong || foreign ? 0 : size;
}

std::string escaped(char c) {
  switch (c) {
    case '&':
      return "&amp;";
    case '<':
      return "&lt;";
    case '>':
      return "&gt;";
    case '"':
      return "&quot;";
    case '\'':
      return "&#39;";
    default:
      break;
  }
  const bool control = (static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t') || c == 0x7F;
  return control ? std::string(kReplacement) : std::string(1, c);
}

}  // namespace

std::string html(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const std::size_t size = character_size(text);
    if (size == 0) {
      result += kReplacement;
    } else if (size == 1) {
      result += escaped(text[0]);
    } else {
      result += text.substr(0, size);
    }
    text.remove_prefix(size == 0 ? 1 : size);
  }
  return result;
}

std::string number(double value, int decimals, bool sign) {
  if (std::isnan(value)) return "undefined";
  const std::string before = std::signbit(value) && value != 0 ? "\u2212" : sign && value != 0 ? "+" : "";
  const double size = std::abs(value);
  if (std::isinf(size)) return before + "\u221E";
  const bool lost = size > 0 && size < 0.5 * std::pow(10.0, -decimals);
  if (!lost) return before + fmt::format("{:.{}f}", size, decimals);
  const std::string text = fmt::format("{:.1e}", size);  // as in 3.2e-05
  const std::size_t exponent = text.find("e-");
  return before + text.substr(0, exponent) + "e\u2212" + std::to_string(std::stoi(text.substr(exponent + 2)));
}

std::string significant(double value, int digits) {
  if (!std::isfinite(value)) return number(value, 0);
  const std::string text = fmt::format("{:.{}e}", std::abs(value), digits - 1);  // as in 3.21e-05
  const int exponent = std::stoi(text.substr(text.find('e') + 1));
  const std::string before = value < 0 ? "\u2212" : "";
  if (exponent >= -4 && exponent < 6)
    return before + fmt::format("{:.{}f}", std::abs(value), value == 0 ? 0 : std::max(0, digits - 1 - exponent));
  return before + text.substr(0, text.find('e')) + (exponent < 0 ? "e\u2212" : "e") +
         std::to_string(std::abs(exponent));
}

std::string milliseconds(double value) {
  return number(value, value < 100 ? 1 : 0);
}

std::string picture_uri(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::vector<char> bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  if (!in || bytes.empty()) throw InputError(file.string(), "no picture here for the page");
  return "data:image/png;base64," + base64_encode(std::as_bytes(std::span(bytes)));
}

std::string fill(std::string_view form, const std::function<std::string(std::string_view)>& value) {
  std::string result;
  for (;;) {
    const std::size_t begin = form.find("{{");
    const std::size_t end = begin == std::string_view::npos ? begin : form.find("}}", begin);
    if (end == std::string_view::npos) return result += form;
    result += form.substr(0, begin);
    result += value(form.substr(begin + 2, end - begin - 2));
    form.remove_prefix(end + 2);
  }
}

}  // namespace pelage::app
