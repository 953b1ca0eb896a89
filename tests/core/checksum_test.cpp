#include "mottle/core/checksum.hpp"

#include <gtest/gtest.h>

namespace mottle {
namespace {

TEST(Checksum, AgreesWithTheCommandXxhsum) {  // printf '...' | xxhsum -H2
  EXPECT_EQ(hexadecimal(digest_of("")), "99aa06d3014798d86001c324468d497f");
  EXPECT_EQ(hexadecimal(digest_of("mottle")), "9d2265e50d153dfbe77b94c6a2c9d539");
}

TEST(Checksum, DoesNotSeeWhereOnePieceEnds) {
  const std::string text(5000, 'x');
  Checksum pieces;
  for (const std::size_t size : {1, 255, 0, 4000, 744}) pieces.add(text.data(), size);
  EXPECT_EQ(pieces.digest(), digest_of(text));
}

TEST(Checksum, SeesOneBit) {
  std::string text(5000, 'x');
  const Digest before = digest_of(text);
  text[4321] = static_cast<char>(text[4321] ^ 1);
  EXPECT_NE(digest_of(text), before);
}

}  // namespace
}  // namespace mottle
