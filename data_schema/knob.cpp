#include "pelage/data_schema/knob.h"

#include <array>
#include <charconv>

namespace pelage {

std::vector<KnobValue> numbers(const std::string& place, std::initializer_list<double> amounts) {
  std::vector<KnobValue> values;
  for (const double amount : amounts) {
    std::array<char, 32> text{};
    const std::string label(text.data(), std::to_chars(text.data(), text.data() + text.size(), amount).ptr);
    values.push_back({label, amount, {place + "=" + label}, 0, {}});
  }
  return values;
}

std::vector<KnobValue> choices(const std::string& place, std::initializer_list<const char*> words) {
  std::vector<KnobValue> values;
  for (const char* const word : words)
    values.push_back({word, std::numeric_limits<double>::quiet_NaN(), {place + "=" + word}, 0, {}});
  return values;
}

}  // namespace pelage
