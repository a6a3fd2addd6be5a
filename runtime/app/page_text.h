// Text for HTML: escaped, and numbers as people read them.
#pragma once

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

/// Tenths below 100.
std::string milliseconds(double value);

/// Replaces each {{name}} of the form by what `value` gives for the name, once: what is put in is not looked at.
std::string fill(std::string_view form, const std::function<std::string(std::string_view)>& value);

}  // namespace pelage::app
