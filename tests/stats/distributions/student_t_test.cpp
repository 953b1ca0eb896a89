#include "mottle/stats/distributions/student_t.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "stats/relative_error.hpp"

namespace mottle::stats {
namespace {

// mpmath 1.2 with 50 digits: the x at which its regularised incomplete beta function is Phi(score).
TEST(StudentT, HalfTKeepsItsDigitsFromZeroToTheFarTail) {
  struct Case {
    double degrees_of_freedom, score, x;
  };
  const Case cases[] = {
      {0.5, -30.0, 9.0974140410874222e-198}, {0.5, -6.7, 1.9321269546126566e-11},
      {0.5, -4.01, 5.6288546505238689e-5},   {0.5, -3.99, 6.1252411907508592e-5},
      {0.5, -1.0, 0.30739813616311909},      {0.5, 0.0, 1.5537739740300373},
      {0.5, 5.0, 5006703786019.9955},        {1.0, -6.7, 1.6369232374309852e-11},
      {1.0, -4.01, 4.7688393083875365e-5},   {1.0, -3.99, 5.1893844792465519e-5},
      {1.0, 5.0, 2220883.5911628441},        {4.0, -30.0, 6.5422852361975827e-198},
      {4.0, -6.7, 1.3894635983953575e-11},   {4.0, -3.99, 4.4048863523675745e-5},
      {4.0, 0.0, 0.74069708411268263},       {4.0, 2.0, 3.6003953124101121},
      {1e6, -30.0, 6.1496554700713558e-198}, {1e6, -4.01, 3.8049842063918906e-5},
      {1e6, -3.99, 4.1405307886597215e-5},   {1e6, 0.0, 0.67448999553108738},
      {4.0, -3.01, 0.0017416523656597409},   {0.5, -3.01, 0.0024218707330275024},
      {4.0, -2.99, 0.0018598509875946061},   {0.5, -2.99, 0.0025862337501043617},
  };
  for (const auto& [degrees_of_freedom, score, x] : cases) {
    // Boost's quantile of 1/2 - P/2 keeps 1e-16 / x^2 where its closed form of four degrees of freedom is used.
    EXPECT_TRUE(is_relatively_near(half_t_of_score(score, degrees_of_freedom), x, 5e-11))
        << degrees_of_freedom << ", " << score;
  }
}

/// Closed forms: tan(pi (P - 1/2)) of one degree of freedom, (2 P - 1) / sqrt(2 P (1 - P)) of two.
TEST(StudentT, QuantilesOfScoresAreTheClosedForms) {
  for (const double score : {-6.0, -1.5, -0.01, 0.0, 0.3, 2.0}) {
    const double below = 0.5 * std::erfc(-score / std::sqrt(2.0));
    const double above = 0.5 * std::erfc(score / std::sqrt(2.0));
    const double cauchy = score < 0.0 ? -1.0 / std::tan(M_PI * below) : 1.0 / std::tan(M_PI * above);
    EXPECT_NEAR(student_t_of_score(score, 1.0), cauchy, 1e-12 * (1.0 + std::abs(cauchy)));
    const double two = (below - above) / std::sqrt(2.0 * below * above);
    EXPECT_NEAR(student_t_of_score(score, 2.0), two, 1e-12 * (1.0 + std::abs(two)));
  }
}

}  // namespace
}  // namespace mottle::stats
