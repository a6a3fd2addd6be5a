// Hard case 28: NaN or Inf in any option.
#include "pelage/console/options.h"

#include <gmock/gmock.h>
#include <CLI/CLI.hpp>

namespace pelage::console {
namespace {

using ::testing::HasSubstr;

std::string why_not(const std::string& text, const CLI::Validator& validator) {
  std::string value = text;
  return validator(value);
}

TEST(Finite, AcceptsNumbersInRange) {
  for (const char* text : {"0", "1", "0.5", "1e-3", "-0", "+0.5", "1."})
    EXPECT_EQ(why_not(text, finite(0, 1)), "") << text;
  EXPECT_EQ(why_not("-1e300", finite()), "");
}

TEST(Finite, RefusesWhatIsNotFinite) {
  for (const char* text : {"nan", "NaN", "-nan", "inf", "-inf", "Infinity"})
    EXPECT_EQ(why_not(text, finite()), std::string(text) + " is not finite: give a finite number");
  for (const char* text : {"1e999", "-1e999"}) EXPECT_THAT(why_not(text, finite()), HasSubstr("too large"));
}

TEST(Finite, RefusesWhatIsNoNumber) {
  for (const char* text : {"", "x", "1x", "0x10", "1 ", " 1", "--1", "1,2", "+-1"})
    EXPECT_THAT(why_not(text, finite()), HasSubstr("is not a number: give a finite number")) << text;
}

TEST(Finite, NamesTheRange) {
  EXPECT_EQ(why_not("2", finite(0, 1)), "2 is out of range: give a number in [0, 1]");
  EXPECT_EQ(why_not("-2", finite(0.5)), "-2 is out of range: give a number of 0.5 or more");
  EXPECT_THAT(why_not("nan", finite(-3, 3)), HasSubstr("give a number in [-3, 3]"));
}

}  // namespace
}  // namespace pelage::console
