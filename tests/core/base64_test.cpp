#include "mottle/core/base64.hpp"

#include <gtest/gtest.h>

#include <string_view>

namespace mottle {
namespace {

std::string encoded(std::string_view text) {
  return base64(std::as_bytes(std::span(text)));
}

TEST(Base64, AgreesWithTheVectorsOfItsStandard) {  // RFC 4648, section 10
  EXPECT_EQ(encoded(""), "");
  EXPECT_EQ(encoded("f"), "Zg==");
  EXPECT_EQ(encoded("fo"), "Zm8=");
  EXPECT_EQ(encoded("foo"), "Zm9v");
  EXPECT_EQ(encoded("foob"), "Zm9vYg==");
  EXPECT_EQ(encoded("fooba"), "Zm9vYmE=");
  EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
}

TEST(Base64, EncodesTheBytesOfNumbers) {
  const float one[] = {1.0F};  // 00 00 80 3f on a little-endian machine
  EXPECT_EQ(base64_of(std::span<const float>(one)), "AACAPw==");
}

}  // namespace
}  // namespace mottle
