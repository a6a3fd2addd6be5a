// Text for HTML: escaped, and numbers as people read them.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace pelage::app {

/// For element text and quoted attributes: & < > " ' as entities; bytes that are not UTF-8 and control characters other
/// than tab and newline as U+FFFD.
std::string html(std::string_view text);

/// Finite: fixed with `decimals`, or with an exponent where that would show a value other than 0 as 0. Else the symbol
/// for infinity, or "undefined". `sign` writes + too; minus is U+2212.
std::string number(double value, int decimals, bool sign = false);

/// Significant digits instead: 0.0123, 12.3, 1234; with an exponent below 10^-4 and from 10^6.
std::string significant(double value, int digits = 3);

/// Tenths below 100.
std::string milliseconds(double value);

/// A PNG as the address of an image. @throws InputError where it cannot be read
std::string picture_uri(const std::filesystem::path& file);

/// Replaces each {{name}} of the form by what `value` gives for the name, once: what is put in is not looked at.
std::string fill(std::string_view form, const std::function<std::string(std::string_view)>& value);

}  // namespace pelage::app
