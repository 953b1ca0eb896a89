#include "mottle/core/utf8.hpp"

#include <gtest/gtest.h>

namespace mottle {
namespace {

TEST(Utf8, LongTextIsShortenedBetweenLetters) {
  EXPECT_EQ(mottle::shortened("as it is", 8), "as it is");
  EXPECT_EQ(mottle::shortened("abcdefghijkl", 6), "abcd [...] kl");
  EXPECT_EQ(mottle::shortened("äöüäöüäöüäöü", 9), "äöü [...] ü");
}

TEST(Printable, KeepsCharactersAndReplacesWhatIsNone) {
  EXPECT_EQ(printable("Größe\t3 ≥ 2"), "Größe\t3 ≥ 2");
  EXPECT_EQ(printable("a\xff\xfe b\xc3"), R"(a\xff\xfe b\xc3)");
  EXPECT_EQ(printable("red \x1b[31m\a\r\nnext"), R"(red \x1b[31m\x07\x0d\x0anext)");
  EXPECT_EQ(printable("\xed\xa0\x80"), R"(\xed\xa0\x80)");  // half a surrogate pair
}

}  // namespace
}  // namespace mottle
