#include "pelage/data_schema/base64.h"

#include <gtest/gtest.h>

namespace pelage {
namespace {

std::string encoded(std::string_view text) {
  return base64_encode(std::as_bytes(std::span(text)));
}

TEST(Base64, MatchesTheVectorsOfRfc4648) {
  EXPECT_EQ(encoded(""), "");
  EXPECT_EQ(encoded("f"), "Zg==");
  EXPECT_EQ(encoded("fo"), "Zm8=");
  EXPECT_EQ(encoded("foo"), "Zm9v");
  EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
}

TEST(Base64, DecodesWhatItEncodes) {
  std::vector<std::byte> bytes;
  for (unsigned i = 0; i < 300; ++i) {
    EXPECT_EQ(base64_decode(base64_encode(bytes)), bytes) << i;
    bytes.push_back(static_cast<std::byte>(i * 37U + i / 7U));
  }
}

TEST(Base64, RefusesWhatIsNotBase64) {
  for (const char* text :
       {"Zg", "Zg=", "Z===", "Zg==Zg==", "Zm9\n", "Zh==", "Zm9=", "====", "Zm 9", "\xff\xff\xff\xff"})
    EXPECT_EQ(base64_decode(text), std::nullopt) << text;
}

}  // namespace
}  // namespace pelage
