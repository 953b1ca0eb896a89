#include "mottle/stats/chains/leave_one_out.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "mottle/core/error.hpp"
#include "mottle/stats/distributions/standard_normal.hpp"

namespace mottle::stats {
namespace {

/// Log-likelihoods of three data under 400 normal draws of the generator s <- 16807 s mod (2^31 - 1): of little, of
/// much and of far too much influence.
Eigen::MatrixXd three_data() {
  constexpr double k_modulus = 2147483647.0;
  Eigen::MatrixXd logs(400, 3);
  for (Eigen::Index c = 0; c < 3; ++c) {
    const auto number = static_cast<double>(c + 1);
    double state = 1000.0 * number;
    for (Eigen::Index s = 0; s < logs.rows(); ++s) {
      state = std::fmod(16807.0 * state, k_modulus);
      const double x = standard_normal_quantile(state / k_modulus);
      logs(s, c) = -0.5 * std::pow(0.5 * number * x - 0.3 * number, 2) - 0.1 * number;
    }
  }
  return logs;
}

constexpr double k_rounding = 1e-10;  // both programs differ in how they sum, and in the normal quantile's last digits

TEST(LeaveOneOut, IsThatOfTheRPackageLoo) {
  const LeaveOneOut found = leave_one_out(three_data(), Eigen::Vector3d(1.0, 0.5, 0.9));  // loo 2.5.1, loo()
  const Eigen::Vector3d elpd(-0.311467837244795, -1.728505541313536, -6.244621615017338);
  const Eigen::Vector3d shape(0.043668114913377, 0.712675487283106, 1.704593751244092);
  for (Eigen::Index i = 0; i < 3; ++i) {
    EXPECT_NEAR(found.pointwise(i), elpd(i), k_rounding);
    EXPECT_NEAR(found.pareto_k(i), shape(i), k_rounding);
  }
  EXPECT_NEAR(found.elpd, -8.28459499357567, k_rounding);
  EXPECT_NEAR(found.standard_error, 5.36682466625354, k_rounding);
  EXPECT_NEAR(found.effective_parameters, 6.30354811674768, k_rounding);
}

TEST(WidelyApplicableInformation, IsThatOfTheRPackageLoo) {
  const PredictiveAccuracy found = widely_applicable_information(three_data());  // loo 2.5.1, waic()
  EXPECT_NEAR(found.elpd, -6.89305019148551, k_rounding);
  EXPECT_NEAR(found.standard_error, 4.22775232481839, k_rounding);
  EXPECT_NEAR(found.effective_parameters, 4.91200331465751, k_rounding);
}

double log_normal_density(double apart, double variance) {
  return -0.5 * (std::log(2.0 * std::numbers::pi * variance) + apart * apart / variance);
}

/// z_i ~ N(x, 1) with prior x ~ N(0, 2^2): under the posterior of the others z_i is normal too.
TEST(LeaveOneOut, HasTheClosedFormForTheMeanOfANormal) {
  const Eigen::VectorXd z = (Eigen::VectorXd(6) << -0.4, 0.1, 0.3, 0.9, 1.4, 2.6).finished();
  const auto posterior_without = [&](Eigen::Index left_out) {
    double precision = 0.25;
    double sum = 0.0;
    for (Eigen::Index i = 0; i < z.size(); ++i) {
      if (i == left_out) continue;
      precision += 1.0;
      sum += z(i);
    }
    return std::pair(sum / precision, 1.0 / precision);
  };
  const auto [mean, variance] = posterior_without(-1);
  constexpr Eigen::Index k_draws = 4000;
  Eigen::MatrixXd logs(k_draws, z.size());
  for (Eigen::Index s = 0; s < k_draws; ++s) {
    const double p = (static_cast<double>(s) + 0.5) / static_cast<double>(k_draws);
    const double x = mean + std::sqrt(variance) * standard_normal_quantile(p);
    for (Eigen::Index i = 0; i < z.size(); ++i) logs(s, i) = log_normal_density(z(i) - x, 1.0);
  }
  const LeaveOneOut found = leave_one_out(logs, Eigen::VectorXd::Ones(z.size()));
  for (Eigen::Index i = 0; i < z.size(); ++i) {
    const auto [mean_without, variance_without] = posterior_without(i);
    const double exact = log_normal_density(z(i) - mean_without, 1.0 + variance_without);
    EXPECT_NEAR(found.pointwise(i), exact, 0.005) << i;  // draws evenly spread: only the smoothed tail is in error
    EXPECT_LT(found.pareto_k(i), k_unreliable_pareto_k);
  }
}

TEST(LeaveOneOut, IsTheDensityOfADatumThatSaysNothing) {
  const LeaveOneOut found = leave_one_out(Eigen::MatrixXd::Constant(100, 2, -1.5), Eigen::Vector2d::Ones());
  EXPECT_DOUBLE_EQ(found.elpd, -3.0);
  EXPECT_NEAR(found.effective_parameters, 0.0, 1e-14);
  EXPECT_EQ(found.pareto_k, Eigen::VectorXd::Zero(2));
}

TEST(LeaveOneOut, HasAnInfiniteShapeForTooFewDraws) {
  const LeaveOneOut found = leave_one_out(three_data().topRows(20), Eigen::Vector3d::Ones());
  EXPECT_TRUE((found.pareto_k.array() == std::numeric_limits<double>::infinity()).all());
}

TEST(LeaveOneOut, RefusesWhatIsNotFinite) {
  Eigen::MatrixXd logs = three_data();
  logs(3, 1) = -std::numeric_limits<double>::infinity();
  EXPECT_THROW(leave_one_out(logs, Eigen::Vector3d::Ones()), InvalidInput);
  EXPECT_THROW(widely_applicable_information(logs), InvalidInput);
}

}  // namespace
}  // namespace mottle::stats
