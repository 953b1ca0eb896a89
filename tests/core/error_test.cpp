#include "mottle/core/error.hpp"

#include <gtest/gtest.h>

#include <type_traits>

#include "core/message_of.hpp"

namespace mottle {
namespace {

using test::message_of;

TEST(Require, PassesWhereTheClaimHolds) {
  EXPECT_NO_THROW(require(true, "never formatted: {}", 1));
}

TEST(Require, ThrowsInvalidInputWithTheFormattedMessage) {
  EXPECT_EQ(message_of<InvalidInput>([] { require(false, "alpha: {} is outside ({}, {})", 1.5, 0, 1); }),
            "alpha: 1.5 is outside (0, 1)");
}

TEST(FormatError, StartsItsMessageWithFileAndLine) {
  EXPECT_STREQ(FormatError("tests.csv", 3, "4 cells").what(), "tests.csv:3: 4 cells");
}

TEST(FormatError, NamesTheFileAloneWhereTheFaultHasNoLine) {
  EXPECT_STREQ(FormatError("tests.csv", 0, "is empty").what(), "tests.csv: is empty");
}

TEST(Errors, KeepThoseTheUserCanMendApartFromThoseOfTheSystem) {
  EXPECT_TRUE((std::is_base_of_v<InvalidInput, FormatError>));
  EXPECT_FALSE((std::is_base_of_v<InvalidInput, SystemFailure>));
  EXPECT_FALSE((std::is_base_of_v<InvalidInput, Stopped>));
  EXPECT_FALSE((std::is_base_of_v<SystemFailure, Stopped>));
}

TEST(Errors, AreAllCaughtAsTheBase) {
  EXPECT_THROW(throw FormatError("a", 1, "b"), Error);
  EXPECT_THROW(throw SystemFailure("a"), Error);
  EXPECT_THROW(throw Stopped("a"), Error);
}

}  // namespace
}  // namespace mottle
