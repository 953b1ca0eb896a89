#include "mottle/core/random.hpp"

#include <gtest/gtest.h>

namespace mottle {
namespace {

// Known-answer vector of philox4x32-10 for zero key and counter, published with Random123 (kat_vectors):
// 6627e8d5 e169c58d bc57ac4c 9b00dbd8.
TEST(RandomStream, ReproducesThePublishedPhiloxVectorForZeroKeyAndCounter) {
  RandomStream stream({.seed = 0, .purpose = static_cast<StreamPurpose>(0), .iteration = 0}, 0);
  EXPECT_EQ(stream.bits(), 0xe169c58d6627e8d5ULL);
  EXPECT_EQ(stream.bits(), 0x9b00dbd8bc57ac4cULL);
}

TEST(RandomStream, StreamsWithDifferentNamesDiffer) {
  const StreamKey key{.seed = 7, .purpose = StreamPurpose::truth, .iteration = 3};
  RandomStream reference(key, 5);
  const std::uint64_t word = reference.bits();
  EXPECT_NE(word, RandomStream(key, 6).bits());
  EXPECT_NE(word, RandomStream({.seed = 8, .purpose = StreamPurpose::truth, .iteration = 3}, 5).bits());
  EXPECT_NE(word, RandomStream({.seed = 7, .purpose = StreamPurpose::bootstrap, .iteration = 3}, 5).bits());
  EXPECT_NE(word, RandomStream({.seed = 7, .purpose = StreamPurpose::truth, .iteration = 4}, 5).bits());
  EXPECT_EQ(word, RandomStream(key, 5).bits());
}

TEST(RandomStream, UniformsHaveMeanOneHalfAndVarianceOneTwelfth) {
  double sum = 0.0;
  double squares = 0.0;
  constexpr int k_count = 100000;
  RandomStream stream({.seed = 1}, 0);
  for (int i = 0; i < k_count; ++i) {
    const double u = stream.uniform();
    ASSERT_GT(u, 0.0);
    ASSERT_LT(u, 1.0);
    sum += u;
    squares += (u - 0.5) * (u - 0.5);
  }
  // Four standard errors: sqrt(1/12/n) for the mean, sqrt(1/180/n) for the mean square deviation.
  EXPECT_NEAR(sum / k_count, 0.5, 4.0 * 0.000913);
  EXPECT_NEAR(squares / k_count, 1.0 / 12.0, 4.0 * 0.000236);
}

}  // namespace
}  // namespace mottle
